"""`--only` takes what stands in a campaign's grid: its keys, its units, its names, and numbers read off a table."""

import pytest

from gfmd_numba.campaign.coordinates import meeting
from gfmd_numba.campaign.plan import plan
from gfmd_numba.scene import InputError

GRID = {"pressure": ["50 MPa", "0.1 GPa"], "aspect_ratio": [1 / 3, float("inf")], "rms_height": ["1 um", "3 um"]}
CAMPAIGN = {
    "name": "loads",
    "seed": 1,
    "realisations": 1,
    "scene": {
        "body": {"youngs_modulus": "70 GPa", "poissons_ratio": 0.3},
        "length": "1 mm",
        "roughness": {"method": "psd", "hurst": 0.8, "rms_height": "1 um"},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": "50 MPa"},
    },
    "reference": {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1},
    "grid": GRID,
}


@pytest.fixture(scope="module")
def planned():
    return plan(CAMPAIGN)


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("pressure", "50 MPa"),
        ("pressure", "50MPa"),
        ("pressure", "0.05 GPa"),
        ("pressure", "5e7"),
        ("pressure", " 50000000"),
        ("prescribed_pressure", "5e7"),
        ("prescribed_pressure", "50 MPa"),
        ("aspect_ratio", "1/3"),
        ("aspect_ratio", "0.333333"),
        ("aspect_ratio", "inf"),
        ("aspect_ratio", ".inf"),
        ("rms_height", "3 um"),
        ("rms_height", "3 µm"),
    ],
)
def test_a_value_is_given_as_in_the_grid_or_as_printed(planned, name, given):
    chosen = meeting(planned.cases, {name: given})
    assert len(chosen) == 4
    cases = {id(case) for case in chosen}
    references = meeting(planned.cases, {name: given, "limit": "reference", "is_reference": "true"})
    assert {id(case) for case in references} == cases


def test_conditions_are_met_together(planned):
    (case,) = meeting(planned.cases, {"pressure": "100 MPa", "aspect_ratio": ".inf", "rms_height": "3e-6"})
    assert case.scene.loading.pressure == 1e8
    assert case.scene.roughness.rms_height == 3e-6
    assert case.scene.body.aspect_ratio == float("inf")


@pytest.mark.parametrize(
    ("name", "given", "said"),
    [
        (
            "pressure",
            "60 MPa",
            "--only: you gave pressure=60 MPa; gfmd allows a value of the campaign, like 50 MPa, 100 MPa",
        ),
        ("pressure", "50.001 MPa", "like 50 MPa, 100 MPa"),
        (
            "pressure",
            "50 mm",
            "--only: you gave pressure=50 mm; gfmd allows a pressure in Pa, kPa, MPa, GPa or the like",
        ),
        ("pressure", "50 Mpa", "did you mean 'MPa'?"),
        ("pressure", "high", "like 50 MPa, 100 MPa"),
        (
            "aspect_ratio",
            "0.3333",
            "--only: you gave aspect_ratio=0.3333; gfmd allows a value of the campaign, like 0.333333",
        ),
        ("rms_height", "1 nm", "gfmd allows a value of the campaign, like 1 µm, 3 µm"),
        ("presure", "50 MPa", "--only: you gave presure; gfmd allows case_id, limit, "),
        ("presure", "50 MPa", "did you mean 'pressure'?"),
        ("aspect_ratio", "1 MPa", "gfmd allows a value of the campaign, like 0.333333, inf"),
    ],
)
def test_what_is_not_there_is_told_with_what_is(planned, name, given, said):
    with pytest.raises(InputError) as refused:
        meeting(planned.cases, {name: given})
    assert said in str(refused.value)


def test_a_unit_for_a_scene_without_units_is_refused():
    roughness = {"method": "psd", "hurst": 0.8, "rms_height": 1e-3}
    scene = {**CAMPAIGN["scene"], "body": {"poissons_ratio": 0.3}, "roughness": roughness}
    del scene["length"]
    scene["loading"] = {"reduced_pressure": 0.01}
    planned = plan({**CAMPAIGN, "scene": scene, "grid": {"rms_height": [1e-3, 2e-3]}})
    assert len(meeting(planned.cases, {"rms_height": "0.002"})) == 1
    with pytest.raises(
        InputError, match="--only: you gave rms_height=2 mm; gfmd allows a number without a unit, as the scene"
    ):
        meeting(planned.cases, {"rms_height": "2 mm"})


def test_conditions_that_no_case_meets_together_are_refused(planned):
    limits = plan({**CAMPAIGN, "limits": {"eps_c": [1 / 4]}, "grid": {}})
    with pytest.raises(
        InputError, match="you gave --only limit=eps_c --only eps_c=1/2, and no case meets all of these"
    ):
        meeting(limits.cases, {"limit": "eps_c", "eps_c": "1/2"})
