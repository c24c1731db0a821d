"""Rough bodies that are steep, or cannot be pressed: what is doubted and what is refused."""

import warnings

import numpy as np
import pytest
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.cli import main
from gfmd_numba.contact.rough_surfaces import RoughBody, change_of_thickness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.scene import InputError
from gfmd_numba.solvers.status import Status
from support.rough_bodies import BODY, ROUGH, X, measured, rough, scene

pytestmark = pytest.mark.usefixtures("undrawn")


def test_steep_topographies_are_doubted():
    with pytest.warns(UserWarning, match=r"gradient of 0\.2, above 0\.03: .* change displacements by up to .* L_x"):
        contact = gfmd_numba.solve(scene(body=rough(rms_gradient=0.2)))
    assert "above 0.03: " in contact.validity
    wide = {"reduced_pressure": 0.1}  # contacts of many nodes
    with warnings.catch_warnings(action="error"):
        for negligible in (0.03, 0.04):  # the latter changes displacements by less than 1e-3 of the largest
            assert gfmd_numba.solve(scene(loading=wide, body=rough(rms_gradient=negligible))).validity == ""
        assert gfmd_numba.solve(scene(loading=wide, roughness=ROUGH | {"rms_gradient": 0.05})).status == 0


def film(folder, order, amplitude=0.02, thickness=0.05):
    """A flat punch comes down by a third of the amplitude, which is given over the thickness of the body."""
    height = amplitude * thickness
    wave = measured(folder, height * np.cos(2 * np.pi * X))
    body = BODY | {"aspect_ratio": thickness, "roughness": wave}
    return gfmd_numba.solve(scene(order, {"displacement": height / 3}, body=body))


def test_waves_no_shorter_than_2_pi_thicknesses_change_that_of_a_film():
    x = 2.0 * np.pi * np.arange(64) / 64
    elastic, heights = ElasticBody(0.3, 0.1), 0.01 * np.cos(x) + 0.02 * np.cos(2.0 * x)
    body = RoughBody(elastic=elastic, compliance_fraction=1.0, heights=heights)
    assert change_of_thickness(body) == pytest.approx(0.1)


def test_order_0_is_doubted_in_thin_films_and_off_by_as_much_as_it_says(tmp_path):
    with pytest.warns(UserWarning, match=r"changes its thickness by up to 0\.02 of it, which order 0 leaves out"):
        doubted = film(tmp_path, 0)
    with warnings.catch_warnings(action="error"):
        right = film(tmp_path, 2)
        assert film(tmp_path, 0, amplitude=0.009).validity == ""
        assert film(tmp_path, 0, amplitude=0.004, thickness=1.0).validity == ""
    assert float(doubted.peak_pressure / right.peak_pressure) - 1 == pytest.approx(0.02, rel=0.1)


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:strains are no longer small", "ignore:the heights step", "ignore:too_steep")
def test_vertical_walls_are_too_steep_for_every_order_in_the_slope(tmp_path):
    """The rectangle of thesis (5.17), whose slope has no bound: each order would add as much as the last one."""
    body = BODY | {"aspect_ratio": 1.0, "roughness": measured(tmp_path, np.where(abs(X - 0.5) <= 0.05, 0.01, 0.0))}
    with pytest.warns(UserWarning, match="rms gradient"):
        ended = [int(gfmd_numba.solve(scene(order, body=body)).status) for order in (0, 1, 3)]
    assert ended == [Status.ok, Status.too_steep, Status.too_steep]


def test_steep_bodies_that_just_touch_are_at_rest():
    contact = gfmd_numba.solve(scene(body=rough(rms_gradient=0.05), loading={"displacement": 0.0}))
    assert contact.validity == ""
    assert contact.status == 0
    assert not contact.displacement.any()


@pytest.mark.long
def test_the_command_line_tells_the_doubt_and_draws_both_bodies(tmp_path):
    file = tmp_path / "two.yaml"
    file.write_text(
        """
body: {youngs_modulus: 1, poissons_ratio: 0.3, roughness: {method: psd, hurst: 0.8, rms_gradient: 0.2}}
counter_body: {youngs_modulus: 2, poissons_ratio: 0.5, roughness: {method: psd, hurst: 0.5, rms_gradient: 0.01}}
interface: {hard_wall: {}}
loading: {reduced_pressure: 0.05}
discretisation: {eps_c: 1/2, eps_f: 1/16, eps_t: 1/2}
"""
    )
    solved = CliRunner().invoke(main, ["solve", str(file), "-o", str(tmp_path / "two.nc")])
    assert solved.exit_code == 0, solved.output
    assert "gfmd: a deformable surface has an rms gradient of 0.2" in solved.output
    assert CliRunner().invoke(main, ["plot", str(tmp_path / "two.nc")]).exit_code == 0
    asked = ["fields", str(tmp_path / "two.nc"), "--body", "counter_body", "-o", str(tmp_path / "fields.nc")]
    assert CliRunner().invoke(main, asked).exit_code == 0
    assert (tmp_path / "fields.png").exists()


COUNTER = BODY | {"roughness": ROUGH}
RUBBING = {"hard_wall": {}, "friction": {"coefficient": 0.3}}
BAD = {
    "all flat": (
        {},
        "scene.roughness: you gave nothing; gfmd needs a mapping with a method like 'psd' or 'measured', here for "
        "the punch",
    ),
    "punch with a counter body": (
        {"counter_body": COUNTER, "roughness": ROUGH},
        "scene.roughness: you gave {.*}; gfmd allows no punch next to a counter_body: move",
    ),
    "counter body without a modulus": (
        {"counter_body": {"poissons_ratio": 0.3, "roughness": ROUGH}},
        "scene.counter_body.youngs_modulus: you gave nothing; gfmd needs a number above 0 for both bodies",
    ),
    "bodies in different states": (
        {"counter_body": COUNTER | {"state": "plane_stress"}},
        "scene.counter_body.state: you gave 'plane_stress'; gfmd allows 'plane_strain', as that of the body",
    ),
    "sliding of a half-space": (
        {"order": 0, "body": COUNTER | {"aspect_ratio": np.inf}, "interface": RUBBING, "path": [{"sliding": 1e-4}]},
        r"path\[0\].sliding: you gave 0.0001; gfmd allows nothing without a finite aspect_ratio",
    ),
    "half-space under displacement control": (
        {"body": COUNTER | {"aspect_ratio": np.inf}, "loading": {"displacement": 1e-3}},
        "scene.body.aspect_ratio: you gave inf; gfmd allows a finite aspect_ratio, .* no reference for displacement",
    ),
    "half-space as counter body under displacement control": (
        {"counter_body": COUNTER | {"aspect_ratio": np.inf}, "loading": {"displacement": 1e-3}},
        "scene.counter_body.aspect_ratio: you gave inf; gfmd allows a finite aspect_ratio",
    ),
    "more than there is room for between incompressible bodies": (
        {
            "order": 0,
            "body": COUNTER | {"poissons_ratio": 0.5},
            "counter_body": BODY | {"poissons_ratio": 0.5},
            "loading": {"displacement": 0.01},
        },
        "scene.loading.displacement: you gave 0.01; gfmd allows at most 0.000787.*, as an incompressible body has no "
        "room",
    ),
    "topography higher than the body": (
        {"body": COUNTER | {"aspect_ratio": 1e-4}},
        "scene.body.roughness: you gave a topography from -.* L_x; gfmd allows one within the height of the body",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bodies_that_cannot_be_pressed_are_refused(case):
    changes, message = BAD[case]
    changes = dict(changes)
    file = {"path": changes.pop("path")} if "path" in changes else {}
    given = scene(**changes) | file
    if case == "all flat":
        given.pop("discretisation", None)
    with pytest.raises(InputError, match=message):
        gfmd_numba.solve(given)


def test_profiles_that_do_not_fit_are_refused(tmp_path):
    heights = 1e-3 * np.cos(2 * np.pi * X)
    body = BODY | {"roughness": measured(tmp_path, heights)}
    with pytest.raises(InputError, match=r"scene.body.roughness: you gave 512 heights; gfmd allows as many .* 256"):
        gfmd_numba.solve(scene(body=body, roughness=measured(tmp_path, heights[::2], "p.npy")))
    with pytest.raises(InputError, match=r"heights that add up to nothing; gfmd allows surfaces that are not all flat"):
        gfmd_numba.solve(scene(body=body, roughness=measured(tmp_path, -heights, "p.npy")))
    with pytest.raises(InputError, match=r"body.roughness.file: you gave 'missing.npy'; gfmd allows an existing file"):
        gfmd_numba.solve(scene(body=BODY | {"roughness": {"method": "measured", "file": "missing.npy"}}))


def test_fields_of_a_body_that_is_not_there_are_refused():
    contact = gfmd_numba.solve(scene(body=rough()))
    with pytest.raises(InputError, match=r"body: you gave 'counter_body'; gfmd allows 'body'"):
        gfmd_numba.body_fields(contact, body="counter_body")


@pytest.mark.filterwarnings("ignore:a deformable surface")
def test_the_next_order_is_told_next_to_the_largest_displacement_of_any_body():
    soft, stiff = rough(rms_gradient=0.1), {**BODY, "youngs_modulus": 1e3}
    for one, other in ((soft, stiff), (stiff, soft)):
        found = gfmd_numba.solve(scene(order=0, body=one, counter_body=other, loading={"pressure": 2e-3}))
        largest = max(abs(found[name]).max() for name in ("displacement", "counter_body_displacement"))
        assert f", {float(found.next_order / largest):.2g} times the largest displacement" in found.validity
