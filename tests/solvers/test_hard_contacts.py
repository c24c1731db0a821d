"""Cases a solver may trip over: single nodes, flat surfaces, thin and incompressible bodies, adhesion, long runs."""

import numpy as np
import pytest
import slab_stiffness

import gfmd_numba
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine
from gfmd_numba.scene import InputError
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from support.cases import some_of
from support.contacts import press, scene_file

# numbers beyond what is plausible are what these tests are about
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")
X = np.arange(64) / 64
WAVE = 0.01 * np.cos(2 * np.pi * X)
SHAPES = {
    "vertical walls": np.where(abs(X - 0.5) < 0.1, 0.0, -1.0),
    "a single node": np.eye(1, 64, 7)[0],
    "a spike": WAVE + 1e6 * np.eye(1, 64, 7)[0],
    "white noise": self_affine.SelfAffineWaves(0.0, 1, 32).heights((64,), 2, range(1))[0],
    "nothing but Nyquist": (-1.0) ** np.arange(64),
    "far from zero": WAVE + 1e4,
    "four nodes": np.array([0.0, 1.0, 0.3, -1.0]),
    "five nodes": np.array([0.0, 1.0, 0.3, -1.0, 0.2]),
}


@pytest.mark.parametrize("shape", some_of(SHAPES, 1, 2, 7))
def test_all_solvers_agree_from_a_single_node_to_full_contact(tmp_path, shape):
    """At every pressure all solvers end with the same contact, which carries its load."""
    np.save(tmp_path / "profile.npy", SHAPES[shape])
    nx = len(SHAPES[shape])
    for pressure in (1e-6, 0.05, 100.0):
        found = []
        for solver in ("verlet", "conjugate_gradients", "active_set_newton"):
            scene = scene_file(
                roughness={"method": "measured", "file": str(tmp_path / "profile.npy")},
                loading={"reduced_pressure": pressure},
                body={"poissons_ratio": 0.33},
            )
            del scene["discretisation"], scene["seed"]
            found.append(gfmd_numba.solve(scene | {"numerics": {"solver": solver}}))
        one, *others = found
        assert [int(each["status"]) for each in found] == [Status.ok] * 3
        gradient = float(one["rms_gradient"])
        for each in found:
            assert float(each["mean_pressure"]) == pytest.approx(pressure * gradient, rel=1e-7)
            assert float(each["gap"].min()) == 0.0
        for other in others:
            np.testing.assert_array_equal(one["pressure"] > 0, other["pressure"] > 0)
        if pressure == 100.0:
            assert (one["pressure"].values > 0).all()
            waves = np.pi * np.arange(nx // 2 + 1) * grid.coefficients(one["height"].values)
            exact = pressure * gradient + grid.signal(waves, nx)
            np.testing.assert_allclose(one["pressure"], exact, rtol=1e-6)


@pytest.mark.parametrize("nx", [256, 257])
@pytest.mark.parametrize("height", [0.0, 1 / 3, 1e-300, 1e30])
def test_flat_on_flat_is_refused_whatever_rounding_makes_of_it(tmp_path, nx, height):
    """The transform of 257 equal heights is not zero but for its mean; it used to be taken for roughness."""
    np.save(tmp_path / "profile.npy", np.full(nx, height))
    scene = scene_file(roughness={"method": "measured", "file": str(tmp_path / "profile.npy")})
    del scene["discretisation"], scene["seed"]
    with pytest.raises(InputError, match="a flat surface, but for rounding"):
        gfmd_numba.solve(scene)


def test_heights_lost_in_their_own_rounding_are_refused(tmp_path):
    scene = scene_file(roughness={"method": "measured", "file": str(tmp_path / "profile.npy")})
    del scene["discretisation"], scene["seed"]
    kappas = []
    for offset, scale in ((0.0, 1.0), (1e4, 1.0), (0.0, 1e-25), (0.0, 1e25)):
        np.save(tmp_path / "profile.npy", scale * (WAVE + offset))
        kappas.append(float(gfmd_numba.solve(scene)["kappa"]))
    np.testing.assert_allclose(kappas, kappas[0], rtol=1e-9)
    np.save(tmp_path / "profile.npy", WAVE + 1e12)
    with pytest.raises(InputError, match="a flat surface, but for rounding"):
        gfmd_numba.solve(scene)


@pytest.mark.parametrize("displacement", [0.002, 0.01, 1.0, 1e10, 1e30])
def test_an_incompressible_body_needs_room(displacement):
    """Pushed further than volume is left below the punch, it was said to be in full contact under any pressure."""
    body = {"poissons_ratio": 0.5, "aspect_ratio": 0.3}
    with pytest.raises(InputError, match=r"scene.loading.displacement: you gave .*at most .*no room for more"):
        gfmd_numba.solve(scene_file(body=body, loading={"displacement": displacement}))
    steps = {"path": [{"displacement": displacement}]}
    with pytest.raises(InputError, match=r"path\[0\].displacement: you gave .*at most .*no room for more"):
        gfmd_numba.solve(scene_file(body=body, loading={"displacement": 1e-4}) | steps)


def test_a_member_without_room_does_not_take_the_others_along():
    heights = self_affine.SelfAffineWaves(0.8, 1, 16).heights((64,), 2, range(4))
    punch = heights.max(axis=1, keepdims=True) - heights
    room = punch.mean(axis=1)
    punch -= np.where(np.arange(4) % 2, 0.5, 1.5)[:, None] * room[:, None]
    body = slab_stiffness.slab(grid.wavenumbers(64), 0.5, 0.3)
    result = equilibrate(punch, SpectralResponse.of_normal(body), None, Options("conjugate_gradients"))
    assert result.status.tolist() == [Status.no_equilibrium, Status.ok, Status.no_equilibrium, Status.ok]
    volume = result.displacement[1::2].mean(axis=1)
    np.testing.assert_allclose(volume, 0.0, atol=1e-9 * np.ptp(punch))


@pytest.mark.filterwarnings("ignore:the mean pressure is 2 E")
@pytest.mark.filterwarnings("ignore:contacts are 1 nodes wide")
@pytest.mark.parametrize("nu", [-0.99, 0.499999, 0.5])
@pytest.mark.parametrize("aspect_ratio", some_of([1e-4, 1e-2, 1.0, 1e30], 0, 3))
def test_slabs_of_any_height_carry_their_load(nu, aspect_ratio):
    """The height of a very tall slab used to overflow where its effect was bounded."""
    for pressure in (0.05, 100.0):
        body = {"poissons_ratio": nu, "aspect_ratio": aspect_ratio}
        result = gfmd_numba.solve(scene_file(body=body, loading={"reduced_pressure": pressure}))
        assert int(result["status"]) == Status.ok
        assert float(result["mean_pressure"]) == pytest.approx(pressure * 0.02, rel=1e-7)
        stretch = aspect_ratio < 1e-3 or (aspect_ratio < 0.1 and nu > 0.4)  # so stiff that it hardly gives way
        assert bool((result["pressure"].values > 0).all()) == (pressure == 100.0 and not stretch)


def test_a_slab_without_a_height_is_refused():
    """Stiffnesses beyond the range of numbers used to be left out: full contact, and certified."""
    with pytest.raises(InputError, match="aspect_ratio: you gave 1e-300; gfmd allows from 1e-12 to 1e30"):
        gfmd_numba.solve(scene_file(body={"poissons_ratio": 0.5, "aspect_ratio": 1e-300}))


def test_unloading_ends_where_loading_began():
    body = {"poissons_ratio": 0.33, "aspect_ratio": 0.3}
    steps = [{"displacement": d} for d in (2e-3, 5e-4, 0.0)]
    path = gfmd_numba.solve(scene_file(body=body, loading={"displacement": 5e-4}) | {"path": steps})
    assert (path["status"] == Status.ok).all()
    down, up = path.isel(step=0), path.isel(step=2)
    np.testing.assert_allclose(up["pressure"], down["pressure"], atol=1e-6 * float(down["pressure"].max()))
    apart = path.isel(step=3)
    assert float(apart["contact_area_fraction"]) == 0.0
    assert not apart["pressure"].any()
    assert np.isnan(apart["kappa"])


def adhesive(work, length, scale=1.0, modulus=1.0, nx_over=1):
    interface = {"hard_wall": {}, "exponential": {"work_of_adhesion": work * modulus * scale, "range": length * scale}}
    scene = scene_file(scale, modulus * (1 - 0.33**2), interface=interface)
    scene["scene"]["body"] = {"poissons_ratio": 0.33, "youngs_modulus": modulus * (1 - 0.33**2)}
    scene["discretisation"] = {"eps_c": 0.25 / nx_over, "eps_f": 1 / 16, "eps_t": 0.5}
    return scene


@pytest.mark.parametrize(("scale", "modulus"), [(1e-9, 1e-3), (1e3, 1e15)])
def test_adhesion_knows_no_unit(scale, modulus):
    plain, other = gfmd_numba.solve(adhesive(1e-4, 0.02)), gfmd_numba.solve(adhesive(1e-4, 0.02, scale, modulus))
    assert float(other["kappa"]) == pytest.approx(float(plain["kappa"]), rel=1e-12)
    np.testing.assert_allclose(other["pressure"] / modulus, plain["pressure"], rtol=1e-7, atol=1e-9)


def test_a_shorter_range_of_the_same_work_pulls_in_more():
    """From a range far beyond the roughness, with no effect but a load, down to far below a node spacing."""
    found = [gfmd_numba.solve(adhesive(1e-4, length)) for length in (10.0, 0.1, 0.02, 1 / 256, 1 / 800)]
    assert all(int(each["status"]) == Status.ok for each in found)
    area = [float(each["contact_area_fraction_counted"]) for each in found]
    assert area == sorted(area)
    assert area[0] < 0.2 < area[-1]
    for each in found:
        assert float(each["mean_pressure"]) == pytest.approx(0.05 * 0.02, rel=1e-6)
    with pytest.raises(InputError, match=r"range: you gave .*at least"):
        gfmd_numba.solve(adhesive(1e-4, 2e-4))


@pytest.mark.parametrize("damping", [0.0, 100.0])
@pytest.mark.parametrize("solver", ["verlet", "gronbech_jensen"])
@pytest.mark.filterwarnings("ignore:stagnated:UserWarning")
@pytest.mark.filterwarnings("ignore:steps_used_up:UserWarning")
def test_a_badly_damped_run_is_right_or_says_that_it_is_not(damping, solver):
    numerics = {"solver": solver, "damping": damping, "time_step": 1.0, "max_iterations": 5_000}
    result = gfmd_numba.solve(scene_file() | {"numerics": numerics})
    assert int(result["status"]) in (Status.ok, Status.steps_used_up, Status.stagnated)
    if int(result["status"]) == Status.ok:
        assert float(result["kappa"]) == pytest.approx(float(gfmd_numba.solve(scene_file())["kappa"]), rel=1e-9)
    else:
        assert np.isnan(result["kappa"])


@pytest.mark.long
def test_a_million_steps_do_not_move_the_state():
    heights = self_affine.SelfAffineWaves(0.8, 1, 8).heights((32,), 3, range(1))
    punch, body = heights.max() - heights, stiffness.half_space(grid.wavenumbers(32))
    early, late = (
        equilibrate(
            punch, SpectralResponse.of_normal(body), 0.05, Options("verlet", residual=1e-300, max_iterations=steps)
        )
        for steps in (10_000, 1_000_000)
    )
    np.testing.assert_array_equal(early.touching, late.touching)
    # its mean is arbitrary in principle, but nothing moves it
    np.testing.assert_allclose(late.displacement, early.displacement, rtol=0, atol=1e-12 * np.ptp(heights))


@pytest.mark.long
@pytest.mark.parametrize("nx", [2**20, 3**12])
def test_a_million_nodes_are_solved(nx):
    heights = self_affine.SelfAffineWaves(0.8, 2, nx // 64).heights((nx,), 1, range(1))
    result = press(heights, 0.05, "active_set_newton", residual=1e-7)
    assert result.pressure.mean() == pytest.approx(0.05, rel=1e-6)
    coarser = self_affine.SelfAffineWaves(0.8, 2, nx // 64).heights((nx // (2 if nx % 2 == 0 else 3),), 1, range(1))
    coarse = press(coarser, 0.05, "active_set_newton", residual=1e-7)
    assert result.touching.mean() == pytest.approx(coarse.touching.mean(), rel=0.1)


def incompressible(nodes, room_left, mu=0.0, numerics=None):
    """A map of six waves, pressed into an incompressible slab until a part of the room is left, and that room (L_x)."""
    x = np.arange(nodes) / nodes
    rng = np.random.default_rng(nodes)
    heights = sum(
        rng.normal() / k**1.5 * np.cos(2 * np.pi * (i * x + j * x[:, np.newaxis] + rng.uniform()))
        for k, i, j in ((1, 1, 0), (1, 0, 1), (2**0.5, 1, 1), (2, 2, 0), (5**0.5, 1, -2), (8**0.5, 2, 2))
    )
    heights *= 0.001
    room = heights.max() - heights.mean()
    scene = {
        "dimension": 2,
        "body": {"poissons_ratio": 0.5, "aspect_ratio": 0.3},
        "roughness": {"method": "measured", "heights": heights, "units": {"z": "L_x"}},
        "interface": {"hard_wall": {}} | ({"friction": {"coefficient": mu}} if mu else {}),
        "loading": {"displacement": float((1.0 - room_left) * room)},
    }
    return gfmd_numba.solve({"scene": scene, "numerics": numerics or {}}), room_left * room


@pytest.mark.parametrize("nodes", [pytest.param(8, marks=pytest.mark.long), 13])
@pytest.mark.parametrize("mu", [0.0, 0.3])
@pytest.mark.parametrize("room_left", [1e-2, 1e-4])
def test_an_incompressible_slab_that_hardly_has_room_left_keeps_its_volume(nodes, mu, room_left):
    """Of full contact, the first guess on so small a grid, the uniform pressure grows without bound."""
    found, room = incompressible(nodes, room_left, mu)
    assert int(found["status"]) == Status.ok
    gap, pressure = found["gap"].values, found["pressure"].values
    assert gap.mean() == pytest.approx(room, abs=1e-8)
    assert gap.min() >= 0.0
    assert abs(pressure[gap > 0.0]).max() == 0.0
    assert pressure.max() < 0.1


@pytest.mark.filterwarnings("ignore:stagnated:UserWarning")
@pytest.mark.filterwarnings("ignore:steps_used_up:UserWarning")
def test_a_huge_uniform_pressure_does_not_hide_that_the_volume_changes():
    """Conjugate gradients take it from full contact, and tractions are measured by the largest pressure."""
    numerics = {"solver": "conjugate_gradients", "max_iterations": 3000}
    for nodes in (8, 9, 13):
        found, room = incompressible(nodes, 1e-4, numerics=numerics)
        assert int(found["status"]) in (Status.ok, Status.steps_used_up, Status.stagnated)
        if found["status"] == Status.ok:
            assert float(found["gap"].mean()) == pytest.approx(room, abs=1e-9)
