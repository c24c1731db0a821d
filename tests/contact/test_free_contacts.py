"""Contacts without a period: Hertz's, those of a dense solution, and what periodic ones tend to."""

import tracemalloc
from warnings import catch_warnings

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.arrays import threads
from gfmd_numba.contact import free_window
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import solve
from gfmd_numba.elasticity import free_body, stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid, transform
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.surfaces import given_surface
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from gfmd_numba.solvers.tiles import newton
from support.adhesive_sphere import pull_off
from support.cases import some_of
from support.cells import rubbed
from support.rough_windows import rough

WALL = {"hard_wall": {}}
RADIUS = 4.0  # over L_x


def parabola(n, dimension):
    """Heights `[(y,) x]` in L_x of a cylinder or a sphere in the middle of a window."""
    x = np.arange(n) / n - 0.5  # a node at the apex
    return -(x**2 if dimension == 1 else x**2 + x[:, np.newaxis] ** 2) / (2.0 * RADIUS)


def scene_of(heights, loading, **more):
    """Scene of heights in L_x = 1 m that press on a half-space of E* = 1 Pa / 0.75."""
    own = {"body": {"youngs_modulus": 1.0, "poissons_ratio": 0.5}, "interface": WALL, "length": 1.0}
    surface = {"method": "measured", "heights": heights, "units": {"z": "m"}}
    scene = own | {"roughness": surface, "loading": loading, "periodic": False, "dimension": heights.ndim}
    return {"scene": scene | more.pop("scene", {}), **more}


MODULUS = 1.0 / 0.75


def pressed(heights, pressure, solver="active_set_newton", **more):
    """Contact of heights `[(y,) x]` without a period, in units of their gradient."""
    surface, _ = given_surface(heights, periodic=False)
    loaded = more.pop("displacement", None)
    load = None if loaded is not None else pressure
    numerics = Options(solver, residual=1e-10)
    laws = more.pop("laws", Interactions(True))
    return solve(Problem(surface, ElasticBody(None, None), laws, load, loaded, numerics, periodic=False), range(1))


def dense(punch, pressure):
    """Pressures `[node]` of the equilibrium of a punch by linear algebra alone: contact is guessed and revised."""
    shape, n = punch.shape, punch.size
    kernel = np.fft.irfftn(free_body.compliance(shape)[0], tuple(2 * m for m in shape), axes=range(punch.ndim))
    places = np.stack(np.unravel_index(np.arange(n), shape))
    influence = kernel[tuple(abs(places[:, :, np.newaxis] - places[:, np.newaxis]))]
    contact = np.ones(n, dtype=bool)
    for _ in range(200):
        nodes = np.flatnonzero(contact)
        system = np.block([[influence[np.ix_(nodes, nodes)], -np.ones((len(nodes), 1))], [np.ones(len(nodes)), 0.0]])
        *found, sunk = np.linalg.solve(system, [*-punch.ravel()[nodes], pressure * n])
        tractions = np.zeros(n)
        tractions[nodes] = found
        gap = punch.ravel() + influence @ tractions - sunk
        revised = np.where(contact, tractions > 0.0, gap < -1e-14)
        if (revised == contact).all():
            return tractions.reshape(shape), sunk
        contact = revised
    raise AssertionError("the contact goes on changing")


@pytest.mark.filterwarnings("ignore")  # a parabola is no measurement
@pytest.mark.parametrize(("dimension", "n", "error"), [(1, 256, 2e-5), (1, 1024, 3e-6), (2, 64, 6e-4), (2, 128, 8e-5)])
def test_a_cylinder_and_a_sphere_sink_in_and_press_as_hertz_has_it(dimension, n, error):
    """Of second order in the spacing: approach and peak pressure (Johnson, Contact Mechanics, 4.2 and 4.45)."""
    a = 0.2
    if dimension == 1:
        loading = {"line_load": np.pi * a**2 / (4.0 * RADIUS) * MODULUS}
        approach, peak = a**2 / (2.0 * RADIUS) * (np.log(2.0 / a) + 0.5), a / (2.0 * RADIUS)
    else:
        loading = {"force": 4.0 * a**3 / (3.0 * RADIUS) * MODULUS}
        approach, peak = a**2 / RADIUS, 2.0 * a / (np.pi * RADIUS)
    found = gfmd_numba.solve(scene_of(parabola(n, dimension), loading))
    assert found["status"] == 0
    assert float(found["approach"]) == pytest.approx(approach, rel=error)
    assert float(found["pressure"].max()) == pytest.approx(peak * MODULUS, rel=error)
    area = 2.0 * a if dimension == 1 else np.pi * a**2
    assert float(found["contact_area_fraction"]) == pytest.approx(area, rel=0.02 if n >= 256 else 0.04)
    energy = 0.4 * loading["force"] * approach if dimension == 2 else None
    if energy is not None:
        assert float(found["elastic_energy"]) == pytest.approx(energy, rel=error)


@pytest.mark.parametrize(("shape", "pressure"), [((64,), 0.02), ((64,), 0.3), ((20, 20), 0.02), ((20, 20), 0.3)])
@pytest.mark.parametrize("solver", ["active_set_newton", "conjugate_gradients"])
def test_a_rough_window_is_pressed_as_linear_algebra_has_it(shape, pressure, solver):
    contact = pressed(rough(shape[0], len(shape)), pressure, solver)
    heights = contact.heights[0]
    expected, sunk = dense(heights.max() - heights, pressure)
    np.testing.assert_allclose(contact.equilibrium.pressure[0], expected, atol=1e-8 * expected.max())
    assert contact.equilibrium.status[0] == 0
    assert float(contact.approach.item()) == pytest.approx(sunk, rel=1e-8)
    assert (contact.equilibrium.touching[0] == (expected > 0.0)).all()
    gap = contact.punch - contact.equilibrium.displacement
    assert gap.min() > -1e-12


@pytest.mark.parametrize(("dimension", "order"), [(1, 2.0), (2, 3.0)])
def test_a_periodic_contact_tends_to_it_as_its_period_grows(dimension, order):
    """What is left of the images of a contact falls with the square of the period, of maps with its cube."""
    n, pressure = 16 if dimension == 2 else 64, 0.05
    contact = pressed(rough(n, dimension), pressure)
    punch, found = contact.heights.max() - contact.heights[0], contact.equilibrium.pressure[0]
    errors = []
    for periods in (2, 4, 8, 16):
        wide = np.full((1, *(periods * n,) * dimension), punch.max() + 1.0)
        corner = (0, *(slice(n),) * dimension)
        wide[corner] = punch
        symbol = stiffness.half_space(grid.magnitudes(wide.shape[1:], (float(periods),) * dimension))
        response = SpectralResponse.of_normal(symbol)
        numerics = Options("active_set_newton", residual=1e-10)
        pressures = equilibrate(wide, response, pressure / periods**dimension, numerics).pressure[corner]
        errors.append(np.sqrt(((pressures - found) ** 2).mean()) / found.max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 2e-3
    assert orders[0] == pytest.approx(order, abs=0.5)


@pytest.mark.parametrize("solver", ["active_set_newton", "conjugate_gradients", "truncated_newton", "verlet", "fire"])
def test_every_solver_finds_the_same_contact(solver):
    heights = rough(24, 2)
    expected = pressed(heights, 0.1)
    surface, _ = given_surface(heights, periodic=False)
    numerics = Options(solver, residual=1e-7, max_iterations=100_000)
    problem = Problem(surface, ElasticBody(None, None), Interactions(True), 0.1, None, numerics, periodic=False)
    found = solve(problem, range(1))
    assert found.equilibrium.status[0] == 0
    peak = expected.equilibrium.pressure.max()
    np.testing.assert_allclose(found.equilibrium.pressure, expected.equilibrium.pressure, atol=1e-4 * peak)
    assert found.approach.item() == pytest.approx(expected.approach.item(), rel=1e-5)


@pytest.mark.parametrize("dimension", [1, 2])
def test_a_prescribed_displacement_is_the_approach_of_its_load(dimension):
    heights = rough(48 if dimension == 1 else 24, dimension)
    loaded = pressed(heights, 0.1)
    moved = pressed(heights, None, displacement=loaded.approach.item())
    assert moved.approach.item() == pytest.approx(loaded.approach.item(), rel=1e-12)
    assert moved.equilibrium.pressure.mean() == pytest.approx(0.1, rel=1e-7)
    for one, other in ((moved.punch, loaded.punch), (moved.equilibrium.displacement, loaded.equilibrium.displacement)):
        np.testing.assert_allclose(one, other, atol=1e-7)


@pytest.mark.filterwarnings("ignore")  # steps are no slips of an instrument
def test_a_flat_part_at_the_edge_of_the_window_does_not_touch_what_is_across():
    """A ridge at each end is two contacts, and neither has an edge where the window ends."""
    heights = np.zeros(64)
    heights[:5] = heights[-7:] = 0.01
    heights += np.linspace(0.0, 1e-4, 64)
    found = gfmd_numba.solve(scene_of(heights, {"line_load": 1e-3}))
    assert int(found["n_segments"]) == 2
    assert int((found["gap"] <= 0.0).sum()) == 12
    assert "the edge of the window" in found.attrs["validity"]
    assert float(found["contact_area_fraction"]) == pytest.approx((12 - 2 * 0.19) / 64, abs=1e-4)
    both = np.zeros((16, 16))
    both[:, :3] = both[:, -3:] = 0.01
    both += 1e-5 * np.random.default_rng(0).random(both.shape)
    of_map = gfmd_numba.solve(scene_of(both, {"force": 2e-3}))
    assert int(of_map["n_segments"]) == 2


def test_a_measured_patch_is_filtered_and_resampled_without_a_seam():
    """A tilted wave: as many nodes, twice as many, and half its waves; where a period would close it jumps."""
    x = np.arange(64) / 64
    heights = 0.01 * np.cos(6.0 * np.pi * (x + 1.0 / 128)) + 0.05 * x  # even about both ends but for the tilt
    whole = {"method": "measured", "heights": heights}
    scene = {"body": {"poissons_ratio": 0.3}, "interface": WALL, "periodic": False}
    scene |= {"loading": {"reduced_pressure": 1e-3}}

    def resampled(**how):
        with catch_warnings(action="ignore"):
            return gfmd_numba.solve({"scene": scene | {"roughness": whole | how}})["height"].values

    finer = resampled(points=128)
    assert finer.shape == (128,)
    np.testing.assert_allclose(finer[::2], heights, atol=1e-12)
    assert abs(np.diff(finer)).max() < 0.002
    smooth = resampled(cutoff=0.5)
    assert abs(np.polynomial.Polynomial.fit(x, smooth, 1).convert().coef[1] - 0.05) < 0.01
    assert smooth.std() < heights.std()


def test_a_path_of_loads_comes_back_to_where_it_was():
    file = scene_of(parabola(32, 2), {"force": 1e-3}, path=[{"force": 2e-3}, {"force": 1e-3}])
    for solver in ("auto", "truncated_newton"):
        found = gfmd_numba.solve(file | {"numerics": {"solver": solver}})
        assert (found["status"] == 0).all()
        first, last = found.isel(step=0), found.isel(step=2)
        np.testing.assert_allclose(first["pressure"], last["pressure"], atol=1e-6 * float(first["pressure"].max()))
        approach = found["approach"].values
        assert approach[1] / approach[0] == pytest.approx(2.0 ** (2.0 / 3.0), rel=5e-3)


def test_a_load_that_is_repeated_begins_where_it_has_ended():
    contact = pressed(rough(64, 1), 0.02)
    found, sunk = contact.equilibrium, contact.approach
    response = free_body.response((64,), ElasticBody(None, None), (True,))
    begun = free_window.start(following(found, contact.punch + sunk, 0.0), found, sunk, response, (True,))
    reached = found.displacement + sunk
    assert abs(sunk).min() > 0.1 * np.ptp(reached)
    np.testing.assert_allclose(begun.displacement[:, :64], reached, atol=1e-8 * np.ptp(reached))


def test_random_surfaces_are_patches_of_wider_ones():
    """Their ends do not meet, their numbers belong to the seed, and refining the grid refines the same patch."""
    roughness = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1}
    scene = {"body": {"poissons_ratio": 0.3}, "roughness": roughness, "interface": WALL, "periodic": False}
    eps = {"eps_c": 1 / 8, "eps_f": 1 / 8, "eps_t": 1 / 2}
    file = {"scene": scene | {"loading": {"reduced_pressure": 0.05}}, "discretisation": eps, "seed": 3}
    found = gfmd_numba.solve(file)
    assert found["status"] == 0
    assert found.sizes["x"] == 256
    height = found["height"].values
    assert abs(height[0] - height[-1]) > 5.0 * abs(np.diff(height)).mean()
    assert float(found["rms_gradient"]) == pytest.approx(0.1, rel=0.3)
    finer = gfmd_numba.solve(file | {"discretisation": eps | {"eps_c": 1 / 16}})["height"].values[::2]
    np.testing.assert_allclose(finer - finer.mean(), height - height.mean(), atol=1e-3 * np.ptp(height))
    xr.testing.assert_identical(found.drop_vars("wall_time"), gfmd_numba.solve(file).drop_vars("wall_time"))


def test_the_dataset_says_that_it_is_a_window():
    found = gfmd_numba.solve(scene_of(parabola(64, 1), {"line_load": 1e-3}))
    assert found["x"].attrs["points_per_window"] == 64
    assert "points_per_period" not in found["x"].attrs
    assert "nayak" not in found
    assert found["approach"].attrs["units"] == "m"


def test_a_hardness_bounds_the_pressure_and_leaves_a_dent():
    hardness = 0.03
    wall = {"interface": {"hard_wall": {"hardness": hardness}}}
    file = scene_of(parabola(32, 2), {"force": 2e-3}, path=[{"force": 1e-3}], scene=wall)
    found = gfmd_numba.solve(file)
    assert (found["status"] == 0).all()
    assert float(found["pressure"].max()) == pytest.approx(hardness, rel=1e-6)
    assert float(found["pressure"].isel(step=1).max()) < hardness
    assert (found["mean_plastic_depth"].diff("step") == 0.0).all()
    assert (found["pressure"].mean(["y", "x"]) == pytest.approx([2e-3, 1e-3], rel=1e-7)).all()


@pytest.mark.parametrize(
    ("tabor", "work", "around", "points", "error"),
    [pytest.param(0.1, 3e-5, -0.28, 64, 2e-3, marks=pytest.mark.long), (0.5, 1e-3, -0.39, 48, 4e-3)],
)
def test_an_adhesive_sphere_is_pulled_off_as_rings_of_pressure_have_it(tabor, work, around, points, error):
    """A rigid paraboloid of radius 1, of which no grid and no transform knows (`support/adhesive_sphere.py`).

    From near Derjaguin, Muller and Toporov's 2 pi w to near Johnson, Kendall and Roberts's 3 pi w / 2.
    """
    length, unit = work ** (2.0 / 3.0) / tabor, (9.0 * np.pi * work / 8.0) ** (2.0 / 3.0)
    way = (around + np.array([0.1, 0.0, -0.1])) * unit
    scene = {
        "dimension": 2,
        "body": {"poissons_ratio": 0.3},
        "form": {"radius": 1.0, "points": points},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": work, "range": length}},
        "periodic": False,
        "loading": {"displacement": float(way[0])},
    }
    path = [{"displacement": float(step)} for step in way[1:]]
    found = gfmd_numba.solve({"scene": scene, "path": path, "numerics": {"residual": 1e-6}})
    assert (found["status"] == 0).all()
    bent, tilt, largest = np.polyfit(np.arange(-1, 2), -found["mean_pressure"].values, 2)
    known = pull_off(work, length, 160 if tabor < 1.0 else 640)
    assert largest - tilt**2 / (4.0 * bent) == pytest.approx(known, rel=error)
    assert float(found["pull_off_pressure"]) == pytest.approx(known, rel=5e-3)
    assert 1.5 < known / (np.pi * work) < 2.0
    assert (found["stability"] > 0.05).all()
    np.testing.assert_allclose(found["approach"], found["punch_displacement"], rtol=1e-11)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"interface": WALL | {"friction": {"coefficient": 0.3}}, "body": {"poissons_ratio": 0.0}}, "poissons_ratio"),
        ({"roughness": {"method": "measured", "heights": [0.0, 1.0, 0.0, 2.0], "periodic": "mirror"}}, "periodic"),
        ({"periodic": "perhaps"}, "periodic"),
    ],
)
def test_what_is_not_built_or_makes_no_sense_is_refused(change, named):
    scene = {"body": {"poissons_ratio": 0.3}, "interface": WALL, "loading": {"reduced_pressure": 0.1}}
    scene |= {"roughness": {"method": "measured", "heights": [0.0, 1.0, 0.0, 2.0]}, "periodic": False}
    with pytest.raises(gfmd_numba.InputError, match=named):
        gfmd_numba.solve({"scene": scene | change})


def influence_of_all(shape, nu):
    """Displacement `[component, node, component, node]` by unit tractions, from the compliance of each wave."""
    wide, n = tuple(2 * m for m in shape), int(np.prod(shape))
    response = free_body.response(shape, ElasticBody(nu, None), couples=True)
    found = []
    for component in range(len(shape) + 1):
        for place in np.ndindex(shape):
            traction = np.zeros((len(shape) + 1, *wide))
            traction[(component, *place)] = 1.0
            found.append(response.apply(traction)[(..., *(slice(m) for m in shape))].ravel())
    return np.array(found).T.reshape(len(shape) + 1, n, len(shape) + 1, n)


@pytest.mark.parametrize(("shape", "nu"), [((48,), 0.3), ((48,), 0.5), ((10, 10), 0.3)])
def test_friction_holds_what_coulomb_lets_it_hold_and_the_body_is_displaced_by_that(shape, nu):
    """Pressed, then dragged along x: displacements by linear algebra, and the conditions at each node."""
    friction = 0.3
    heights = rough(shape[0], len(shape))
    surface, _ = given_surface(heights, periodic=False)
    laws = Interactions(True, friction=friction)
    drag = (0.02, *(0.0,) * (len(shape) - 1))
    numerics = Options("frictional_newton", residual=1e-9)
    problem = Problem(surface, ElasticBody(nu, None), laws, 0.1, None, numerics, periodic=False)
    first = solve(problem, range(1))
    contact = solve(problem.under(problem.step._replace(sliding=drag)), first.after)
    found = contact.equilibrium
    assert found.status[0] == 0
    tangential, pressure = found.tangential, found.pressure[0].ravel()
    tractions = np.concatenate((tangential.traction[0], -found.pressure), axis=0).reshape(len(shape) + 1, -1)
    u = np.einsum("inkm,km->in", influence_of_all(shape, nu), tractions)
    np.testing.assert_allclose(u[-1], found.displacement[0].ravel(), atol=1e-8 * abs(u).max())
    moved = tangential.displacement[0].reshape(len(shape), -1)
    np.testing.assert_allclose(u[:-1], moved, atol=1e-8 * abs(u).max())
    gap = contact.punch[0].ravel() - u[-1]
    touching = pressure > 0.0
    assert abs(gap[touching]).max() < 1e-8
    assert gap.min() > -1e-8
    rubs = np.linalg.norm(tractions[:-1], axis=0)
    assert (rubs <= friction * pressure + 1e-7 * pressure.max()).all()
    slip = tangential.slip[0].reshape(len(shape), -1)
    slid = np.linalg.norm(slip, axis=0) > 1e-9
    assert (slid & touching).any()
    against = -friction * pressure * slip / np.where(slid, np.linalg.norm(slip, axis=0), 1.0)
    np.testing.assert_allclose(tractions[:-1, slid & touching], against[:, slid & touching], atol=1e-6 * pressure.max())


@pytest.mark.parametrize("nu", [pytest.param(0.3, marks=pytest.mark.long), 0.5])
def test_a_sphere_slips_partly_as_cattaneo_and_mindlin_and_a_dense_matrix_of_cells_have_it(nu):
    """Pressed to a depth under friction, then dragged to where closed forms have 0.6 of the force of full slip.

    These leave out the coupling of pressure and traction, and that slip is not quite along x (Johnson, Contact
    Mechanics, 7.2). The cells of Love and Cerruti (`support/cells.py`) know both; they are another discretisation.
    """
    a, friction, held = 0.3, 0.5, 0.6
    depth, force, modulus = a**2 / RADIUS, 4.0 * a**3 / (3.0 * RADIUS), 0.5 * (1.0 - nu)
    largest = 3.0 * friction * force * (2.0 - nu) / (16.0 * modulus * a)
    way = largest * (1.0 - (1.0 - held) ** (2.0 / 3.0))
    scene = {
        "dimension": 2,
        "periodic": False,
        "body": {"poissons_ratio": nu},
        "form": {"radius": RADIUS, "points": 48},
        "interface": WALL | {"friction": {"coefficient": friction}},
        "loading": {"displacement": depth},
    }
    found = gfmd_numba.solve({"scene": scene, "path": [{"sliding": way}]})
    assert (found["status"] == 0).all()
    rubs, pressures = found["mean_tangential_traction"].values[1], found["mean_pressure"].values
    cells = 16
    x = np.arange(cells) / cells - 0.5
    first, last = rubbed(
        cells * ((x**2 + x[:, np.newaxis] ** 2) / (2.0 * RADIUS) - depth), nu, friction, [0, cells * way]
    )
    assert rubs == pytest.approx(last[0].mean(), rel=4e-3)
    assert pressures == pytest.approx([first[2].mean(), last[2].mean()], rel=4e-3)
    if nu == 0.5:
        assert rubs == pytest.approx(held * friction * force, rel=4e-3)
        assert pressures == pytest.approx(force, rel=2e-3)
        stick = (1.0 - held) ** (2.0 / 3.0)  # the square of the radius that sticks over that of contact
        assert float(found["stick_fraction"][1]) == pytest.approx(stick, abs=0.05)


@pytest.mark.filterwarnings("ignore")  # the contact reaches the edge of the window
def test_a_cohesive_law_holds_sideways():
    law = {"cohesive": {"work_of_adhesion": 1e-4, "normal_length": 0.02, "tangential_length": 0.02}}
    surface = {"method": "measured", "heights": rough(64, 1) * 0.05}
    scene = {"body": {"poissons_ratio": 0.3}, "roughness": surface, "interface": WALL | law, "periodic": False}
    file = {"scene": scene | {"loading": {"reduced_pressure": 0.05}}, "path": [{"sliding": 1e-3}]}
    found = gfmd_numba.solve(file)
    assert (found["status"] == 0).all()
    assert float(found["mean_tangential_traction"].isel(step=1)) > 0.0


CAMPAIGN = {
    "name": "patches",
    "seed": 1,
    "realisations": 2,
    "scene": {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1},
        "interface": WALL,
        "loading": {"reduced_pressure": 0.05},
        "periodic": False,
    },
    "reference": {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2},
    "grid": {"reduced_pressure": [0.02, 0.05]},
}


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:the contact reaches the edge")
def test_a_campaign_takes_the_means_of_patches(tmp_path):
    with pytest.warns(UserWarning, match="^in 1 of 2 cases: the contact reaches the edge of the window"):
        found = gfmd_numba.run(CAMPAIGN, tmp_path / "patches")
    assert (found["status"] == 0).all()
    file = {"scene": CAMPAIGN["scene"], "discretisation": CAMPAIGN["reference"], "seed": 1, "realisation": 1}
    alone = gfmd_numba.solve(file)
    last = found.isel(case=1, realisation=1)
    for name in ("approach", "kappa", "rms_gradient", "mean_gap"):
        assert float(last[name]) == pytest.approx(float(alone[name]), rel=1e-9)
    assert (found["approach"].diff("case") > 0.0).all()


@pytest.mark.parametrize("key", [{"limits": {"eps_t": [1.0]}}, {"target": {"kappa": 0.05}}])
def test_a_window_has_no_thermodynamic_limit(key):
    without = {name: value for name, value in CAMPAIGN.items() if "target" not in key or name != "realisations"}
    without = {name: value for name, value in without.items() if "target" not in key or name != "reference"}
    with pytest.raises(gfmd_numba.InputError, match=r"^limits: you gave.*eps_c and eps_f alone.*a window has a size"):
        gfmd_numba.run(without | key, "nowhere")


@pytest.mark.long
def test_the_radius_of_a_rough_roller_has_a_limit_with_an_error(tmp_path):
    """In eps_c, each level on the same surfaces; a variable that needs a form or a window is refused without."""
    limits = {"limits": {"eps_c": [1 / 2, 1 / 8]}, "fit": {"variable": "contact_radius", "fixed": {"eps_c": [1, 3]}}}
    scene = {name: value for name, value in CAMPAIGN["scene"].items() if name != "loading"}
    scene |= {"form": {"radius": 4.0}, "loading": {"reduced_pressure": 0.05}}
    campaign = {name: value for name, value in CAMPAIGN.items() if name != "grid"} | limits
    found = gfmd_numba.run(campaign | {"scene": scene, "realisations": 3}, tmp_path / "rollers")
    fit = gfmd_numba.fit_tfc(found, "contact_radius", fixed={"eps_c": (1.0, 3.0)}).squeeze()
    finest = found["contact_radius"].isel(case=int(found["eps_c"].values.argmin())).mean()
    assert float(fit["contact_radius_tfc"]) == pytest.approx(float(finest), rel=0.02)
    assert 0.0 < float(fit["contact_radius_tfc_error"]) < 0.2 * float(finest)
    with pytest.raises(gfmd_numba.InputError, match=r"contact_radius.*this needs a form"):
        gfmd_numba.run(campaign, tmp_path / "none")
    periodic = {"scene": campaign["scene"] | {"periodic": True}, "fit": {"variable": "approach"}}
    with pytest.raises(gfmd_numba.InputError, match=r"approach.*this needs a scene without a period"):
        gfmd_numba.run(campaign | periodic, tmp_path / "none")


LAYERS = ElasticBody.layered((0.02, 0.08), (Material(1.0, 0.3), Material(0.3, 0.4)), None)


@pytest.mark.parametrize(
    "body", some_of([ElasticBody(0.3, 0.1), ElasticBody(0.45, 0.25), ElasticBody(0.2, 1.0), LAYERS], 1, 3)
)
@pytest.mark.parametrize("dimension", [1, 2])
def test_a_slab_is_pressed_as_in_a_period_that_is_long_beside_its_height(body, dimension):
    n, pressure = (64 if dimension == 1 else 16), 0.05
    periods = 4 if body.aspect_ratio < 0.2 else 16 if dimension == 1 else 12
    heights = rough(n, dimension)
    surface, _ = given_surface(heights, periodic=False)
    numerics = Options("active_set_newton", residual=1e-10)
    contact = solve(Problem(surface, body, Interactions(True), pressure, None, numerics, periodic=False), range(1))
    punch, found = contact.heights.max() - contact.heights[0], contact.equilibrium.pressure[0]
    wide = np.full((1, *(periods * n,) * dimension), punch.max() + 1.0)
    corner = (0, *(slice(n),) * dimension)
    wide[corner] = punch
    symbol = body.condensed_stiffness(grid.magnitudes(wide.shape[1:], (float(periods),) * dimension))
    pressures = equilibrate(wide, SpectralResponse.of_normal(symbol), pressure / periods**dimension, numerics).pressure
    np.testing.assert_allclose(found, pressures[corner], atol=1e-4 * found.max())
    assert contact.approach.item() > 0.0


def test_a_slab_is_no_half_space_where_only_its_mean_tells():
    """A slab as high as the window is wide holds what a half-space lets go."""
    heights = parabola(64, 1)
    approaches = []
    for body in ({"poissons_ratio": 0.3}, {"poissons_ratio": 0.3, "aspect_ratio": 1.0}):
        scene = {"body": body | {"youngs_modulus": 1.0}}
        approaches.append(float(gfmd_numba.solve(scene_of(heights, {"line_load": 1e-3}, scene=scene))["approach"]))
    assert approaches[1] < 0.9 * approaches[0]


@pytest.mark.parametrize("height", [0.03, 0.1, 0.5])
@pytest.mark.parametrize("depth", [0.3, 3.0])
def test_a_slab_that_keeps_its_volume_bulges_around_the_window_and_touches_nothing_there(height, depth):
    """Pressed all over the window: what it is displaced by is that of the pressure in the window alone."""
    n, body = 40, ElasticBody(0.499, height)
    surface, _ = given_surface(parabola(n, 1), periodic=False)
    numerics = Options("active_set_newton", residual=1e-9)
    contact = solve(Problem(surface, body, Interactions(True), None, depth, numerics, periodic=False), range(1))
    assert contact.equilibrium.status[0] == 0
    wide = np.zeros((1, 2 * n))
    wide[0, :n] = -contact.equilibrium.pressure[0]
    expected = free_body.response((n,), body).apply(wide)[0, :n]
    np.testing.assert_allclose(contact.equilibrium.displacement[0], expected, atol=1e-9 * depth)


@pytest.mark.parametrize("pressure", [0.01, 0.1, 0.5])
def test_a_profile_takes_no_more_transforms_than_a_periodic_one(pressure):
    heights, numerics = rough(2048, 1), Options("active_set_newton")
    taken = []
    for periodic in (True, False):
        surface, _ = given_surface(heights, periodic=periodic)
        problem = Problem(
            surface, ElasticBody(None, None), Interactions(True), pressure, None, numerics, periodic=periodic
        )
        taken.append(int(solve(problem, range(1)).equilibrium.n_transforms[0]))
    assert taken[1] <= taken[0]


@pytest.mark.parametrize(("shape", "most"), [((2**14,), 2.1), ((128, 128), 4.0)])
def test_a_contact_takes_twice_the_memory_of_a_periodic_one_on_profiles_and_less_than_four_times_on_maps(shape, most):
    heights, peaks = rough(shape[0], len(shape)), []
    for periodic in (True, False):
        surface, _ = given_surface(heights, periodic=periodic)
        numerics = Options("active_set_newton")
        problem = Problem(surface, ElasticBody(None, None), Interactions(True), 0.05, None, numerics, periodic=periodic)
        solve(problem, range(1))  # samples the kernel and loads what is compiled
        tracemalloc.start()
        solve(problem, range(1))
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < most * peaks[0]


@pytest.mark.parametrize("exactly", [False, True])
def test_rows_around_the_window_of_a_map_are_transformed_for_an_exact_certificate_alone(monkeypatch, exactly):
    if exactly:
        monkeypatch.setattr(newton.MapContact, "bound", lambda contact: np.inf)
    n, filled, plain = 64, [], transform._Blocks.multiply

    def told(self, symbol, size, divide, some, *ways):
        if size == 4 * n * n:
            filled.append(some)
        plain(self, symbol, size, divide, some, *ways)

    monkeypatch.setattr(transform._Blocks, "multiply", told)
    assert pressed(rough(n, 2), 0.05).equilibrium.status == Status.ok
    assert filled.count(True) >= 2
    assert filled.count(False) == exactly


def test_threads_change_no_bit_of_a_window(monkeypatch):
    monkeypatch.setattr(threads, "cores", lambda: 3)
    monkeypatch.setattr(threads, "_FEWEST", 0)
    monkeypatch.setattr(threads, "_PIECE", 32)
    found = []
    for number in (1, 2, 3):
        with threads.shared_by(number):
            found.append(pressed(rough(64, 2), 0.05).equilibrium)
    for each in found[1:]:
        np.testing.assert_array_equal(each.pressure, found[0].pressure)
        np.testing.assert_array_equal(each.displacement, found[0].displacement)


@pytest.mark.parametrize("load", [0.2, None])
def test_a_window_of_a_map_is_solved_as_the_whole_grid_is(load):
    """By solvers that know nothing of windows, on the grid with what is around."""
    n, body = 52, ElasticBody(None, None)  # a tile ends beyond the window
    punch, around = rough(n, 2)[np.newaxis], np.full((1, 1, 1), 3.0)
    punch -= punch.min() + (0.0 if load else 0.5)
    response = free_body.response((n, n), body)
    found, expected = (
        equilibrate(punch, response, load, Options(solver), around=around)
        for solver in ("active_set_newton", "conjugate_gradients")
    )
    assert found.status[0] == expected.status[0] == Status.ok
    np.testing.assert_array_equal(found.touching, expected.touching)
    np.testing.assert_allclose(found.pressure, expected.pressure, atol=1e-7 * expected.pressure.max())
    offset = found.mean_displacement - expected.mean_displacement
    np.testing.assert_allclose(found.displacement - offset, expected.displacement, atol=1e-7)


def test_periodic_is_true_or_false():
    wrong = scene_of(parabola(8, 1), {"line_load": 1e-4}, scene={"periodic": "maybe"})
    with pytest.raises(gfmd_numba.InputError, match=r"periodic: you gave 'maybe'; gfmd allows true or false"):
        gfmd_numba.solve(wrong)


@pytest.mark.filterwarnings("ignore:no_equilibrium:UserWarning")
def test_a_contact_that_reaches_around_the_window_is_not_ok(monkeypatch):
    """As if a body bulged beyond every wall around the window."""
    monkeypatch.setattr(free_window, "FARTHER", (-5.0,))
    found = gfmd_numba.solve(scene_of(parabola(64, 1), {"line_load": 1e-2}))
    assert int(found["status"]) == Status.no_equilibrium
