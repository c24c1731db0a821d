"""A mean pressure, a line load and a force are the reduced pressure that they come to, and stand in the output."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis import secant_stiffness
from support.faulty_files import assert_complaint, changed, complaint, load_checked

YOUNG, NU, GRADIENT, PERIOD = 70e9, 0.33, 0.01, 2e-4
MODULUS = YOUNG / (1 - NU**2)
PRESSURE = 0.05 * GRADIENT * MODULUS
BODY = {"youngs_modulus": YOUNG, "poissons_ratio": NU}
ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": GRADIENT}
LOADED = {
    "pressure": ({"pressure": PRESSURE}, {}, "Pa"),
    "line_load": ({"line_load": PRESSURE * PERIOD}, {"length": PERIOD}, "N m-1"),
    "force": ({"force": PRESSURE * PERIOD**2}, {"length": PERIOD, "dimension": 2}, "N"),
}
SCENE = """\
scene:
  length: 1 mm
  body: {youngs_modulus: 70 GPa, poissons_ratio: 0.33, aspect_ratio: 1/2}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {line_load: 1 kN/m}
discretisation: {eps_c: 1/2, eps_f: 1/4, eps_t: 1/2}
path: [{line_load: 2 kN/m}]
"""
CAMPAIGN = {
    "name": "loads",
    "seed": 1,
    "realisations": 2,
    "reference": {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2},
}


def solved(loading, path=(), **parts):
    scene = {"body": BODY, "roughness": ROUGH, "interface": {"hard_wall": {}}, "loading": loading} | parts
    grid = {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2}
    return gfmd_numba.solve({"scene": scene, "discretisation": grid, "path": list(path)})


@pytest.mark.parametrize("name", LOADED)
def test_a_load_is_the_reduced_pressure_it_comes_to(name):
    loading, parts, unit = LOADED[name]
    contact, reduced = solved(loading, **parts), solved({"reduced_pressure": 0.05}, **parts)
    np.testing.assert_array_equal(contact["pressure"], reduced["pressure"])
    assert float(contact["mean_pressure"]) == pytest.approx(PRESSURE, rel=1e-7)
    load = f"prescribed_{name}" if name == "pressure" else name
    assert (float(contact[load]), contact[load].units) == (loading[name], unit)
    assert float(contact["reduced_pressure"]) == 0.05
    assert contact["reduced_pressure"].units == "1"


def test_two_bodies_share_a_load_by_their_contact_modulus():
    soft = {"youngs_modulus": 2e9, "poissons_ratio": 0.4}
    together = 1 / ((1 - NU**2) / YOUNG + (1 - 0.4**2) / 2e9)
    contact = solved({"pressure": 3e6}, roughness=None, body=BODY | {"roughness": ROUGH}, counter_body=soft)
    assert float(contact["reduced_pressure"]) == pytest.approx(3e6 / GRADIENT / together, rel=1e-11)
    assert float(contact["mean_pressure"]) == pytest.approx(3e6, rel=1e-7)


@pytest.mark.filterwarnings("ignore:the grid has too few nodes")
def test_a_path_changes_the_load_that_the_loading_prescribes():
    path = solved({"pressure": 1e6}, [{"pressure": "3 MPa"}, {"pressure": 2e6}])
    assert path["prescribed_pressure"].values.tolist() == [1e6, 3e6, 2e6]
    np.testing.assert_allclose(path["reduced_pressure"], path["prescribed_pressure"] / GRADIENT / MODULUS, rtol=1e-11)
    np.testing.assert_allclose(path["mean_pressure"], path["prescribed_pressure"], rtol=1e-7)


NOTHING = "a youngs_modulus of every elastic body"
FAULTS = {
    "no moduli": (("youngs_modulus: 70 GPa, ", ""), f"you gave '1 kN/m'; gfmd allows line_load with {NOTHING}, or a"),
    "no length": (
        ("  length: 1 mm\n", ""),
        "you gave '1 kN/m'; gfmd allows line_load with the length of the period, or a",
    ),
    "on a map": (("  length", "  dimension: 2\n  length"), "you gave '1 kN/m'; gfmd allows a force with dimension 2"),
    "another dimension": (
        ("1 kN/m", "1 kN"),
        "you gave '1 kN'; gfmd allows a force per length in N/m, kN/m, N/mm or the",
    ),
    "beyond measure": (
        ("1 kN/m", "1e30"),
        "you gave 1e+30; gfmd allows a reduced pressure from 1e-30 to 1e+30, while this one",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_load_that_makes_no_sense_is_refused_where_it_stands(name, tmp_path):
    change, expected = FAULTS[name]
    text = changed(SCENE, *change)
    if name == "beyond measure":
        text = changed(changed(text, "youngs_modulus: 70 GPa", "youngs_modulus: 1e-30 Pa"), "1 mm", "1e-30 m")
    load = gfmd_numba.solve if name == "beyond measure" else load_checked
    said = complaint(tmp_path, load, text)
    line = {"no length": 5, "on a map": 7}.get(name, 6)
    assert said.startswith(f"bad.yaml:{line}:24: scene.loading.line_load: {expected}"), said


def test_a_step_changes_no_other_load(tmp_path):
    expected = (
        "bad.yaml:8:19: path[0].pressure: you gave '1 MPa'; gfmd allows what the loading prescribes, which is line_load"
    )
    assert_complaint(tmp_path, load_checked, SCENE, ("{line_load: 2 kN/m}", "{pressure: 1 MPa}"), expected)


def test_a_force_on_a_profile_is_refused(tmp_path):
    text = changed(SCENE, "line_load: 1 kN/m", "force: 1 N").replace("line_load: 2 kN/m", "force: 2 N")
    said = complaint(tmp_path, load_checked, text)
    assert said.startswith(
        "bad.yaml:6:20: scene.loading.force: you gave '1 N'; gfmd allows a line_load with dimension 1"
    )


@pytest.mark.long
@pytest.mark.parametrize("name", ["pressure", "force"])
def test_a_campaign_varies_each_load(name, tmp_path):
    loading, parts, unit = LOADED[name]
    scene = {"body": BODY, "roughness": ROUGH, "interface": {"hard_wall": {}}, "loading": loading} | parts
    values = [loading[name] * factor for factor in (1.0, 2.0, 4.0)]
    file = CAMPAIGN | {"scene": scene, "grid": {name: values}}
    dataset = gfmd_numba.run(file, tmp_path / "loads", workers=0)
    load = f"prescribed_{name}" if name == "pressure" else name
    assert dataset[load].values.tolist() == values
    assert (dataset[load].units, dataset[load].attrs["axis"]) == (unit, "physics")
    assert dataset["reduced_pressure"].values.tolist() == [0.05, 0.1, 0.2]
    assert "axis" not in dataset["reduced_pressure"].attrs
    stiffness = secant_stiffness(dataset)
    assert stiffness.sizes["interval"] == 2
    assert (stiffness["stiffness"] > 0.0).all()


@pytest.mark.parametrize(
    ("modulus", "said"),
    [
        ("1 mPa", r"scene.loading.pressure: you gave 1e.30; gfmd allows a reduced pressure"),
        (1e-30, r"scene.body.youngs_modulus: you gave 1e-30; gfmd allows what goes with the load, in a unit: "),
    ],
)
def test_a_load_far_beyond_all_measure_is_refused_in_a_campaign(modulus, said):
    scene = {"body": BODY | {"youngs_modulus": modulus}, "roughness": ROUGH, "interface": {"hard_wall": {}}}
    file = CAMPAIGN | {"scene": scene | {"loading": {"pressure": 1e30}}}
    with pytest.raises(gfmd_numba.InputError, match=said):
        gfmd_numba.run(file, "nowhere", workers=0)
