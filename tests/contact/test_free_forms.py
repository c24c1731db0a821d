"""Forms without a period: the balls, ellipsoids, cylinders and cones of contact mechanics, and their approach."""

import re
from warnings import catch_warnings

import numpy as np
import pytest

import gfmd_numba
from support.hertz import ellipse


def pressed(form, dimension, load, points=256, **more):
    scene = {
        "dimension": dimension,
        "periodic": False,
        "body": {"youngs_modulus": 1.0, "poissons_ratio": 0.0},
        "form": form | {"points": points},
        "interface": {"hard_wall": {}},
        "loading": {"line_load" if dimension == 1 else "force": load},
        "length": 1.0,
    } | more
    found = gfmd_numba.solve(scene)
    assert int(found["status"]) == 0
    return found


def test_a_ball_is_that_of_hertz():
    a, radius = 0.25, 5.0
    found = pressed({"radius": radius}, 2, 4.0 * a**3 / (3.0 * radius))
    assert float(found["approach"]) == pytest.approx(a**2 / radius, rel=1e-5)
    assert float(found["peak_pressure"]) == pytest.approx(2.0 * a / (np.pi * radius), rel=1e-5)
    assert float(found["contact_radius"]) == pytest.approx(a, rel=3e-5)


@pytest.mark.parametrize("points", [64, 128])
def test_the_radius_of_a_ball_converges_with_order_two_wherever_its_edge_lies_between_the_nodes(points):
    """Counted and corrected nodes are off by up to ten times that, as a circle has not as many nodes as its area."""
    radius, errors = 5.0, []
    for a in 0.25 + np.array([0.0, 0.3, 0.7]) / points:
        found = pressed({"radius": radius}, 2, 4.0 * a**3 / (3.0 * radius), points)
        errors.append(float(found["contact_radius"]) / a - 1.0)
    assert np.abs(errors).max() < 3.0 / points**2


def test_two_radii_are_the_ellipse_of_hertz():
    a, ratio, peak = 0.25, 2.0, 0.02
    exact = ellipse(a, ratio, peak)
    found = pressed(exact.form, 2, exact.load)
    assert float(found["approach"]) == pytest.approx(exact.approach, rel=1e-4)
    assert float(found["peak_pressure"]) == pytest.approx(peak, rel=4e-4)  # of 256 nodes; a quarter on twice as many
    assert float(found["contact_area_fraction"]) == pytest.approx(np.pi * a**2 / ratio, rel=5e-3)
    assert float(found["contact_radius"]) == pytest.approx(a / np.sqrt(ratio), rel=1e-4)


def test_a_cylinder_is_that_of_hertz():
    b, radius = 0.25, 5.0
    found = pressed({"radius": radius}, 1, 0.25 * np.pi * b**2 / radius)
    assert float(found["peak_pressure"]) == pytest.approx(0.5 * b / radius, rel=1e-4)
    assert float(found["contact_radius"]) == pytest.approx(b, rel=3e-5)


def test_a_flat_strip_with_rounded_edges_is_that_of_ciavarella_hills_and_monno():
    """Proc. IMechE C 212:319 (1998), b the half-width of contact and sin(flat) the share of it that is flat."""
    radius, b, flat = 1.0, 0.2, np.arcsin(0.5)
    load = 0.25 * b**2 / radius * (np.pi - 2.0 * flat - np.sin(2.0 * flat))
    found = pressed({"width": b, "edge_radius": radius}, 1, load, 1024)
    assert float(found["contact_radius"]) == pytest.approx(b, rel=3e-5)

    def exact(x):
        at = np.arcsin(np.minimum(abs(x) / b, 1.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            turns = abs(np.sin(at + flat) / np.sin(at - flat)) ** np.sin(at)
            turns *= abs(np.tan(0.5 * (at + flat)) * np.tan(0.5 * (at - flat))) ** np.sin(flat)
            bent = (np.pi - 2.0 * flat) * np.cos(at) + np.log(turns)
        return 0.5 * b / (np.pi * radius) * np.nan_to_num(bent)

    of_nodes, peak = exact(found["x"].values - 0.5), exact(np.linspace(0.1, 0.2, 10_001)).max()
    assert float(found["peak_pressure"]) == pytest.approx(peak, rel=3e-5)
    assert np.sqrt(np.mean((found["pressure"].values - of_nodes) ** 2)) < 1e-3 * peak


def test_a_round_stamp_with_rounded_edges_has_its_closed_form():
    """Sneddon: of a form f(r), d(a) = a int_0^a f' / (a^2 - r^2)^(1/2) dr; p = int_r^a d' / pi (x^2 - r^2)^(1/2)."""
    radius, a, flat = 1.0, 0.2, 0.1
    root, angle = np.sqrt(a**2 - flat**2), np.arccos(flat / a)
    load = 2.0 / radius * (a**2 * root - root**3 / 3.0 - 0.5 * flat * (a**2 * angle + flat * root))
    found = pressed({"width": 2.0 * flat, "edge_radius": radius}, 2, load, 128)
    assert float(found["approach"]) == pytest.approx(a / radius * (root - flat * angle), rel=1e-4)
    assert float(found["contact_radius"]) == pytest.approx(a, rel=5e-4)
    nodes, weights = np.polynomial.legendre.leggauss(400)

    def exact(r):  # with x = (r^2 + t^2)^(1/2)
        first, last = np.sqrt(max(flat, r) ** 2 - r**2), np.sqrt(a**2 - r**2)
        x = np.hypot(r, first + 0.5 * (last - first) * (1.0 + nodes))
        slope = (2.0 * np.sqrt(np.maximum(x**2 - flat**2, 0.0)) - flat * np.arccos(np.minimum(flat / x, 1.0))) / radius
        return 0.5 * (last - first) / np.pi * (weights * slope / x).sum()

    assert float(found["peak_pressure"]) == pytest.approx(max(map(exact, np.linspace(0.1, 0.19, 181))), rel=3e-4)
    middle = found.isel(x=64, y=64)
    assert float(middle["pressure"]) == pytest.approx(exact(0.0), rel=1e-3)


def test_a_cone_is_that_of_sneddon():
    slope, a = 0.02, 0.25
    found = pressed({"slope": slope}, 2, 0.5 * np.pi * a**2 * slope)
    assert float(found["approach"]) == pytest.approx(0.5 * np.pi * a * slope, rel=1e-3)
    assert float(found["contact_radius"]) == pytest.approx(a, rel=3e-5)


@pytest.mark.long
def test_edges_are_located_where_pressure_is_a_root_of_their_distance():
    """A thin slab, a ball of few nodes, and one that attracts: their radius is that of the corrected nodes."""
    ball, load = {"radius": 5.0}, 4.0 * 0.25**3 / 15.0
    sticky = {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-5, "range": 0.005}}
    of_nodes = {
        "thin": pressed(ball, 2, load, 64, body={"youngs_modulus": 1.0, "poissons_ratio": 0.3, "aspect_ratio": 0.03}),
        "few": pressed(ball, 2, 0.01 * load, 64),
        "attracts": pressed(ball, 2, load, 64, interface=sticky),
    }
    for found in of_nodes.values():
        assert float(found["contact_radius"]) == pytest.approx(
            np.sqrt(float(found["contact_area_fraction"]) / np.pi), rel=1e-12
        )
    slab = {"youngs_modulus": 1.0, "poissons_ratio": 0.3, "aspect_ratio": 0.2}
    coarse, fine = (float(pressed(ball, 2, load, n, body=slab)["contact_radius"]) for n in (64, 128))
    assert coarse == pytest.approx(fine, rel=1.2e-3)  # of second order


@pytest.mark.parametrize("dimension", [1, 2])
def test_a_radius_is_off_by_as_much_as_the_warning_says_and_less_where_there_is_none(dimension):
    """With 5 nodes across by up to 30 %, with 3 by 65 %: balls and rollers of any width beside Hertz's."""
    radius, points, errors = 5.0, 32, {}
    for half in np.array([0.6, 0.8, 1.2, 1.7, 1.9, 2.4, 2.8, 2.9, 3.4, 3.9]) / points:
        force = np.pi * half**2 / (4.0 * radius) if dimension == 1 else 4.0 * half**3 / (3.0 * radius)
        with catch_warnings(record=True, action="always") as said:
            found = pressed({"radius": radius}, dimension, force, points)
        touching = found["gap"] <= 0.0
        across = int((touching if dimension == 1 else touching.any("y")).sum())
        assert bool(said) == (across < 6)
        if said:
            assert f"which is {across} wide" in str(said[0].message)
            assert f"take at least {np.ceil(points * 6 / across):.0f} points" in str(said[0].message)
        errors[across] = max(errors.get(across, 0.0), abs(float(found["contact_radius"]) / half - 1.0))
    assert 0.3 < errors[3] < 0.65
    assert errors[5] < 0.3
    assert max(error for across, error in errors.items() if across > 5) < 0.065


@pytest.mark.parametrize(
    ("more", "warned"),
    [
        ({}, "which is 1 wide.*take at least 192 points, or"),
        (
            {"form": None, "roughness": {"method": "measured", "heights": [0.0, 0.0, 0.0, 1.0] + 28 * [0.0]}},
            "is 1 wide",
        ),
        (
            {"form": None, "roughness": {"method": "measured", "heights": 1e-4 * np.cos(np.arange(32) * np.pi / 16)}},
            None,
        ),
        (
            {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 1e-6}},
            r"take eps_c = 1/\d+ or finer \(at least",
        ),
        ({"interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-3, "range": 0.1}}}, None),
        ({"periodic": True}, "which is 1 wide"),
    ],
    ids=["alone", "spike", "wave", "rough", "attracted", "periodic"],
)
def test_a_contact_of_too_few_nodes_is_warned_of(more, warned):
    scene = {"body": {"poissons_ratio": 0.0}, "form": {"radius": 5.0}, "interface": {"hard_wall": {}}}
    scene |= {"periodic": False, "loading": {"pressure": 1e-5}} | more
    if scene["form"] is not None and "roughness" not in more:
        scene["form"] = {"radius": 5.0, "points": 32}
    scene["body"] = scene["body"] | {"youngs_modulus": 1.0}
    scene["length"] = 1.0
    if isinstance(scene.get("roughness", {}).get("heights"), list | np.ndarray):
        scene["roughness"] = scene["roughness"] | {"units": {"z": "m"}}
    eps = {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2} if "psd" in str(scene.get("roughness")) else None
    file = {"scene": {key: value for key, value in scene.items() if value is not None}}
    with catch_warnings(record=True, action="always") as said:
        gfmd_numba.solve(file | ({"discretisation": eps} if eps else {}))
    found = [str(each.message) for each in said if "too few nodes" in str(each.message)]
    assert len(found) == (warned is not None)
    if warned:
        assert re.search(warned, found[0])


@pytest.mark.parametrize(
    ("eps_c", "warned"), [(1.0, "narrow on this grid, 1.. nodes wide .* take eps_c = 1/2"), (1 / 4, None)]
)
def test_narrow_contacts_of_a_rough_surface_are_warned_of(eps_c, warned):
    scene = {"body": {"poissons_ratio": 0.3}, "roughness": {"method": "psd", "hurst": 0.3, "rms_gradient": 0.01}}
    scene |= {"interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.02}}
    with catch_warnings(record=True, action="always") as said:
        gfmd_numba.solve({"scene": scene, "discretisation": {"eps_c": eps_c, "eps_f": 1 / 64, "eps_t": 1 / 2}})
    narrow = [str(each.message) for each in said if "nodes wide on average" in str(each.message)]
    assert len(narrow) == (warned is not None)
    assert warned is None or re.search(warned, narrow[0])


def test_all_narrow_steps_of_a_path_are_named_by_how_much_they_may_be_off():
    scene = {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05}, "interface": {"hard_wall": {}}}
    scene |= {"dimension": 1, "body": {"poissons_ratio": 0.3}, "loading": {"reduced_pressure": 1e-4}}
    path = [{"reduced_pressure": pressure} for pressure in (5e-4, 2.5e-3, 0.6)]
    levels = {"eps_c": 1.0, "eps_f": 1 / 64, "eps_t": 1 / 2}
    with pytest.warns(UserWarning, match=r"1.0 nodes wide on average: .*\(in steps 0 to 2 of 3\)$"):
        gfmd_numba.solve({"scene": scene, "discretisation": levels, "path": path})


def test_more_points_of_a_measured_surface_widen_its_contacts():
    waves, places = np.arange(1, 50), np.arange(128) / 128
    phases = np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, waves.size)
    heights = (1e-6 * waves**-0.9 * np.cos(2.0 * np.pi * np.outer(places, waves) + phases)).sum(axis=1)
    said = []
    for points in ({}, {"points": 512}):
        roughness = {"method": "measured", "heights": heights, "units": {"z": "m"}, **points}
        scene = {"length": 1e-3, "body": {"youngs_modulus": 210e9, "poissons_ratio": 0.3}, "roughness": roughness}
        scene |= {"interface": {"hard_wall": {}}, "loading": {"pressure": 2e8}}
        with catch_warnings(record=True, action="always") as found:
            gfmd_numba.solve({"scene": scene})
        said.append([str(each.message) for each in found if "nodes wide" in str(each.message)])
    assert "points: 256 or more" in said[0][0]
    assert said[1] == []


@pytest.mark.parametrize(("nodes", "grooves", "warned"), [(2, False, True), (4, False, False), (8, True, True)])
def test_a_peak_of_pressure_that_a_measured_grid_does_not_resolve_is_told(nodes, grooves, warned):
    """Random waves down to that of so many nodes; where they are cut off at a height, grooves have sharp edges.

    On eight times as many nodes the peak is 5 to 30 % higher where a warning is given, and 6 % at most elsewhere.
    """
    for seed in range(2):
        q, rng = np.arange(513), np.random.default_rng(seed)
        amplitudes = np.where((q >= 8) & (q <= 1024 // nodes), np.maximum(q, 1.0) ** -1.3, 0.0)
        heights = np.fft.irfft(amplitudes * np.exp(2j * np.pi * rng.random(513)), 1024)
        heights *= 0.05 * 8e-3 / 1024 / np.gradient(heights).std()
        if grooves:
            heights = np.minimum(heights, -0.3 * heights.std()) + 1e-2 * heights
        scene = {"length": "8 mm", "body": {"youngs_modulus": "80 GPa", "poissons_ratio": 0.27}}
        scene |= {"roughness": {"method": "measured", "heights": heights, "units": {"z": "m"}}}
        scene |= {"interface": {"hard_wall": {}}, "loading": {"pressure": "200 MPa"}}
        with catch_warnings(action="ignore"):
            said = gfmd_numba.solve({"scene": scene}).attrs["validity"]
        assert ("stick out of their neighbours" in said) == warned


def test_a_hardness_that_is_reached_bounds_the_peak_on_any_grid():
    heights = np.where(np.arange(1024) % 64 < 40, 0.0, -1e-5) - 1e-7 * np.cos(2.0 * np.pi * np.arange(1024) / 1024)
    said = []
    for hardness in ("1000 GPa", "1 GPa"):
        scene = {"length": "8 mm", "body": {"youngs_modulus": "80 GPa", "poissons_ratio": 0.27}}
        scene |= {"roughness": {"method": "measured", "heights": heights, "units": {"z": "m"}}}
        scene |= {"interface": {"hard_wall": {"hardness": hardness}}, "loading": {"pressure": "200 MPa"}}
        with catch_warnings(action="ignore"):
            said.append(gfmd_numba.solve({"scene": scene}).attrs["validity"])
    assert ["stick out of their neighbours" in each for each in said] == [True, False]


def test_a_curve_warns_once_of_its_narrowest_contact():
    scene = {"periodic": False, "body": {"poissons_ratio": 0.0}, "interface": {"hard_wall": {}}}
    scene |= {"form": {"radius": 5.0, "points": 64}, "loading": {"displacement": 1e-3}}
    with catch_warnings(record=True, action="always") as said:
        curve = gfmd_numba.load_curve({"scene": scene}, [1e-6, 6e-4, 1e-2])
    found = [line for line in curve.attrs["validity"].splitlines() if "too few nodes" in line]
    assert len(found) == sum("too few nodes" in str(each.message) for each in said) == 1
    assert "which is 1 wide" in found[0]


def mirrored_map(**loading):
    """Field of 24 x 24 nodes of 1 um with waves of many lengths, mirrored, and two asperities above all others."""
    x = np.arange(24)
    long = np.add.outer(np.cos(np.pi * x / 24), np.cos(np.pi * x / 12))
    heights = 1e-8 * long + 2e-9 * np.random.default_rng(2).normal(size=(24, 24))
    heights[6, 6] = heights[17, 15] = 6e-8
    roughness = {"method": "measured", "heights": heights, "units": {"z": "m"}, "spacing": 1e-6, "periodic": "mirror"}
    scene = {"body": {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3}, "roughness": roughness}
    return {"scene": scene | {"interface": {"hard_wall": {}}, "loading": loading}}


def test_contacts_are_narrow_also_where_a_law_acts_across_the_gap():
    given = mirrored_map(pressure=1e6)
    given["scene"]["interface"] |= {"exponential": {"work_of_adhesion": 1e-3, "range": 2e-8}}
    with catch_warnings(action="ignore"):
        said = gfmd_numba.solve(given).attrs["validity"]
    assert "narrow on this grid, 1.0 nodes wide on average: the contact area may be that of single nodes" in said
    assert "few asperities of the measured field touch" in said


def test_few_and_narrow_contacts_of_a_map_are_warned_of_also_by_what_crosses_them():
    with catch_warnings(action="ignore"):
        contact = gfmd_numba.solve(mirrored_map(pressure=1e6))
        crossing = gfmd_numba.contact_conductance(contact), gfmd_numba.leakage(contact)
    assert contact["n_segments"] == 8
    for found in (contact, *crossing):
        said = found.attrs["validity"]
        assert re.search(r"narrow on this grid, 1.0 nodes wide .* take points: 96", said)
        assert "few asperities of the measured field touch, 2 on average:" in said
    assert "mirrored at its ends: a period holds the field, and its contacts, 4 times" in contact.attrs["processing"]


@pytest.mark.parametrize(
    ("dimension", "loading", "said"),
    [
        (2, {"force": "2.304 mN"}, "period of 48 µm x 48 µm: 1 N makes 434 MPa there; .* 1 MPa for 1 N on 1 mm"),
        (2, {"pressure": "1 MPa"}, None),
        (1, {"line_load": "48 N/m"}, "period of 48 µm: 1 N/m makes 20.8 kPa there; .* 1 kPa for 1 N/m on 1 mm"),
    ],
)
def test_a_force_on_a_mirrored_field_says_what_pressure_it_makes(dimension, loading, said):
    file = mirrored_map(**loading)
    if dimension == 1:
        file["scene"]["roughness"]["heights"] = file["scene"]["roughness"]["heights"][6]
    for solve in (gfmd_numba.solve, lambda given: gfmd_numba.load_curve(given, [next(iter(loading.values()))])):
        with catch_warnings(action="ignore"):
            found = solve(file).attrs["validity"]
        assert (re.search(said, found) is not None) if said else "mirrored period" not in found


@pytest.mark.parametrize("dimension", [1, 2])
def test_a_form_stands_on_the_middle_of_a_mirrored_field(dimension):
    """There is no seam there, and a contact is that with the field alone; a force acts on one form."""
    heights = 1e-9 * np.random.default_rng(5).normal(size=(32,) * dimension)
    roughness = {"method": "measured", "heights": heights, "units": {"z": "m"}, "spacing": 1e-6}
    load = {"line_load": "2 N/m"} if dimension == 1 else {"force": "2 uN"}
    scene = {"body": {"youngs_modulus": "1 GPa", "poissons_ratio": 0.3}, "form": {"radius": "200 um"}, "loading": load}
    scene |= {"interface": {"hard_wall": {}}, "roughness": roughness | {"periodic": "mirror"}}
    with catch_warnings(action="ignore"):
        contact = gfmd_numba.solve({"scene": scene})
    touching = np.argwhere(contact["gap"].values == 0.0)
    assert np.all((touching >= 8) & (touching < 24))
    assert "acts on the mirrored period" not in contact.attrs["validity"]
