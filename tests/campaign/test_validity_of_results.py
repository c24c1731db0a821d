"""A campaign says what speaks against its contacts, as a contact that is solved alone does."""

import warnings

import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.validity import result_warnings

SCENE = {
    "length": 1e-3,
    "body": {"youngs_modulus": 1e9, "poissons_ratio": 0.3},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
    "interface": {"hard_wall": {}},
    "loading": {"pressure": 1e6},
}
FLOWS = {**SCENE["body"], "plasticity": {"yield_stress": 1e7, "depth": 1e-4, "sublayers": 8, "increments": 1}}
GRID = {"reference": {"eps_c": 1 / 8, "eps_f": 1 / 8, "eps_t": 1 / 2}, "realisations": 4}


@pytest.mark.parametrize(
    ("changed", "campaign", "said"),
    [
        ({}, {}, ""),
        ({"loading": {"pressure": 1e3}}, {}, "may be that of single nodes"),
        ({"loading": {"pressure": 1e5}}, {"grid": {"pressure": [3e3, 1e6]}}, "narrow on this grid in 1 of 2 cases"),
        ({"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 1.0}}, {}, "no longer small in 1 of 1 cases"),
        ({"loading": {"pressure": 5e8}}, {}, "and the mean pressure 0.4"),
        pytest.param({"body": FLOWS}, {}, "because strains turn within an increment", marks=pytest.mark.long),
    ],
    ids=["sound", "single nodes", "one case of two", "steep", "pressed hard", "flow"],
)
def test_it_says_what_a_contact_alone_would(tmp_path, monkeypatch, changed, campaign, said):
    monkeypatch.chdir(tmp_path)
    given = {"name": "doubtful", "seed": 1, "scene": SCENE | changed} | GRID | campaign
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        validity = gfmd_numba.run(given).attrs["validity"]
    assert said in validity
    assert bool(said) == bool(validity)


@pytest.mark.long
def test_it_says_that_divisions_of_time_are_too_coarse(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    creeps = {"body": SCENE["body"] | {"relaxation": [{"modulus": 1e9, "time": 1.0}]}}
    given = {"name": "creeps", "seed": 1, "scene": SCENE | creeps, "path": [{"duration": 1.0}]} | GRID
    planned, dataset = plan(given), gfmd_numba.run(given)
    assert dataset.attrs["validity"] == ""
    coarse = dataset.assign(time_error=xr.full_like(dataset["time_error"], 0.1))
    (said,) = result_warnings(planned.cases, planned.campaign.numerics, coarse)
    assert said.startswith("in 1 of 1 cases: the divisions of steps leave an error of 0.1")


@pytest.mark.parametrize(
    ("changed", "path", "said"),
    [
        ({"periodic": False, "loading": {"pressure": 5e7}}, None, "in 1 of 1 cases: the contact reaches the edge"),
        pytest.param(
            {
                "body": SCENE["body"] | {"aspect_ratio": 0.5},
                "interface": {"hard_wall": {}, "friction": {"coefficient": 0.1}},
            },
            [{"sliding": 1e-8}, {"sliding": 1e-4}],
            "in 1 of 1 cases, in step 2 of 2: the punch has slid past the body, ",
            marks=pytest.mark.long,
        ),
        pytest.param(
            {"body": FLOWS | {"plasticity": {**FLOWS["plasticity"], "depth": 1e-5}}, "loading": {"pressure": 3e6}},
            None,
            "in 1 of 1 cases: the body flows down to the lowest sublayer",
            marks=pytest.mark.long,
        ),
    ],
    ids=["edge", "far", "deep"],
)
def test_it_says_what_leaves_the_window_the_asperities_or_the_layer(tmp_path, monkeypatch, changed, path, said):
    monkeypatch.chdir(tmp_path)
    given = {"name": "leaves", "seed": 1, "scene": SCENE | changed} | GRID | ({"path": path} if path else {})
    with warnings.catch_warnings(action="ignore"):
        validity = gfmd_numba.run(given).attrs["validity"]
    assert said in validity


def test_it_says_how_many_simulations_failed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    failing = {"numerics": {"solver": "conjugate_gradients", "max_iterations": 1}}
    with pytest.warns(UserWarning, match="^steps_used_up in 4 of 4 simulations: The solver took"):
        gfmd_numba.run({"name": "fails", "seed": 1, "scene": SCENE} | GRID | failing)


@pytest.mark.long
def test_it_names_the_steps_of_a_path_that_are_doubtful(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = [{"pressure": 5e8}, {"pressure": 1e6}]
    with pytest.warns(UserWarning, match="no longer small in 1 of 1 cases, in step 1 of 2, where"):
        gfmd_numba.run({"name": "pressed", "seed": 1, "scene": SCENE, "path": path} | GRID)
