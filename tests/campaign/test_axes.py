"""Every axis of the one table reaches the scene, is checked as the scene is, and is named in the results."""

from itertools import product

import numpy as np
import pytest
from pydantic import TypeAdapter

import gfmd_numba
from gfmd_numba.campaign.axes import AXES, OF_THE_SCENE, in_fields, present, with_values
from gfmd_numba.campaign.coordinates import coordinates, has_measured_slope_law
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.plan import plan
from gfmd_numba.scene import Discretisation, InputError, Scene
from support.faulty_files import CAMPAIGN, changed, complaint

LAW = "{hard_wall: {}, exponential: {work_of_adhesion: 1e-5, range: 2e-2}}"
SCENES = {
    "displacement": ("{reduced_pressure: 0.007}", "{displacement: 0.001}"),
    "friction_coefficient": ("interface: {hard_wall: {}}", "interface: {hard_wall: {}, friction: {coefficient: 0.3}}"),
    "work_of_adhesion": ("interface: {hard_wall: {}}", f"interface: {LAW}"),
    "interaction_range": ("interface: {hard_wall: {}}", f"interface: {LAW}"),
}
COARSE = ("eps_f: 1/1024, eps_t: 1/2}\nlimits: {eps_c: [1, 1/2], eps_t: [1, 1/2, 1/4]}", "eps_f: 1/16, eps_t: 1/2}")
VALUES = {
    "displacement": "[0.002, 0.004]",
    "friction_coefficient": "[0.1, .inf]",
    "work_of_adhesion": "[1e-5, 2e-5]",
    "interaction_range": "[0.05, 0.1]",
}
FULL = Scene.model_validate(
    {
        "dimension": 1,
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1.0},
        "roughness": {"method": "psd", "hurst": 0.5, "rms_gradient": 0.1, "anisotropy": 1.0},
        "interface": {
            "hard_wall": {},
            "exponential": {"work_of_adhesion": 1.0, "range": 1.0},
            "friction": {"coefficient": 1.0, "limit": 1.0},
        },
        "loading": {"displacement": 1.0},
    }
)


def with_grid(name, values, *changes):
    text = changed(CAMPAIGN, "grid: {hurst: [0.3, 0.5]}", f"grid: {{{name}: {values}}}")
    for change in changes:
        text = changed(text, *change)
    return text


@pytest.mark.parametrize("axis", [axis for axis in OF_THE_SCENE if axis.value(FULL, None)], ids=lambda axis: axis.name)
def test_a_value_of_an_axis_stands_in_its_place_of_the_scene_alone(axis):
    value = 0.375 if axis.name not in ("anisotropy",) else 1.5
    assert TypeAdapter(axis.type).validate_python(value) == value
    found = with_values(FULL, {axis.place: value})
    asked, changed_to = FULL.model_dump(), found.model_dump()
    for part in in_fields(FULL, axis.place)[:-1]:
        asked, changed_to = asked[part], changed_to[part]
    assert changed_to == asked | {axis.place[-1]: value}
    assert axis.value(found, None) == value
    before = axis.value(FULL, None)
    restored = with_values(found, {axis.place: before})
    assert restored == FULL


def test_names_and_symbols_of_axes_are_unique():
    for of in (lambda axis: axis.name, lambda axis: axis.coordinate, lambda axis: axis.symbol, lambda axis: axis.label):
        assert len({of(axis) for axis in AXES}) == len(AXES)


def test_discretisations_are_those_of_the_record():
    assert [axis.name for axis in AXES if not axis.place] == list(Discretisation.model_fields)


@pytest.mark.parametrize("name", ["displacement", "friction_coefficient"])
def test_a_grid_over_a_parameter_of_the_scene_is_run(tmp_path, name):
    (tmp_path / "grid.yaml").write_text(
        with_grid(name, VALUES[name], COARSE, SCENES[name], ("realisations: 30", "realisations: 2"))
    )
    planned = plan(tmp_path / "grid.yaml")
    assert len(planned.problems) == len(planned.cases) == 2
    dataset = gfmd_numba.run(tmp_path / "grid.yaml", tmp_path / "out", workers=0)
    (axis,) = (axis for axis in AXES if axis.name == name)
    column = dataset[axis.coordinate]
    assert column.values.tolist() == list(load_campaign(tmp_path / "grid.yaml")[0].model_dump()["grid"][name])
    assert column.attrs["axis"] == "physics"
    assert (dataset["status"] == 0).all()
    assert len(np.unique(dataset["mean_gap"].mean("realisation"))) == 2


@pytest.mark.parametrize("name", SCENES)
def test_a_grid_over_what_the_scene_does_not_have_says_what_to_add(tmp_path, name):
    said = complaint(tmp_path, load_campaign, with_grid(name, VALUES[name]))
    assert said.startswith(f"bad.yaml:11:{8 + len(name) + 2}: grid.{name}: you gave [")
    (axis,) = (axis for axis in AXES if axis.name == name)
    if "law_of_the_gap" in axis.place:
        assert "nothing without a law of the gap in scene.interface" in said
    elif axis.place[0] == "interface":
        home, key = ".".join(("scene", *axis.place[:-1])), axis.place[-1]
        assert f"nothing without {home}.{key}: add `{key}` to {home}" in said
    else:
        assert said.endswith("gfmd allows nothing, as the loading is a reduced_pressure")


@pytest.mark.parametrize(
    ("name", "values", "change", "allowed"),
    [
        ("work_of_adhesion", "[1e-5, 0]", (), "[1]: you gave 0; gfmd allows a number other than 0"),
        (
            "work_of_adhesion",
            "[-1, 1]",
            ("{hard_wall: {}, exp", "{exp"),
            "[1]: you gave 1; gfmd allows hard_wall: {}, cohesive",
        ),
        ("interaction_range", "[0.1, 0]", (), "[1]: you gave 0; gfmd allows a number from 1e-30 to 1e+30"),
        (
            "friction_coefficient",
            "[0]",
            (),
            "[0]: you gave 0; gfmd allows a number above 0, or .inf for sticking contact",
        ),
        (
            "displacement",
            "[0.1, -0.1]",
            (),
            "[1]: you gave -0.1; gfmd allows a finite number of at least 0, as nothing acts",
        ),
    ],
)
def test_a_value_of_a_grid_keeps_the_rules_of_the_scene(tmp_path, name, values, change, allowed):
    if change:
        law = SCENES[name][1].replace(*change).replace("work_of_adhesion: 1e-5", "work_of_adhesion: -1e-5")
        said = complaint(tmp_path, load_campaign, with_grid(name, values, (SCENES[name][0], law)))
    else:
        said = complaint(tmp_path, load_campaign, with_grid(name, values, SCENES[name]))
    assert f"grid.{name}{allowed}" in said


@pytest.mark.parametrize("law", ["exponential", "squared_exponential", "power_law", "maugis_dugdale", "lennard_jones"])
def test_the_law_of_the_gap_is_varied_whichever_acts(law):
    scene = {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.5, "rms_gradient": 0.1},
        "interface": {"hard_wall": {}, law: {"work_of_adhesion": 1e-5, "range": 0.02}},
        "loading": {"reduced_pressure": 0.05},
    }
    file = {"name": "law", "seed": 1, "realisations": 1, "reference": {"eps_c": 0.25, "eps_f": 0.25, "eps_t": 0.5}}
    grid = {"work_of_adhesion": [1e-5, 2e-5], "interaction_range": [0.02, 0.03]}
    cases = plan(file | {"scene": scene, "grid": grid}).cases
    for case, (work, length) in zip(cases, product(*grid.values()), strict=True):
        own = scene | {"interface": {"hard_wall": {}, law: {"work_of_adhesion": work, "range": length}}}
        (alone,) = plan(file | {"scene": own}).cases
        assert case.problem.identity == alone.problem.identity
    if law not in ("exponential", "power_law"):
        with pytest.raises(InputError, match="you gave -1e-05; gfmd allows a number from 1e-30"):
            plan(file | {"scene": scene, "grid": {"work_of_adhesion": [-1e-5]}})


def test_values_of_one_record_are_checked_together():
    scene = FULL.model_dump(exclude_none=True) | {
        "interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}},
        "roughness": {"method": "psd", "hurst": 0.5, "rms_gradient": 0.1},
    }
    file = {"name": "pairs", "seed": 1, "realisations": 1, "reference": {"eps_c": 0.25, "eps_f": 0.25, "eps_t": 0.5}}
    grid = {"friction_coefficient": [0.2, np.inf], "friction_limit": [0.1, 0.2]}
    with pytest.raises(
        InputError, match=r"grid.friction_limit\[0\]: you gave 0.1; gfmd allows no limit with an infinite"
    ):
        plan(file | {"scene": scene, "grid": grid})
    assert len(plan(file | {"scene": scene, "grid": grid | {"friction_coefficient": [0.2, 0.3]}}).cases) == 4


def test_a_rising_shear_strength_is_varied_below_the_coefficient():
    friction = {"coefficient": 0.3, "limit": 0.1, "pressure_coefficient": 0.05}
    scene = FULL.model_dump(exclude_none=True) | {
        "interface": {"hard_wall": {}, "friction": friction},
        "roughness": {"method": "psd", "hurst": 0.5, "rms_gradient": 0.1},
    }
    file = {"name": "rises", "seed": 1, "realisations": 1, "reference": {"eps_c": 0.25, "eps_f": 0.25, "eps_t": 0.5}}
    cases = plan(file | {"scene": scene, "grid": {"friction_pressure_coefficient": [0.05, 0.2]}}).cases
    assert [case.problem.interface.shear_rise for case in cases] == [0.05, 0.2]
    with pytest.raises(InputError, match=r"grid.friction_pressure_coefficient\[0\]: you gave 0.3; gfmd allows .* less"):
        plan(file | {"scene": scene, "grid": {"friction_pressure_coefficient": [0.3]}})


def test_what_friction_depends_on_by_the_slip_rate_is_varied():
    friction = {"coefficient": 0.3, "velocity_strengthening": 0.01, "reference_velocity": 1e-3}
    scene = {"body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5}, "roughness": {"method": "psd", "hurst": 0.5}}
    scene["roughness"]["rms_gradient"] = 0.1
    scene |= {"interface": {"hard_wall": {}, "friction": friction}}
    scene |= {"loading": {"reduced_pressure": 0.1, "duration": 1.0}}
    file = {"name": "rates", "seed": 1, "realisations": 1, "reference": {"eps_c": 0.25, "eps_f": 0.25, "eps_t": 0.5}}
    grid = {"friction_velocity_strengthening": [0.02, 0.05], "friction_reference_velocity": [1e-3, 2e-3]}
    laws = [case.problem.interface.slip_rate for case in plan(file | {"scene": scene, "grid": grid}).cases]
    assert [law.strengthening for law in laws] == [0.02, 0.02, 0.05, 0.05]
    assert [law.reference / laws[0].reference for law in laws] == pytest.approx([1.0, 2.0, 1.0, 2.0])
    shown = [axis.name for axis in present(plan(file | {"scene": scene}).campaign.scene, None)]
    assert "friction_pressure_coefficient" not in shown  # of a friction without a limit


def test_what_touches_nowhere_has_no_contact_area_as_a_target():
    scene = {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.5, "rms_height": 0.01},
        "interface": {"lennard_jones": {"work_of_adhesion": 1e-5, "range": 0.02}},
        "loading": {"reduced_pressure": 0.05},
    }
    with pytest.raises(
        InputError, match=r"target.kappa: .* mean_gap or elastic_energy: under this law nothing touches"
    ):
        plan({"name": "apart", "seed": 1, "scene": scene, "target": {"kappa": 0.1}})


def test_an_axis_without_values_has_no_coordinate(tmp_path):
    (tmp_path / "plain.yaml").write_text(CAMPAIGN)
    found = coordinates(plan(tmp_path / "plain.yaml").cases)
    assert not {"anisotropy", "punch_displacement", "friction_coefficient", "work_of_adhesion"} & found.keys()
    assert {"hurst", "reduced_pressure", "rms_gradient_target", "eps_c"} <= found.keys()


PLAIN = {
    "body": {"poissons_ratio": 0.3},
    "roughness": {"method": "psd", "hurst": 0.5, "rms_gradient": 0.1},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.01},
}


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({}, True),
        ({"body": {"poissons_ratio": 0.3, "aspect_ratio": 0.1}}, True),
        ({"dimension": 2}, False),
        ({"periodic": False}, False),
        ({"form": {"radius": 1.0}}, False),
        ({"boundary": {"normal_traction": 0.1}}, False),
        ({"roughness": PLAIN["roughness"] | {"plateau": False}}, False),
        ({"roughness": PLAIN["roughness"] | {"method": "midpoint_displacement"}}, False),
        ({"roughness": None, "body": PLAIN["body"] | {"roughness": PLAIN["roughness"]}}, False),
        ({"interface": {"hard_wall": {"hardness": 0.1}}}, False),
        ({"interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}}}, False),
    ],
)
def test_the_law_of_the_unseen_slope_was_measured_for_plain_contacts_of_profiles(change, expected):
    assert has_measured_slope_law(Scene.model_validate(PLAIN | change)) == expected
