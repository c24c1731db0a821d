"""Maps with a period along y alone (`periodic: y`): the body is free on both sides along x."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.contact import evaluation
from gfmd_numba.contact.problem import Problem, given_surface
from gfmd_numba.contact.solution import solve
from gfmd_numba.elasticity import free_body, stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options

NUMERICS = Options("active_set_newton", residual=1e-10)
WALL = {"hard_wall": {}}
STEEL = {"youngs_modulus": 0.91, "poissons_ratio": 0.3}  # E* = 1 Pa


def scene_of(form, load, points=64, **more):
    own = {"dimension": 2, "periodic": "y", "body": STEEL, "interface": WALL, "length": 1.0}
    return own | {"form": form | {"points": points}, "loading": {"force": load}} | more


def rough(n, seed=1):
    """Heights `[y, x]` that repeat along both axes."""
    q = grid.magnitudes((n, n))
    waves = np.where((q > 8.0) & (q < 0.5 * np.pi * n), np.maximum(q, 1.0) ** -1.8, 0.0)
    return grid.signal(waves * np.exp(2j * np.pi * np.random.default_rng(seed).random(q.shape)), n, n)


@pytest.mark.parametrize("n", [4, 7, 16, 33, 64])
def test_compliances_are_positive_and_nearly_those_of_a_periodic_half_space(n):
    found = 1.0 / free_body.response((n, n), ElasticBody(None, None), (False, True)).normal
    assert found.shape == (n, n + 1)
    assert found.min() > 0.0
    q = grid.magnitudes((n, 2 * n), (1.0, 2.0))
    q[0] = 2.0  # waves along x alone are those of a profile
    np.testing.assert_allclose(found[1:], 2.0 / q[1:], rtol=0.05)
    np.testing.assert_allclose(found[0], free_body.compliance((n,))[0], rtol=1e-14)


def test_a_cylinder_along_y_is_that_of_a_profile():
    load = 0.01 * np.pi / 4.0
    of_map = gfmd_numba.solve(scene_of({"radius": 4.0, "radius_y": 1e9}, load))
    profile = {"dimension": 1, "periodic": False, "form": {"radius": 4.0, "points": 64}}
    of_profile = gfmd_numba.solve(scene_of({}, load) | profile | {"loading": {"line_load": load}})
    np.testing.assert_allclose(
        of_map["pressure"][5], of_profile["pressure"], atol=1e-6 * of_map["pressure"].max().item()
    )
    for name in ("approach", "contact_area_fraction", "elastic_energy", "mean_gap"):
        assert float(of_map[name]) == pytest.approx(float(of_profile[name]), rel=1e-7), name
    assert int(of_map["n_segments"]) == 1
    assert of_map["x"].attrs["points_per_window"] == of_map["y"].attrs["points_per_period"] == 64


def test_longer_and_longer_periods_along_x_tend_to_it():
    """With order 2, as those of a line load: what repeats along y is one from afar."""
    n, pressure = 24, 0.05
    surface, _ = given_surface(rough(n))
    problem = Problem(surface, ElasticBody(None, None), Interactions(True), pressure, None, NUMERICS, periodic="y")
    contact = solve(problem, range(1))
    assert contact.equilibrium.status[0] == 0
    punch, found = contact.heights.max() - contact.heights[0], contact.equilibrium.pressure[0]
    errors = []
    for periods in (2, 4, 8):
        wide = np.full((1, n, periods * n), punch.max() + 1.0)
        wide[0, :, :n] = punch
        symbol = stiffness.half_space(grid.magnitudes(wide.shape[1:], (1.0, float(periods))))
        pressures = equilibrate(wide, SpectralResponse.of_normal(symbol), pressure / periods, NUMERICS).pressure
        errors.append(np.sqrt(((pressures[0, :, :n] - found) ** 2).mean()) / found.max())
    assert errors[-1] < 2e-3
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.3)


def test_a_rough_window_is_pressed_as_linear_algebra_has_it():
    n, pressure = 16, 0.1
    surface, _ = given_surface(rough(n))
    problem = Problem(surface, ElasticBody(None, None), Interactions(True), pressure, None, NUMERICS, periodic="y")
    contact = solve(problem, range(1))
    kernel = np.fft.irfft2(1.0 / free_body.response((n, n), ElasticBody(None, None), (False, True)).normal, (n, 2 * n))
    y, x = np.unravel_index(np.arange(n * n), (n, n))
    influence = kernel[(y[:, np.newaxis] - y) % n, abs(x[:, np.newaxis] - x)]
    pressures = contact.equilibrium.pressure[0].ravel()
    sunk = (influence @ pressures)[contact.equilibrium.touching[0].ravel()]
    heights = contact.heights[0].ravel()[contact.equilibrium.touching[0].ravel()]
    level = sunk - heights + contact.heights.max()
    np.testing.assert_allclose(level, contact.approach.item(), rtol=1e-8)
    gap = contact.heights.max() - contact.heights[0].ravel() + influence @ pressures - contact.approach.item()
    assert gap.min() > -1e-10
    assert pressures.mean() == pytest.approx(pressure, rel=1e-8)


def test_a_contact_goes_on_across_y_and_ends_along_x():
    """A ball on the seam along y is one contact with edges all around; one on the seam along x is two."""
    ball = scene_of({"radius": 4.0}, 4.0 * 0.2**3 / 12.0)
    x = np.arange(64) / 64 - 0.5
    heights = -(x**2 + x[:, np.newaxis] ** 2) / 8.0
    _, gradient = given_surface(heights, periodic="y")
    contacts = []
    for axis in (None, 0, 1):
        rolled = heights if axis is None else np.roll(heights, 32, axis=axis)
        rolled_surface, _ = given_surface(rolled, gradient, periodic="y")
        load = ball["loading"]["force"] / gradient
        body, laws = ElasticBody(None, None), Interactions(True)
        contacts.append(solve(Problem(rolled_surface, body, laws, load, None, NUMERICS, periodic="y"), range(1)))
    whole, across_y, across_x = contacts
    assert [int(evaluation.n_segments(each)[0]) for each in contacts] == [1, 1, 2]
    assert evaluation.contact_radius(across_y)[0] == pytest.approx(evaluation.contact_radius(whole)[0], rel=1e-12)
    assert evaluation.contact_radius(whole)[0] == pytest.approx(0.2, rel=0.03)
    assert across_x.approach.item() > 0.0


@pytest.mark.filterwarnings("ignore:the contact reaches the edge")
def test_random_surfaces_laws_paths_hardness_and_energy():
    interface = {"hard_wall": {}, "exponential": {"work_of_adhesion": 2e-5, "range": 0.02}}
    roughness = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02}
    scene = {"dimension": 2, "periodic": "y", "body": {"poissons_ratio": 0.3}, "roughness": roughness}
    file = {"scene": scene | {"interface": interface, "loading": {"displacement": 0.002}}, "seed": 2}
    file["discretisation"] = {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 1}
    found = gfmd_numba.solve(file | {"path": [{"displacement": 0.001}, {"displacement": 0.002}]})
    assert (found["status"] == 0).all()
    np.testing.assert_allclose(found["approach"], found["punch_displacement"], rtol=1e-9)
    assert float(found["mean_pressure"][0]) == pytest.approx(float(found["mean_pressure"][2]), rel=1e-4)
    file["scene"] |= {"interface": {"hard_wall": {"hardness": 0.005}}, "loading": {"reduced_pressure": 0.05}}
    hard = gfmd_numba.solve(file)
    assert int(hard["status"]) == 0
    assert float(hard["pressure"].max()) == pytest.approx(0.005, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"interface": WALL | {"friction": {"coefficient": 0.1}}}, "interface"),
        ({"body": STEEL | {"aspect_ratio": 0.1}}, "body"),
        ({"dimension": 1, "loading": {"line_load": 1.0}}, "periodic"),
        ({"periodic": "x"}, "true or false, or on maps y"),
        ({"periodic": {"x": False}}, "true or false, or on maps y"),
        ({"periodic": 1}, "true or false, or on maps y"),
        ({"boundary": {"normal_traction": 0.0}}, "boundary"),
    ],
)
def test_what_is_not_built_is_refused(change, named):
    with pytest.raises(gfmd_numba.InputError, match=named):
        gfmd_numba.solve(scene_of({"radius": 4.0}, 1e-3, 16) | change)


def test_what_follows_a_contact_is_refused_where_it_would_be_wrong():
    contact = gfmd_numba.solve(scene_of({"radius": 4.0}, 1e-3, 16))
    with pytest.raises(gfmd_numba.InputError, match="periodic: y"):
        gfmd_numba.body_fields(contact)
    with pytest.raises(gfmd_numba.InputError, match="without a period"):
        gfmd_numba.contact_conductance(contact)
    for measure in (gfmd_numba.contact_statistics, gfmd_numba.gap_percolation):
        with pytest.raises(Exception, match="a period along y alone"):
            measure(contact)
