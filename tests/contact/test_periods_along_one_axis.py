"""Maps with a period along x or y alone: the body is free on both sides along the other axis."""

from warnings import catch_warnings

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.contact import evaluation
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import solve
from gfmd_numba.elasticity import free_body, stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.surfaces import given_surface
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options

NUMERICS = Options("active_set_newton", residual=1e-10)
WALL = {"hard_wall": {}}
STEEL = {"youngs_modulus": 0.91, "poissons_ratio": 0.3}  # E* = 1 Pa


RUBS = WALL | {"friction": {"coefficient": 0.4}}
LAYERS = ElasticBody.layered((0.05, 0.2), (Material(1.0, 0.3), Material(0.3, 0.4)), None)


def displaced(body, tractions, ends, periods):
    """Displacements `[component, y, x]` in long periods along the axes that end, wave by wave."""
    shape = tractions.shape[1:]
    lengths = tuple(float(periods) if end else 1.0 for end in ends)
    qy, qx = grid.wavevectors(shape, lengths)
    q = np.hypot(qy, qx)
    waves, places = np.unique(q, return_inverse=True)
    places = places.reshape(q.shape)
    along, both, out = (each[places] for each in body.compliance(waves).elements)
    across = np.append(along.flat[0], body.compliance_across(waves[1:]))[places]
    c, s = (np.where(q > 0.0, each, 1.0) / np.where(q > 0.0, q, 1.0) for each in (qx + 0.0 * qy, qy + 0.0 * qx))
    s[0, 0] = 0.0
    x, y, z = grid.coefficients(tractions, 2)
    if shape[0] % 2 == 0:  # the waves q_y and -q_y are one there
        both = np.array([both * c, both * s])
        both[1, shape[0] // 2] = 0.0
    xy = (along - across) * c * s
    xy[shape[0] // 2] = 0.0
    both[0, :, -1] = xy[:, -1] = 0.0
    moved = (
        (along * c**2 + across * s**2) * x + xy * y + 1j * both[0] * z,
        xy * x + (along * s**2 + across * c**2) * y + 1j * both[1] * z,
    )
    return grid.signal(np.array([*moved, out * z - 1j * (both[0] * x + both[1] * y)]), *shape)


def scene_of(form, load, points=64, **more):
    own = {"dimension": 2, "periodic": "y", "body": STEEL, "interface": WALL, "length": 1.0}
    return own | {"form": form | {"points": points}, "loading": {"force": load}} | more


def rough(n, seed=1):
    """Heights `[y, x]` that repeat along both axes."""
    q = grid.magnitudes((n, n))
    waves = np.where((q > 8.0) & (q < 0.5 * np.pi * n), np.maximum(q, 1.0) ** -1.8, 0.0)
    return grid.signal(waves * np.exp(2j * np.pi * np.random.default_rng(seed).random(q.shape)), n, n)


HALF_SPACE = ElasticBody(None, None)


@pytest.mark.parametrize("n", [4, 7, 16, 33, 64])
def test_compliances_are_positive_and_nearly_those_of_a_periodic_half_space(n):
    found = free_body.compliance((n, n), ends=(False, True))[0]
    assert found.shape == (n, n + 1)
    assert found.min() > 0.0
    q = grid.magnitudes((n, 2 * n), (1.0, 2.0))
    q[0] = 2.0  # waves along x alone are those of a profile
    np.testing.assert_allclose(found[1:], 2.0 / q[1:], rtol=0.05)
    np.testing.assert_allclose(found[0], free_body.compliance((n,))[0], rtol=1e-14)


@pytest.mark.parametrize("body", [ElasticBody(0.3, None), ElasticBody(0.05, None), ElasticBody(0.3, 0.3), LAYERS])
@pytest.mark.parametrize("ends", [(False, True), (True, False), (True, True)])
def test_all_displacements_are_those_in_a_long_period_but_for_what_is_uniform(body, ends):
    """Under spots of traction along x, y and out of the surface, with no sum where far images would tell."""
    n, errors = 16, []
    if body.aspect_ratio is None and all(ends):
        pytest.skip("which `test_free_body.py` compares with integrals")
    x = np.arange(n) / n
    places = ((0.3, 0.4), (0.6, 0.5), (0.5, 0.7))
    spots = np.array([np.exp(-60.0 * ((x - a) ** 2 + (x[:, np.newaxis] - b) ** 2)) for a, b in places])
    tractions = spots - spots[::-1, ::-1] if body.aspect_ratio is None else spots
    corner = grid.corner((n, n))
    padded = np.zeros((3, *free_body.padded_shape((n, n), ends)))
    padded[corner] = tractions
    response = free_body.response((n, n), body, ends, couples=True)
    assert response.principal()[0].min() > 0.0
    found = response.apply(padded)[corner]
    for periods in (4, 8, 16):
        wide = np.zeros((3, *(periods * n if end else n for end in ends)))
        wide[corner] = tractions
        expected = displaced(body, wide, ends, periods)
        off = found - expected[corner]
        if body.aspect_ratio is None:
            off -= off.mean(axis=(1, 2), keepdims=True)
        errors.append(abs(off).max() / abs(found).max())
    if body.aspect_ratio is None:
        np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.2)
    else:
        assert errors[-1] < 1e-6


@pytest.mark.parametrize(
    ("more", "way"),
    [
        ({}, 0.0),
        ({"interface": RUBS, "body": STEEL | {"aspect_ratio": 0.3}}, 5e-4),
    ],
    ids=["half-space", "friction on a slab"],
)
@pytest.mark.parametrize("axis", ["x", pytest.param("y", marks=pytest.mark.long)])
def test_a_cylinder_along_the_period_is_that_of_a_profile(axis, more, way):
    loading, flat = {"displacement": 0.01}, 1e9
    of_map = {"radius": 4.0, "radius_y": flat} if axis == "y" else {"radius": flat, "radius_y": 4.0}
    along, other = ("", "_y") if axis == "y" else ("_y", "")
    path = [{f"sliding{along}": way}] if way else []
    scene = scene_of(of_map, 0.0) | more | {"periodic": axis, "loading": loading}
    profile = {"dimension": 1, "periodic": False, "form": {"radius": 4.0, "points": 64}}
    found = gfmd_numba.solve({"scene": scene, "path": path})
    expected = gfmd_numba.solve({"scene": scene | profile, "path": [{"sliding": way}] if way else []})
    assert (found["status"] == 0).all()
    across = found.isel({axis: 5}).squeeze()
    names = {"pressure": "pressure"} | ({f"tangential_traction{along}": "tangential_traction"} if way else {})
    for name, of_profile in names.items():
        values = expected[of_profile].values
        np.testing.assert_allclose(across[name].values, values, atol=1e-6 * abs(values).max())
    if way:
        assert abs(found[f"tangential_traction{other}"]).max() < 1e-7 * abs(found["pressure"]).max()
    for name in ("approach", "contact_area_fraction", "elastic_energy", "mean_gap"):
        np.testing.assert_allclose(found[name], expected[name], rtol=2e-7, err_msg=name)
    assert (found["n_segments"] == 1).all()
    assert found[axis].attrs["points_per_period"] == 64
    assert found["x" if axis == "y" else "y"].attrs["points_per_window"] == 64


@pytest.mark.long
def test_a_cylinder_slips_partly_as_cattaneo_and_mindlin_have_it():
    """Dragged to where 0.6 of the force of full slip is reached; shear follows pressure (Johnson, 7.2)."""
    a, friction, held, radius = 0.2, 0.5, 0.6, 4.0

    def sunk(half_width):
        return half_width**2 / (2.0 * radius) * (np.log(2.0 / half_width) + 0.5)

    stick = a * np.sqrt(1.0 - held)
    wall = WALL | {"friction": {"coefficient": friction}}
    scene = scene_of({"radius": radius, "radius_y": 1e9}, 0.0, 128) | {"body": {"poissons_ratio": 0.5}, "length": None}
    scene |= {"interface": wall, "loading": {"displacement": sunk(a)}}
    del scene["length"]
    found = gfmd_numba.solve({"scene": scene, "path": [{"sliding": friction * (sunk(a) - sunk(stick))}]})
    force = np.pi * a**2 / (4.0 * radius)
    assert float(found["mean_pressure"][1]) == pytest.approx(force, rel=2e-4)
    assert float(found["mean_tangential_traction"][1]) == pytest.approx(held * friction * force, rel=1e-3)
    x = found["x"].values - 0.5

    def ellipse(half_width):
        return np.sqrt(np.maximum(1.0 - (x / half_width) ** 2, 0.0)) * half_width / (2.0 * radius)

    expected = friction * (ellipse(a) - ellipse(stick))
    inside = (abs(abs(x) - a) > 0.02) & (abs(abs(x) - stick) > 0.02)
    traction = found["tangential_traction"].isel(step=1, y=7).values
    np.testing.assert_allclose(traction[inside], expected[inside], atol=0.02 * expected.max())


def test_x_and_y_may_change_places():
    """A rough map under friction and a law of the gap, and the same turned, equal to rounding."""
    heights = rough(24) * 0.3
    law = {"exponential": {"work_of_adhesion": 1e-5, "range": 0.01}}
    found = []
    for axis, each in (("y", heights), ("x", heights.T)):
        scene = {"dimension": 2, "periodic": axis, "body": {"poissons_ratio": 0.3}, "interface": RUBS | law}
        scene |= {"roughness": {"method": "measured", "heights": each}, "loading": {"displacement": 0.01}}
        way = "sliding" if axis == "y" else "sliding_y"
        with catch_warnings(action="ignore"):  # of no unit, of the edge
            found.append(gfmd_numba.solve({"scene": scene, "path": [{way: 2e-3}], "numerics": {"residual": 1e-9}}))
    one, turned = found
    assert (one["status"] == 0).all()
    assert (turned["status"] == 0).all()
    for name, other in (("pressure", "pressure"), ("tangential_traction", "tangential_traction_y")):
        values, expected = (
            each[key].transpose("step", "y", "x").values for each, key in zip(found, (name, other), strict=True)
        )
        np.testing.assert_allclose(values, expected.swapaxes(1, 2), atol=1e-8 * abs(values).max())
    assert float(turned["rms_gradient"][0]) == pytest.approx(float(one["rms_gradient"][0]), rel=1e-12)


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
        ({"body": STEEL | {"aspect_ratio": 1.1}, "interface": RUBS}, "aspect_ratio"),
        ({"body": STEEL | {"poissons_ratio": 0.04}, "interface": RUBS}, "poissons_ratio"),
        ({"dimension": 1, "loading": {"line_load": 1.0}}, "periodic"),
        ({"periodic": "z"}, "true or false, or on maps x or y"),
        ({"periodic": {"x": False}}, "true or false, or on maps x or y"),
        ({"periodic": 1}, "true or false, or on maps x or y"),
    ],
)
def test_what_is_not_built_is_refused(change, named):
    with pytest.raises(gfmd_numba.InputError, match=named):
        gfmd_numba.solve(scene_of({"radius": 4.0}, 1e-3, 16) | change)


@pytest.mark.long
def test_fields_inside_a_cylinder_are_those_of_the_profile():
    loading, z = {"displacement": 0.01}, -np.array([0.0, 0.1, 0.4])
    interface, body = RUBS, {"poissons_ratio": 0.3}
    common = {"interface": interface, "body": body, "loading": loading}
    profile = {"dimension": 1, "periodic": False, "form": {"radius": 4.0, "points": 32}}
    forms = {"y": {"radius": 4.0, "radius_y": 1e9}, "x": {"radius": 1e9, "radius_y": 4.0}}
    scenes = [scene_of(forms[axis], 0.0, 32) | common | {"periodic": axis} for axis in forms]
    for each in scenes:
        del each["length"]
    files = [{"scene": scenes[0] | profile, "path": [{"sliding": 5e-4}]}]
    files += [
        {"scene": scene, "path": [{way: 5e-4}]} for scene, way in zip(scenes, ("sliding", "sliding_y"), strict=True)
    ]
    line, along_y, along_x = (gfmd_numba.solve(file) for file in files)
    expected = gfmd_numba.body_fields(line, z)
    found = gfmd_numba.body_fields(along_y, z, y=0.25)
    turned = gfmd_numba.body_fields(along_x, z, x=0.25)
    for name in ("displacement_1", "displacement_3", "strain_1", "strain_5", "stress_1", "stress_2", "stress_3"):
        values, largest = expected[name].values, abs(expected[name].values).max()
        np.testing.assert_allclose(found[name], values, atol=1e-6 * largest, err_msg=name)
        other = name.translate(str.maketrans("125", "214"))
        np.testing.assert_allclose(turned[other], found[name], atol=1e-8 * largest, err_msg=name)
    np.testing.assert_allclose(found["peak_von_mises"], expected["von_mises"].max("x"), rtol=1e-4)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_measured_map_is_treated_along_its_period_alone(axis):
    """Its seam is doubted along that alone, and its Fourier series is mirrored along the other."""
    heights = rough(32)[:, :16].repeat(2, axis=1) * 0.1 + np.linspace(0.0, 0.1, 32)  # jumps where x closes
    scene = {"dimension": 2, "periodic": axis, "body": {"poissons_ratio": 0.3}, "interface": WALL}
    scene |= {"loading": {"reduced_pressure": 0.02}}
    roughness = {"method": "measured", "heights": heights, "cutoff": 0.2, "points": 48}
    with catch_warnings(record=True, action="always") as said:
        gfmd_numba.solve({"scene": scene | {"roughness": {"method": "measured", "heights": heights}}})
    with catch_warnings(action="ignore"):
        found = gfmd_numba.solve({"scene": scene | {"roughness": roughness}})
    assert int(found["status"]) == 0
    assert found.sizes == {"y": 48, "x": 48}
    assert any("period along x closes" in str(each.message) for each in said) == (axis == "x")
    with catch_warnings(action="ignore"):
        windowed = gfmd_numba.solve({"scene": scene | {"roughness": roughness | {"periodic": "window"}}})
    faded = abs(windowed["height"] - windowed["height"].mean())
    assert float(faded.isel({axis: 0}).max()) < 0.2 * float(faded.max())
    with pytest.raises(gfmd_numba.InputError, match="as many points"):
        gfmd_numba.solve({"scene": scene | {"roughness": roughness | {"periodic": "mirror"}}})


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:.*the contact reaches the edge")
def test_curves_and_campaigns_take_it(tmp_path):
    scene = {"body": {"poissons_ratio": 0.3}, "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1}}
    scene |= {"interface": WALL, "loading": {"reduced_pressure": 0.05}, "periodic": "x", "dimension": 2}
    eps = {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1.0}
    file = {"scene": scene, "discretisation": eps, "seed": 1}
    curve = gfmd_numba.load_curve(file, [0.02, 0.05])
    campaign = {"name": "strips", "seed": 1, "realisations": 1, "scene": scene, "reference": eps}
    found = gfmd_numba.run(campaign | {"grid": {"reduced_pressure": [0.02, 0.05]}}, tmp_path / "strips")
    np.testing.assert_allclose(found["approach"].values.ravel(), curve["approach"].values.ravel(), rtol=1e-7)
