"""Two bodies, rough bodies, layers and prescribed tractions without a period, beside what knows none of them."""

import numpy as np
import pytest
from scipy.special import j0

import gfmd_numba
from gfmd_numba.contact.combinations import LOWEST, SOFTEST
from gfmd_numba.elasticity import free_body, free_fields
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options
from support.rough_windows import rough

WALL = {"hard_wall": {}}
SOFT, HARD = ({"youngs_modulus": 1.0, "poissons_ratio": 0.3}, {"youngs_modulus": 3.0, "poissons_ratio": 0.45})
SHARE = (1.0 - 0.45**2) / 3.0 / ((1.0 - 0.3**2) + (1.0 - 0.45**2) / 3.0)  # of the compliance that is the harder body's
MODULUS = 1.0 / ((1.0 - 0.3**2) + (1.0 - 0.45**2) / 3.0)
COATED = ElasticBody.layered((0.05, 0.3), (Material(1.0, 0.3), Material(0.4, 0.45)), Material(2.0, 0.2))
DEEP = {
    "coated": COATED,
    "thin coating": ElasticBody.layered((0.002,), (Material(1.0, 0.3),), Material(0.2, 0.4)),
    "high slab": ElasticBody(0.3, 2.5),
    "high slab that keeps its volume": ElasticBody(0.5, 1.2),
}


def measured(heights):
    return {"method": "measured", "heights": heights, "units": {"z": "m"}}


def solved(bodies, heights, load, **more):
    """Contact of a punch of heights in a window of 1 m."""
    dimension = more.pop("dimension", np.ndim(heights))
    facing = {} if heights is None else {"roughness": measured(heights)}
    other = bodies.get("counter_body")
    bodies = bodies | (facing if other is None else {"counter_body": other | facing})
    load = {"line_load" if dimension == 1 else "force": load}
    scene = bodies | {"interface": WALL, "length": 1.0, "periodic": False, "dimension": dimension, "loading": load}
    return gfmd_numba.solve({"scene": scene | more})


@pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")
@pytest.mark.filterwarnings("ignore:the contact reaches the edge of the window")
@pytest.mark.filterwarnings("ignore:the heights jump")
@pytest.mark.parametrize(("dimension", "periodic"), [(1, False), (2, False), (2, "y")])
def test_two_half_spaces_give_way_as_one_of_their_reduced_modulus_and_each_by_its_share(dimension, periodic):
    heights, load = 0.05 * rough(32, dimension), 0.001
    two = solved({"body": SOFT, "counter_body": HARD}, heights, load, periodic=periodic)
    body = {"youngs_modulus": MODULUS * 0.91, "poissons_ratio": 0.3}
    one = solved({"body": body}, heights, load, periodic=periodic)
    for name in ("pressure", "approach", "elastic_energy", "mean_gap", "contact_area_fraction"):
        np.testing.assert_allclose(two[name], one[name], rtol=1e-7, atol=1e-9 * float(abs(one[name]).max()))
    moved = one["displacement"].values
    np.testing.assert_allclose(two["displacement"], (1.0 - SHARE) * moved, atol=1e-7 * abs(moved).max())
    np.testing.assert_allclose(two["counter_body_displacement"], SHARE * moved, atol=1e-7 * abs(moved).max())


@pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")
@pytest.mark.filterwarnings("ignore:the contact reaches the edge of the window")
@pytest.mark.filterwarnings("ignore:.*a tilt makes up")
@pytest.mark.parametrize("dimension", [1, pytest.param(2, marks=pytest.mark.long)])
def test_two_rough_bodies_are_the_sum_of_their_heights(dimension):
    """Whoever has them, a punch or either body; what the slopes add is told to be of their size."""
    lower, upper = 0.01 * rough(32, dimension), 0.02 * rough(32, dimension, seed=2)
    bodies = {"body": SOFT | {"roughness": measured(lower)}, "counter_body": HARD | {"roughness": measured(upper)}}
    both = solved(bodies, None, 0.005, dimension=dimension)
    punch = solved({"body": SOFT, "counter_body": HARD}, lower + upper, 0.005)
    np.testing.assert_allclose(both["pressure"], punch["pressure"], atol=1e-6 * float(punch["pressure"].max()))
    np.testing.assert_allclose(both["body_height"], lower - lower.mean(), atol=1e-15)
    assert float(both["next_order"]) > 0.0
    inside = gfmd_numba.body_fields(both, -1e-6, body="counter_body", **({} if dimension == 1 else {"y": 0.5}))
    at = {} if dimension == 1 else {"y": 16}
    borne = both["pressure"].isel(at)
    np.testing.assert_allclose(inside["stress_3"].isel(z=0), -borne, atol=1e-3 * float(borne.max()))


@pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")
@pytest.mark.filterwarnings("ignore:the contact reaches the edge of the window")
def test_equal_bodies_do_not_rub_and_a_rigid_one_rubs_as_a_punch_does():
    """Pressure moves the surfaces of equal bodies along one another (Dundurs' beta is 0)."""
    heights, friction = 0.1 * rough(48, 1), {"interface": WALL | {"friction": {"coefficient": 0.4}}}
    pairs = {"equal": SOFT, "rigid": SOFT | {"youngs_modulus": 1e8}}
    rubs = {
        name: solved({"body": SOFT, "counter_body": other}, heights, 0.01, **friction) for name, other in pairs.items()
    }
    punch = solved({"body": SOFT}, heights, 0.01, **friction)
    largest = float(abs(punch["tangential_traction"]).max())
    assert largest > 1e-3
    assert abs(rubs["equal"]["tangential_traction"]).max() < 1e-7 * largest
    np.testing.assert_allclose(rubs["rigid"]["tangential_traction"], punch["tangential_traction"], atol=1e-5 * largest)


@pytest.mark.parametrize("name", DEEP)
@pytest.mark.parametrize(("dimension", "n"), [(1, 32), (2, 32), (2, 64)])
def test_a_smooth_load_displaces_deep_bodies_as_an_integral_over_all_waves_has_it(name, dimension, n):
    """A Gaussian of width 0.06: int C(q) p(q) cos(q x) dq / pi, or int C(q) p(q) J0(q r) q dq / 2 pi.

    On profiles on a half-space, less that in the middle, as they count from elsewhere.
    """
    body, width, x = DEEP[name], 0.06, np.arange(n) / n - 0.5
    load = np.exp(-(x**2) / (2.0 * width**2))
    load = load if dimension == 1 else np.outer(load, load)
    found = free_body.displaced(load[np.newaxis], body, (True,) * dimension)[0]
    nodes, weights = np.polynomial.legendre.leggauss(40)
    edges = np.concatenate(([0.0], np.geomspace(1e-7, 9.0 / width, 300)))
    half = 0.5 * np.diff(edges)[:, np.newaxis]
    q = (half * nodes + half + edges[:-1, np.newaxis]).ravel()
    of_waves = (half * weights).ravel() * (np.sqrt(2.0 * np.pi) * width) ** dimension * np.exp(-0.5 * (q * width) ** 2)
    compliance = 1.0 / body.condensed_stiffness(q)
    for i in (n // 2, n // 2 + n // 8, n - 2):
        if dimension == 2:
            expected = (of_waves * compliance * q) @ j0(q * x[i]) / (2.0 * np.pi)
        elif body.aspect_ratio is not None:
            expected = (of_waves * compliance) @ np.cos(q * x[i]) / np.pi
        else:
            modulus = body.material(np.inf).modulus
            base = free_body.displaced(load[np.newaxis], ElasticBody(None, None), (True,))[0] / modulus
            beyond = of_waves * (compliance - 2.0 / (modulus * q)) / np.pi
            expected = found[n // 2] + base[i] - base[n // 2] + beyond @ (np.cos(q * x[i]) - 1.0)
        assert found[i if dimension == 1 else (n // 2, i)] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "dimension"), [("coated", 1), ("coated", 2), ("thin coating", 1), ("high slab", 1), ("high slab", 2)]
)
def test_deep_bodies_are_pressed_as_in_longer_and_longer_periods(name, dimension):
    """Images fall with the square of the period on profiles, and with its cube on maps."""
    n, body, load = 64 if dimension == 1 else 32, DEEP[name], 0.05
    heights = rough(n, dimension)
    punch = (heights.max() - heights)[np.newaxis]
    corner, numerics = (0, *(slice(n),) * dimension), Options("active_set_newton", residual=1e-10)
    around = np.full((1,) * (dimension + 1), punch.max() + 4.0 * load)
    response = free_body.response((n,) * dimension, body)
    window = equilibrate(punch, response, load / 2**dimension, numerics, around=around).pressure[0]
    errors = []
    for periods in (2, 4, 8):
        wide = np.full((1, *(periods * n,) * dimension), punch.max() + 1.0)
        wide[corner] = punch
        q = grid.magnitudes(wide.shape[1:], (float(periods),) * dimension)
        symbol = SpectralResponse.of_normal(body.condensed_stiffness(q))
        found = equilibrate(wide, symbol, load / periods**dimension, numerics).pressure[corner]
        errors.append(float(np.sqrt(((found - window) ** 2).mean()) / window.max()))
    order = np.log2(errors[1] / errors[2])
    if body.aspect_ratio is None:
        assert order == pytest.approx(dimension + 1, abs=0.5)
    assert errors[-1] < 2e-3
    assert order > dimension + 0.5


def test_compliances_of_the_layers_that_are_allowed_are_positive():
    """Random stacks, none of whose materials is far softer than one above it."""
    rng = np.random.default_rng(34)
    for _ in range(8):
        dimension, m = int(rng.integers(1, 3)), int(rng.integers(1, 4))
        n = int(rng.choice([16, 40] if dimension == 2 else [32, 256]))
        moduli = [1.0]
        for _ in range(m):
            moduli.append(max(moduli) * 10.0 ** rng.uniform(np.log10(SOFTEST), 1.5))
        materials = tuple(Material(each, float(rng.choice([0.0, 0.3, 0.5]))) for each in moduli)
        body = ElasticBody.layered(tuple(10.0 ** rng.uniform(-3.5, 1.0, m)), materials[:-1], materials[-1])
        assert free_body.compliance((n,) * dimension, body).min() > 0.0, body
    for height in (LOWEST, 0.5, 1.0, 5.0):
        for shape in ((16, 16), (64,)):
            assert free_body.compliance(shape, ElasticBody(0.5, height)).min() > 0.0


@pytest.mark.parametrize("ends", [(True,), (True, True), (True, False)])
def test_at_the_surface_of_layers_displacements_are_those_of_their_kernel(ends):
    n = 24
    x = np.sin(np.pi * (np.arange(n) + 0.5) / n) ** 4
    load = -(x if len(ends) == 1 else np.outer(x, 1.0 + 0.5 * x))
    expected = free_body.displaced(load[np.newaxis], COATED, ends)[0]
    tractions = np.zeros((len(ends) + 1, *load.shape))
    tractions[-1] = load
    inner = free_fields.under_tractions(tractions, COATED, ends)
    found = inner.section(np.zeros(1), ("u3",))[0, 0] if len(ends) == 1 else inner.plane(0.0, ("u3",))[0]
    np.testing.assert_allclose(found, expected, atol=2e-4 * abs(expected).max())


@pytest.mark.filterwarnings("ignore:the contact reaches the edge of the window")
@pytest.mark.parametrize("dimension", [1, 2])
def test_a_punch_meets_a_body_that_prescribed_tractions_have_deflected(tmp_path, dimension):
    """As one whose heights are lower by the deflection: in the middle of a square that pulls, it is Love's."""
    n = 33 if dimension == 2 else 64
    heights, x = 0.05 * rough(n, dimension), np.arange(n) / n
    pulls = np.where(abs(x - 0.5) < 0.1, 0.01, 0.0)
    pulls = pulls if dimension == 1 else np.outer(pulls, pulls) / 0.01
    np.save(tmp_path / "pulls.npy", pulls)
    boundary = {"boundary": {"normal_traction": str(tmp_path / "pulls.npy")}}
    found = solved({"body": SOFT}, heights, 0.005, **boundary)
    raised = free_body.displaced(pulls[np.newaxis] * 0.91, ElasticBody(0.3, None), (True,) * dimension)[0]
    if dimension == 2:
        half = np.count_nonzero(pulls[n // 2]) / (2.0 * n)
        assert raised.max() == pytest.approx(8.0 * half * np.log(1.0 + np.sqrt(2.0)) / np.pi * 0.0091, rel=0.02)
    expected = solved({"body": SOFT}, heights + raised, 0.005)
    np.testing.assert_allclose(found["pressure"], expected["pressure"], atol=1e-6 * float(expected["pressure"].max()))


def test_accuracy_of_a_window_leaves_its_size_alone(tmp_path):
    from gfmd_numba.campaign import work_precision
    from gfmd_numba.campaign.plan import plan

    scene = {
        "body": {"poissons_ratio": 0.3},
        "form": {"radius": 4.0},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1},
        "interface": WALL,
        "loading": {"reduced_pressure": 0.05},
        "periodic": False,
    }
    eps = {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1.0}
    planned = plan({"name": "window", "seed": 1, "realisations": 2, "scene": scene, "reference": eps})
    study = work_precision.study_of(planned, 2)
    assert study.axes == ("eps_c", "eps_f")
    errors = [point.error for point in study.discretisation("eps_c") if point.curve == "corrected on average"]
    assert errors[0] > errors[-1]


FRICTION = {"interface": WALL | {"friction": {"coefficient": 0.3}}}
STACK = [{"youngs_modulus": 2.0, "poissons_ratio": 0.3, "height": 0.1}]


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"body": {"layers": STACK, "base": HARD}} | FRICTION, "scene.body.base"),
        ({"body": {"layers": STACK, "base": HARD | {"youngs_modulus": 0.01}}}, "scene.body.base.youngs_modulus"),
        ({"body": SOFT | {"aspect_ratio": 2.0}} | FRICTION, "scene.body.aspect_ratio"),
        ({"body": SOFT, "counter_body": HARD | {"aspect_ratio": 2.0}} | FRICTION, "scene.counter_body.aspect_ratio"),
        ({"body": {"youngs_modulus": 1.0, "poissons_ratio": 0.5, "aspect_ratio": 0.1}}, "scene.body.poissons_ratio"),
    ],
)
def test_what_is_not_built_is_refused_where_it_stands(change, named):
    scene = {"form": {"radius": 4.0, "points": 32}, "interface": WALL, "loading": {"line_load": 1e-3}, "length": 1.0}
    with pytest.raises(gfmd_numba.InputError, match=named):
        gfmd_numba.solve({"scene": scene | {"periodic": False} | change})
    with pytest.raises(gfmd_numba.InputError, match="topography_order"):
        gfmd_numba.solve(
            {
                "scene": scene | {"periodic": False, "body": SOFT, "counter_body": HARD},
                "numerics": {"topography_order": 1},
            }
        )
