"""Surfaces with points of their own are checked in campaigns as in scenes, and tell their problems apart."""

import pytest
import yaml
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.plan import plan
from gfmd_numba.cli import main
from gfmd_numba.scene import InputError

MODEL = {"method": "psd", "model": "k_correlation", "hurst": 0.8, "correlation_length": 0.1, "rms_height": 1e-3}
POWER_LAW = {"method": "psd", "hurst": 0.8, "roll_off": 0.5, "cut_on": 0.125, "rms_gradient": 0.02}


def campaign(roughness, grid=None, **scene):
    parts = {
        "body": {"poissons_ratio": 0.3},
        "roughness": roughness | {"points": roughness.get("points", 32)},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05},
    }
    return {"name": "c", "seed": 7, "realisations": 2, "scene": parts | scene} | ({"grid": grid} if grid else {})


@pytest.mark.parametrize("mounds", [{}, {"mound_separation": 0.3}])
def test_models_with_equal_numbers_are_different_problems(mounds):
    identities = {
        plan(campaign(MODEL | mounds | {"model": model})).problems[0].identity
        for model in ("exponential", "k_correlation")
    }
    assert len(identities) == 2


ADHESIVE = {"interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-5, "range": 0.1}}}


@pytest.mark.parametrize(
    ("file", "said"),
    [
        (campaign(POWER_LAW | {"cut_on": 0.01}), "scene.roughness.cut_on: you gave 0.01; gfmd allows at least 0.0666"),
        (
            campaign(POWER_LAW, length=1e-4),
            "scene.roughness.roll_off: you gave 0.5; gfmd allows at most the period 0.0001",
        ),
        (campaign(MODEL | {"cut_on": 2.0}), "scene.roughness.cut_on: you gave 2"),
        (campaign(MODEL | {"cut_on": 0.001}), "scene.roughness.cut_on: you gave 0.001; gfmd allows at least"),
        (campaign(POWER_LAW | {"roll_off": 3.0}), "scene.roughness.roll_off: you gave 3"),
        (campaign(POWER_LAW | {"cut_on": 0.30, "roll_off": 0.31}), "scene.roughness.cut_on: you gave 0.3"),
        (
            campaign(MODEL | {"points": 2**38}),
            "scene.roughness.points: you gave 274877906944; gfmd allows a grid that fits",
        ),
        (campaign(POWER_LAW, {"anisotropy": [1, 50]}, dimension=2), "grid.anisotropy[1]: you gave 50"),
        (
            campaign(POWER_LAW, {"points": [32, 8]}),
            "grid.points[1]: you gave 8; gfmd allows a value for which cut_on is at",
        ),
        (
            campaign(MODEL, {"points": [8, 2**38]}),
            "grid.points[1]: you gave 274877906944; gfmd allows a grid that fits",
        ),
        (campaign(MODEL) | {"realisations": {"reference": 2, "eps_c": 5}}, "realisations.eps_c: you gave 5"),
    ],
)
def test_what_does_not_fit_the_points_is_refused(file, said):
    with pytest.raises(InputError) as refused:
        load_campaign(file)
    assert said in str(refused.value)


def test_a_range_that_the_fewest_points_do_not_resolve_is_refused():
    with pytest.raises(InputError, match=r"grid.interaction_range\[1\]: you gave 0.0003; gfmd allows at least 0.00063"):
        plan(campaign(MODEL, {"interaction_range": [0.1, 3e-4], "points": [64, 16]}, **ADHESIVE))
    plan(campaign(MODEL, {"interaction_range": [0.1, 3e-4], "points": [128]}, **ADHESIVE))


@pytest.mark.parametrize("command", ["run", "plan"])
def test_a_surface_that_cannot_be_made_is_one_message(tmp_path, command):
    file = tmp_path / "c.yaml"
    file.write_text(yaml.safe_dump(campaign(MODEL | {"method": "fourier_filter", "correlation_length": 5.0})))
    done = CliRunner().invoke(main, [command, str(file)])
    assert done.exit_code == 2
    assert "a usable surface, not a spectrum that is negative" in " ".join(done.stderr.split())


def test_a_map_beyond_its_period_is_refused_everywhere():
    stretched = POWER_LAW | {"anisotropy": 50, "points": 32}
    for make, file in (
        (gfmd_numba.make_surface, {"surface": stretched, "dimension": 2}),
        (gfmd_numba.solve, {"scene": campaign(stretched, dimension=2)["scene"]}),
    ):
        with pytest.raises(
            InputError, match=r"anisotropy: you gave 50; gfmd allows at most the period over roll_off = 2"
        ):
            make(file)


def test_points_of_a_grid_refine_the_same_surfaces(tmp_path):
    found = gfmd_numba.run(campaign(POWER_LAW, {"points": [64, 256]}), tmp_path / "out")
    assert found["points"].values.tolist() == found["nx"].values.tolist() == [64, 256]
    coarse, fine = found["nayak"].values
    assert coarse == pytest.approx(fine, rel=1e-9)
    assert fine[0] != fine[1]
