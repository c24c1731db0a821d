"""A ball, a wedge or a flat punch, alone against closed forms, and under every roughness from its file to a picture."""

import numpy as np
import pytest
import textbook
import xarray as xr
import yaml

import gfmd_numba
from gfmd_numba.scene import InputError
from support.cases import some_of
from support.command_line import gfmd
from support.hertz import ellipse

HALF_SPACE = {"youngs_modulus": 1.0, "poissons_ratio": 0.0}
STEEL = {"youngs_modulus": "200 GPa", "poissons_ratio": 0.3}
POWER_LAW = {"hurst": 0.8, "points": 64, "cut_on": 1 / 16, "roll_off": 0.5, "rms_gradient": 0.01}
LENGTHS = {"correlation_length_x": 0.05, "correlation_length_y": 0.1, "hurst": 0.8, "points": 64, "rms_gradient": 0.01}
BUMPS = [0.0005 * np.cos(0.1 * k * k) for k in range(32)]
ROUGHNESS = {
    "psd": {"method": "psd"} | POWER_LAW,
    "ensemble": {"method": "psd", "scaling": "ensemble"} | POWER_LAW,
    "midpoint": {"method": "midpoint_displacement"} | POWER_LAW,
    "addition": {"method": "successive_addition"} | POWER_LAW,
    "filtered": {
        "method": "fourier_filter",
        "model": "k_correlation",
        "hurst": 0.8,
        "correlation_length": 0.1,
        "rms_gradient": 0.01,
        "points": 64,
    },
    "measured": {"method": "measured", "units": {"z": "m"}, "heights": BUMPS},
}
OF_MAPS = ROUGHNESS | {
    "two lengths": {"method": "psd", "model": "length_anisotropy"} | LENGTHS,
    "measured": {"method": "measured", "units": {"z": "m"}, "heights": [[a + b for a in BUMPS] for b in BUMPS]},
}
FORMS = {
    "ball": {"radius": 2.0},
    "ellipsoid": {"radius": 2.0, "radius_y": 4.0},
    "wedge": {"slope": 0.05},
    "flat": {"width": 0.2, "edge_radius": 1.0},
}


def scene(form, dimension=1, load=0.01, body=HALF_SPACE, **others):
    return {
        "dimension": dimension,
        "body": body,
        "form": form,
        "interface": {"hard_wall": {}},
        "loading": {"line_load" if dimension == 1 else "force": load},
        "length": 1.0,
    } | others


def pressed(form, dimension, load, points):
    """Pressure over the way from the middle along x, or x and y; and the contact."""
    found = gfmd_numba.solve(scene(form | {"points": points}, dimension, load))
    assert int(found["status"]) == 0
    ways = [found[dim].values - 0.5 for dim in ("x", "y")[:dimension]]
    return found["pressure"].values, *ways, found


def test_a_cylinder_is_that_of_hertz():
    half_width, radius = 0.05, 1.5
    load = 0.25 * np.pi * half_width**2 / radius
    pressure, x, found = pressed({"radius": radius}, 1, load, 2048)
    exact = textbook.hertz_line_pressure(x, load, radius)
    assert pressure.max() == pytest.approx(exact.max(), rel=2e-6)
    assert np.sqrt(np.mean((pressure - exact) ** 2)) < 1e-3 * exact.max()
    half_width = textbook.hertz_line_half_width(load, radius)
    assert float(found["contact_radius"]) == pytest.approx(half_width, rel=2e-5)
    assert 0.5 * float(found["contact_area_fraction"]) == pytest.approx(half_width, rel=2e-3)


@pytest.mark.parametrize("points", [97, 198])
def test_a_ball_on_a_map_of_any_number_of_nodes_is_that_of_hertz(points):
    """Of an odd number of nodes no wave is at Nyquist, also on the coarser grid that an even one begins with."""
    radius, load = 1.5, 4.0 * 0.1**3 / 3.0
    pressure, *_ = pressed({"radius": radius}, 2, load, points)
    a = textbook.hertz_ball_radius(load, radius)
    assert pressure.max() == pytest.approx(1.5 * load / (np.pi * a**2), rel=5e-3)


def test_a_ball_is_that_of_hertz():
    radius, load = 1.5, 4.0 * 0.1**3 / 3.0
    pressure, x, y, found = pressed({"radius": radius}, 2, load, 256)
    a = textbook.hertz_ball_radius(load, radius)
    exact = 1.5 * load / (np.pi * a**2) * np.sqrt(np.maximum(1.0 - (x**2 + y[:, np.newaxis] ** 2) / a**2, 0.0))
    assert pressure.max() == pytest.approx(exact.max(), rel=1e-4)
    assert np.sqrt(np.mean((pressure - exact) ** 2)) < 1e-2 * exact.max()
    assert float(found["contact_radius"]) == pytest.approx(a, rel=3e-3)


def test_two_radii_are_the_ellipse_of_hertz():
    a, ratio, peak = 0.1, 2.0, 0.02
    b, of_one = a / ratio, ellipse(a, ratio, peak)
    pressure, x, y, _ = pressed(of_one.form, 2, of_one.load, 256)
    exact = peak * np.sqrt(np.maximum(1.0 - (x / a) ** 2 - (y[:, np.newaxis] / b) ** 2, 0.0))
    assert pressure.max() == pytest.approx(peak, rel=2e-3)
    assert np.sqrt(np.mean((pressure - exact) ** 2)) < 1e-2 * peak


def test_a_wedge_has_the_pressure_of_the_inverse_cosine():
    """Johnson 1985, (5.2) with the curvature that the neighbours add, as `hertz_line_half_width` has it."""
    slope, b = 0.05, 0.05
    load = slope * b / (1.0 - np.pi**2 * b**2 / 6.0)
    pressure, x, found = pressed({"slope": slope}, 1, load, 2048)
    inside = (abs(x) > 0.2 * b) & (abs(x) < 0.9 * b)
    way = abs(x[inside])
    exact = slope / np.pi * np.arccosh(b / way) + np.pi * load / 3.0 * np.sqrt(b**2 - way**2)
    np.testing.assert_allclose(pressure[inside], exact, rtol=5e-4)
    assert float(found["contact_radius"]) == pytest.approx(b, rel=2e-3)


def test_a_cone_is_that_of_sneddon():
    slope, a = 0.05, 0.08
    pressure, x, y, found = pressed({"slope": slope}, 2, 0.5 * np.pi * a**2 * slope, 256)
    way = np.hypot(x, y[:, np.newaxis])
    inside = (way > 0.3 * a) & (way < 0.8 * a)
    np.testing.assert_allclose(pressure[inside], 0.5 * slope * np.arccosh(a / way[inside]), rtol=5e-3)
    assert float(found["contact_radius"]) == pytest.approx(a, rel=1e-2)


def test_a_flat_punch_with_rounded_edges_has_its_closed_form():
    """Ciavarella, Hills and Monno, Proc. IMechE C 212:319 (1998), with the curvature that the neighbours add."""
    radius, b, flat = 1.0, 0.05, np.arcsin(0.5)
    load = 0.25 * b**2 / radius * (np.pi - 2.0 * flat - np.sin(2.0 * flat)) / (1.0 - np.pi**2 * b**2 / 6.0)
    pressure, x, _ = pressed({"width": b, "edge_radius": radius}, 1, load, 2048)
    at = np.arcsin(np.minimum(abs(x) / b, 1.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        turns = abs(np.sin(at + flat) / np.sin(at - flat)) ** np.sin(at)
        turns *= abs(np.tan(0.5 * (at + flat)) * np.tan(0.5 * (at - flat))) ** np.sin(flat)
        exact = 0.5 * b / (np.pi * radius) * ((np.pi - 2.0 * flat) * np.cos(at) + np.log(turns))
    exact = np.nan_to_num(exact + np.pi * load / 3.0 * b * np.cos(at))
    assert exact.mean() == pytest.approx(load, rel=1e-3)
    assert np.sqrt(np.mean((pressure - exact) ** 2)) < 2e-3 * exact.max()
    assert pressure[x == 0.0] == pytest.approx(exact[x == 0.0], rel=1e-4)


def test_a_parabola_is_a_flat_punch_without_width():
    ball, flat = (gfmd_numba.solve(scene(form | {"points": 64})) for form in ({"radius": 2.0}, FORMS["flat"]))
    narrow = gfmd_numba.solve(scene({"width": 1e-12, "edge_radius": 2.0, "points": 64}))
    np.testing.assert_allclose(narrow["pressure"], ball["pressure"], atol=1e-9)
    assert float(flat["contact_radius"]) > float(ball["contact_radius"])


def test_units_do_not_matter():
    form = {"radius": 3.0, "points": 64}
    plain = gfmd_numba.solve(scene(form, 2, 1e-3))
    units = {"length": "2 um", "loading": {"force": f"{1e-3 * 200e9 / 0.91 * 4e-12} N"}, "body": STEEL}
    stated = gfmd_numba.solve(scene({"radius": "6 um", "points": 64}, 2, **units))
    np.testing.assert_allclose(stated["pressure"] / (200e9 / 0.91), plain["pressure"], rtol=0, atol=1e-11)
    assert stated["contact_radius"].units == "m"
    assert float(stated["contact_radius"]) == pytest.approx(2e-6 * float(plain["contact_radius"]), rel=1e-9)


@pytest.mark.parametrize(
    ("dimension", "name"), some_of([*((1, name) for name in ROUGHNESS), *((2, name) for name in OF_MAPS)], 0, 3, 10, 12)
)
def test_it_lies_under_every_roughness(dimension, name):
    table, load = (ROUGHNESS, 1e-2) if dimension == 1 else (OF_MAPS, 1e-3)
    forms = [form for form in FORMS.values() if dimension == 2 or "radius_y" not in form]
    form = forms[list(table).index(name) % len(forms)]
    both, rough = (gfmd_numba.solve(scene(each, dimension, load, roughness=table[name])) for each in (form, None))
    smooth = gfmd_numba.solve(scene(form | {"points": rough.sizes["x"]}, dimension, load))
    np.testing.assert_allclose(both["height"], rough["height"] + smooth["height"], atol=1e-12)
    assert int(both["status"]) == 0
    for of_roughness in ("rms_gradient", "nayak", "rms_gradient_target", "reduced_pressure"):
        assert float(both[of_roughness]) == pytest.approx(float(rough[of_roughness]), rel=1e-9), of_roughness
    assert "contact_radius" in both
    assert "contact_radius" not in rough
    assert not both.attrs["validity"] or name == "measured"


@pytest.mark.parametrize("dimension", [1, pytest.param(2, marks=pytest.mark.long)])
def test_it_is_the_same_wherever_the_roughness_and_the_moduli_lie(dimension):
    form, rough = FORMS["ball"], ROUGHNESS["psd"]
    twice = {"youngs_modulus": 2.0, "poissons_ratio": 0.0}
    of_punch = gfmd_numba.solve(scene(form, dimension, 1e-3, roughness=rough))
    of_body = gfmd_numba.solve(scene(form, dimension, 1e-3, body=HALF_SPACE | {"roughness": rough}))
    of_two = gfmd_numba.solve(scene(form, dimension, 1e-3, body=twice | {"roughness": rough}, counter_body=twice))
    for other in (of_body, of_two):
        np.testing.assert_allclose(other["pressure"], of_punch["pressure"], atol=1e-9)
        assert float(other["kappa"]) == pytest.approx(float(of_punch["kappa"]), rel=1e-7)
    smooth, two = (
        gfmd_numba.solve(scene(form | {"points": 64}, dimension, 1e-3, **each))
        for each in ({}, {"body": twice, "counter_body": twice})
    )
    np.testing.assert_allclose(two["pressure"], smooth["pressure"], atol=1e-9)


@pytest.mark.usefixtures("undrawn")
def test_four_lines_make_a_cylinder_on_a_rough_flat(tmp_path):
    file, results = tmp_path / "roller.yaml", tmp_path / "roller.nc"
    rough = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
    given = scene({"radius": "2 m"}, 1, 1e-3, roughness=rough)
    file.write_text(yaml.dump(given | {"discretisation": {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 0.25}}))
    for command in (("check", file), ("solve", file, "-o", results)):
        assert gfmd(*command).exit_code == 0
    assert gfmd("plot", results, "-o", tmp_path / "roller.png").exit_code == 0
    assert (tmp_path / "roller.png").exists()
    with xr.open_dataset(results) as found:
        assert int(found["status"]) == 0


def test_a_load_path_ends_where_the_same_load_does():
    given = scene(FORMS["ball"], load=1e-3, roughness=ROUGHNESS["psd"])
    path = gfmd_numba.solve({"scene": given, "path": [{"line_load": 2e-3}]})
    at_once = gfmd_numba.solve(given | {"loading": {"line_load": 2e-3}})
    np.testing.assert_allclose(path["pressure"][-1], at_once["pressure"], atol=1e-9)


@pytest.mark.parametrize(
    ("form", "dimension", "others", "told"),
    [
        ({"radius": 2.0}, 1, {}, "form.points: you gave nothing; gfmd needs grid points over L_x, as no roughness"),
        ({"radius": 2.0, "points": 64}, 1, {"roughness": ROUGHNESS["psd"]}, "form.points: .* nothing with a roughness"),
        ({"radius": 2.0, "slope": 0.1, "points": 64}, 1, {}, "form: .* exactly one of radius, slope and width"),
        ({"points": 64}, 1, {}, "form: .* exactly one of radius, slope and width"),
        ({"width": 0.1, "points": 64}, 1, {}, "form.edge_radius: .* the radius of the edges with a width"),
        ({"slope": 0.1, "radius_y": 1.0, "points": 64}, 2, {}, "form.radius_y: .* nothing without radius"),
        ({"radius": 2.0, "radius_y": 1.0, "points": 64}, 1, {}, "form.radius_y: .* nothing with dimension 1"),
        ({"radius": 0.4, "points": 64}, 1, {}, "form.radius: .* more than half the period, 0.5"),
        ({"width": 1.0, "edge_radius": 1.0, "points": 64}, 1, {}, "form.width: .* below the period 1"),
        ({"slope": 2.0, "points": 64}, 1, {}, "form.slope: you gave 2.0"),
        ({"radius": 1e30, "points": 64}, 1, {}, "form: .* a form that is not flat, not an rms gradient of"),
        (
            {"radius": 2.0, "points": 64},
            1,
            {"loading": {"reduced_pressure": 0.1}},
            "loading.reduced_pressure: .* gfmd allows a line_load, or a pressure with a form alone",
        ),
        ({"radius": "2 m", "points": 64}, 1, {"length": None}, "form.radius: .* a number without a unit"),
    ],
)
def test_what_makes_no_form_is_refused(form, dimension, others, told):
    if others.get("length", 1.0) is None:
        others = others | {"loading": {"pressure": 0.01}}
    with pytest.raises(InputError, match=told.replace(".points", r"\.points")):
        gfmd_numba.solve(scene(form, dimension, **others))


def test_a_form_between_two_bodies_is_followed_at_order_0():
    given = scene(FORMS["ball"], load=1e-3, body=HALF_SPACE | {"roughness": ROUGHNESS["psd"]}, counter_body=HALF_SPACE)
    assert float(gfmd_numba.solve(given)["next_order"]) < 1e-5
    with pytest.raises(InputError, match=r"numerics\.topography_order: .* 0, or nothing, with a form between two"):
        gfmd_numba.solve({"scene": given, "numerics": {"topography_order": 1}})


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize(
    ("interface", "others"),
    [
        ({"hard_wall": {"hardness": 0.02}}, {}),
        ({"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-6, "range": 0.005}}, {}),
        ({"hard_wall": {}, "friction": {"coefficient": 0.3}}, {"aspect_ratio": 0.5, "poissons_ratio": 0.3}),
    ],
    ids=["hardness", "adhesion", "friction"],
)
def test_what_acts_under_a_flat_punch_acts_under_a_form(dimension, interface, others):
    body = HALF_SPACE | others
    given = scene(FORMS["ball"], dimension, 2e-3, body, roughness=ROUGHNESS["psd"]) | {"interface": interface}
    found = gfmd_numba.solve(given)
    assert int(found["status"]) == 0
    load = float(found["mean_pressure"])
    assert load == pytest.approx(2e-3, rel=1e-6)
    assert float(found["contact_radius"]) > 0.0
