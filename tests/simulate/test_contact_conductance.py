"""Conductance of contacts: Holm's spot, parallel ridges, and the stiffness of the same contact held."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis import secant_stiffness
from gfmd_numba.contact.area_correction import HALF_SPACE
from support.solved_maps import made, paraboloid, pressed, wave

IMAGES = 3.9002649  # -sum of 1/r over the square lattice without the origin, its mean taken off


def conductance(dataset):
    return float(gfmd_numba.contact_conductance(dataset)["conductance"])


@pytest.mark.parametrize("half_width", [6.0, 10.0, 20.0])
def test_a_hertzian_spot_conducts_as_holm_says(half_width):
    """2 a s of a spot alone; spots at distances L_x help each other by 2 a IMAGES / pi, exact to order (a / L_x)^3."""
    n = 192
    dataset = pressed(paraboloid(n), 4.0 / 3.0 * (half_width / n) ** 3 / 100.0)
    a = np.sqrt(float(dataset["contact_area_fraction"]) / np.pi)
    assert conductance(dataset) == pytest.approx(2.0 * a / (1.0 - 2.0 * a * IMAGES / np.pi), rel=0.01)
    assert a * n == pytest.approx(half_width, rel=0.02)


def in_millimetres(dataset):
    """Dataset of a map of 1 mm, with its positions and gaps in m."""
    found = dataset.assign(gap=(1e-3 * dataset["gap"]).assign_attrs(units="m"))
    return found.assign_coords({dim: (1e-3 * dataset[dim]).assign_attrs(units="m") for dim in ("x", "y")})


def test_the_resistance_is_that_of_the_nominal_area():
    """A round spot of radius a resists with 1 / (2 a s) (Holm), less with spots around it."""
    spot = in_millimetres(pressed(paraboloid(128), 4.0 / 3.0 * (10.0 / 128) ** 3 / 100.0))
    a = 1e-3 * np.sqrt(float(spot["contact_area_fraction"]) / np.pi)
    holm = (1.0 - 2.0e3 * a * IMAGES / np.pi) / (2.0 * a)
    for given, mean, unit in (
        ("60 MS/m", 60e6, "ohm"),
        (["0.4 kW/(m K)", "16 W/m/K"], 800.0 / 26.0, "K W-1"),
    ):
        conductance = gfmd_numba.contact_conductance(spot, given)
        found, times_area = conductance["resistance"], conductance["resistance_times_area"]
        assert float(found) == pytest.approx(holm / mean, rel=0.01)
        assert float(times_area) == pytest.approx(1e-6 * holm / mean, rel=0.01)  # of a square of 1 mm
        assert (found.units, times_area.units) == (unit, {"ohm": "ohm m2", "K W-1": "K m2 W-1"}[unit])
    mirrored = '{"scene": {"dimension": 2, "roughness": {"method": "measured", "periodic": "mirror"}}}'
    quarter = gfmd_numba.contact_conductance(spot.assign_attrs(scene=mirrored), given)
    assert float(quarter["resistance"]) == pytest.approx(4.0 * float(found))  # of a field of which a period has four
    assert float(quarter["resistance_times_area"]) == float(times_area)
    with pytest.warns(UserWarning, match="ridges without end"):
        found = gfmd_numba.contact_conductance(spot.isel(y=64).drop_vars("y"), "1 S/m")
    assert "resistance" not in found
    assert found["resistance_times_area"].units == "ohm m2"


@pytest.mark.parametrize("given", ["60", 60.0, [], ["60 S/m", "16 W/m/K"], ["1 S/m"] * 3, "0 S/m", "1 S", None, [[]]])
def test_conductivities_of_other_kinds_are_refused(given):
    ridge = in_millimetres(made(np.eye(8, dtype=bool)))
    if given is None:
        ridge, given = made(np.eye(8, dtype=bool)), "60 MS/m"
    with pytest.raises(gfmd_numba.InputError, match=r"^conductivity: you gave "):
        gfmd_numba.contact_conductance(ridge, given)


@pytest.mark.parametrize("ridges", [1, 4])
@pytest.mark.parametrize("nodes", [5, 20, 50])
def test_parallel_ridges_conduct_as_a_row_of_strips(ridges, nodes):
    """Strips of width w at distances l: pi / (-2 l ln sin(pi w / 2 l)), as Koiter's cracks between them (1959).

    Counted nodes of a contact reach too far at each edge, and the strip that conducts is the corrected one.
    """
    flags = np.zeros((ridges * 64, ridges * 64), dtype=bool)
    flags[:, np.arange(ridges * 64) % 64 < nodes] = True
    width = (nodes - 2.0 * HALF_SPACE.excess) / 64
    expected = -ridges * np.pi / (2.0 * np.log(np.sin(0.5 * np.pi * width)))
    assert conductance(made(flags)) == pytest.approx(expected, rel=2e-3)
    assert conductance(made(flags.T)) == pytest.approx(expected, rel=2e-3)


def test_a_pressed_ridge_conducts_as_westergaard_says_to_a_node():
    """The conductance is that of sin^2(pi w / 2) = p / p_full, and changes with the load by steps of two nodes."""
    n = 256
    for share in (0.02, 0.3):
        dataset = pressed(wave(n, 0.01), share * np.pi * 0.01)
        half = np.arcsin(np.sqrt(share)) / np.pi
        lower, upper = (-np.pi / (2.0 * np.log(np.sin(np.pi * (half + off / n)))) for off in (-1.0, 1.0))
        assert lower < conductance(dataset) < upper


def test_a_profile_conducts_as_the_map_of_its_ridge():
    dataset = pressed(wave(64, 0.01), 0.003)
    of_profile = dataset.isel(y=0).drop_vars("y")
    with pytest.warns(UserWarning, match="that of a profile: its spots are ridges without end along y"):
        found = conductance(of_profile)
    assert found == pytest.approx(conductance(dataset), rel=1e-9)


def test_the_current_crosses_touching_nodes_and_is_largest_at_edges():
    found = gfmd_numba.contact_conductance(pressed(paraboloid(64), 2e-4))
    density, touching = found["current_density"].values, pressed(paraboloid(64), 2e-4)["gap"].values == 0.0
    assert density.mean() == pytest.approx(1.0)
    assert (density[~touching] == 0.0).all()
    assert (density[touching] > 0.0).all()
    assert density[touching].min() == pytest.approx(density[32, 32], rel=0.05)
    assert found.validity == ""


def test_a_rough_map_conducts_as_it_is_stiff():
    """Barber, Proc. R. Soc. Lond. A 459:53 (2003): dp/d(mean gap) over E* is the conductance over s."""
    scene = {
        "dimension": 2,
        "body": {"poissons_ratio": 0.33},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.1},
        "path": [{"reduced_pressure": 0.1 * (1.0 + 1e-5)}],
        "discretisation": {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2},
    }
    path = gfmd_numba.solve(scene | {"numerics": {"residual": 1e-12}})
    np.testing.assert_array_equal(path["pressure"][0] > 0.0, path["pressure"][1] > 0.0)
    found = gfmd_numba.contact_conductance(path)["conductance"]
    assert found.dims == ("step",)
    assert float(secant_stiffness(path)["stiffness"][0]) == pytest.approx(float(found[0]), rel=1e-3)


def test_no_contact_does_not_conduct_and_full_contact_does_not_resist():
    flags = np.zeros((3, 8, 8), dtype=bool)
    flags[1] = True
    flags[2, 3, 4] = True
    found = gfmd_numba.contact_conductance(made(flags))["conductance"].values
    assert found[0] == 0.0
    assert found[1] == np.inf
    assert 0.0 < found[2] < np.inf


def test_conductance_is_per_metre_where_lengths_are_metres():
    flags = np.zeros((16, 16), dtype=bool)
    flags[3:6, 4:8] = True
    plain, long = made(flags), made(flags)
    long = long.assign_coords(x=("x", 1e-4 * long["x"].values, {"units": "m"}))
    found = gfmd_numba.contact_conductance(long)["conductance"]
    assert found.units == "m-1"
    assert float(found) == pytest.approx(1e4 * conductance(plain), rel=1e-12)


@pytest.mark.parametrize(
    ("alter", "said"),
    [
        (lambda given: given.drop_vars("gap"), "no results of a contact"),
        (lambda given: given.assign(status=((), 2)), "a run that is not ok"),
        (lambda given: given.assign(gap=given["gap"] * np.nan), "fields that are not finite"),
        (lambda given: given.isel(x=slice(0, 20)), "20 of the 64 nodes along x"),
        (lambda given: xr.Dataset(), "no results of a contact"),
    ],
)
def test_altered_contacts_are_refused(alter, said):
    given = pressed(wave(64, 0.01), 0.003)
    with pytest.raises(gfmd_numba.InputError, match=f"you gave {said}"):
        gfmd_numba.contact_conductance(alter(given))


def free_scene(loading, **more):
    scene = {"dimension": 2, "periodic": False, "body": {"poissons_ratio": 0.3}, "interface": {"hard_wall": {}}}
    return {"scene": scene | {"form": {"radius": 4.0, "points": 96}, "loading": loading} | more}


def test_a_ball_conducts_as_holm_says_and_as_it_is_stiff():
    """2 a s without a period; dp/d(approach) of the ball is 2 a E* (Johnson, Contact Mechanics, 4.2)."""
    contact = gfmd_numba.solve(free_scene({"displacement": 0.01}))
    a = float(contact["contact_radius"])
    assert a == pytest.approx(0.2, rel=1e-3)
    assert conductance(contact) == pytest.approx(2.0 * a, abs=2.0 * 0.15 / 96)  # nodes reach too far by 0.1 of one


def test_a_strip_conducts_from_a_distance_as_it_sinks_in():
    """pi / (2 ln(2 / b)) for a half-width b over the window, as a flat punch has it (Johnson, 2.42), on maps, too."""
    form = {"width": 0.3, "edge_radius": 0.5, "points": 512}
    profile = free_scene({"displacement": 0.05}, dimension=1, form=form)
    contact = gfmd_numba.solve(profile)
    half = float(contact["contact_radius"])
    with pytest.warns(UserWarning, match="ridges without end along y"):
        found = conductance(contact)
    assert found == pytest.approx(np.pi / (2.0 * np.log(2.0 / half)), rel=2e-3)
    radii = {"radius": 4.0, "points": 64}
    line = gfmd_numba.solve(free_scene({"displacement": 0.01}, dimension=1, form=radii))
    cylinder = free_scene({"displacement": 0.01}, periodic="y", form=radii | {"radius_y": 1e9})
    with pytest.warns(UserWarning, match="ridges without end along y"):
        found = conductance(line)
    assert conductance(gfmd_numba.solve(cylinder)) == pytest.approx(found, rel=1e-6)


@pytest.mark.long
def test_a_rough_ball_from_a_file_in_si_conducts_as_it_is_stiff():
    """Held, it has the stiffness dF/d(approach) = E* s^-1 times the conductance of the whole (Barber, 2003)."""
    body = {"youngs_modulus": 100e9, "poissons_ratio": 0.3}
    roughness = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.03}
    eps = {"eps_c": 1 / 2, "eps_f": 1 / 16, "eps_t": 1 / 4}
    scene = {"body": body, "form": {"radius": "1 mm"}, "roughness": roughness, "length": "100 um"}
    file = free_scene({"force": 0.02}, **scene) | {"discretisation": eps, "path": [{"force": 0.02 * (1.0 + 1e-6)}]}
    pressed_twice = gfmd_numba.solve(file | {"numerics": {"residual": 1e-12}})
    first, second = (pressed_twice.isel(step=i) for i in range(2))
    assert ((first["gap"] == 0.0) == (second["gap"] == 0.0)).all()
    stiffness = 0.02e-6 / float(second["approach"] - first["approach"])
    whole = conductance(first) * 1e-4**2
    assert whole * 100e9 / 0.91 == pytest.approx(stiffness, rel=1e-4)
    assert first["x"].attrs["units"] == "m"
