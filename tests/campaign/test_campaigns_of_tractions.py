"""Campaigns of rough punches on a body that is loaded node by node before they come."""

import numpy as np
import pytest
import yaml

import gfmd_numba
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.work_precision import studies, study_of
from gfmd_numba.scene import InputError
from support.command_line import gfmd
from support.realisations import assert_as_solved

pytestmark = pytest.mark.usefixtures("undrawn")

NX = 256
WAVE = 2e-3 * np.cos(2 * np.pi * np.arange(NX) / NX)
ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02}
SCENE = {
    "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
    "roughness": ROUGH,
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.05},
}
RUBBED = {"interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}}}
HELD = {"interface": {"cohesive": {"work_of_adhesion": 1e-4, "normal_length": 4e-3, "tangential_length": 4e-3}}}
REFERENCE = {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}


def of(boundary, scene=SCENE, **more):
    """Mapping of a campaign of two realisations."""
    whole = scene | {"boundary": boundary}
    return {"name": "tractions", "seed": 4, "realisations": 2, "scene": whole, "reference": REFERENCE} | more


@pytest.fixture
def wave(tmp_path):
    np.save(tmp_path / "wave.npy", WAVE)
    return {"normal_traction": str(tmp_path / "wave.npy")}


@pytest.mark.parametrize(
    ("scene", "more"),
    [
        (SCENE, {}),
        pytest.param(SCENE | RUBBED, {"path": [{"sliding": 1e-3}]}, marks=pytest.mark.long),
        pytest.param(SCENE | HELD, {"path": [{"sliding": 1e-3}]}, marks=pytest.mark.long),
        pytest.param(SCENE | {"body": SCENE["body"] | {"roughness": ROUGH}}, {}, marks=pytest.mark.long),
    ],
    ids=["punch", "dragged punch", "cohesive punch", "rough body"],
)
def test_a_realisation_has_the_numbers_of_solve(wave, tmp_path, scene, more):
    found = gfmd_numba.run(of(wave, scene, **more), tmp_path / "out", workers=0)
    assert (found["status"] == 0).all()
    assert_as_solved(found, 0, 1, scene | {"boundary": wave}, more | {"discretisation": REFERENCE})


@pytest.mark.long
def test_a_file_is_found_next_to_the_campaign_and_by_whoever_resumes_it(wave, tmp_path):
    campaign = of({"normal_traction": "wave.npy"}, grid={"hurst": [0.3, 0.8]})
    (tmp_path / "tractions.yaml").write_text(yaml.safe_dump(campaign))
    for command in (["check"], ["plan", "--pilot=0"]):
        assert gfmd(*command, tmp_path / "tractions.yaml").exit_code == 0
    done = gfmd("run", tmp_path / "tractions.yaml", "-o", tmp_path / "out", "--workers", "0")
    assert done.exit_code == 0, done.output
    whole = gfmd_numba.open_campaign(tmp_path / "out")
    assert gfmd("collect", tmp_path / "out").exit_code == 0
    again = gfmd_numba.open_campaign(tmp_path / "out")
    assert again.attrs["content_sha256"] == whole.attrs["content_sha256"]


def test_tractions_are_part_of_the_identity(wave):
    assert plan(of(wave)).problems[0].identity != plan(of({"normal_traction": 0.0})).problems[0].identity


@pytest.mark.long
def test_a_number_acts_on_every_grid(tmp_path):
    """A uniform tangential traction carries the whole slab along x, which no wall without friction notices."""
    limits = {"limits": {"eps_c": [1 / 2, 1 / 8]}}
    pulled = gfmd_numba.run(of({"tangential_traction": 1e-3}, **limits), tmp_path / "pulled", workers=0)
    free = gfmd_numba.run(of({"tangential_traction": 0.0}, **limits), tmp_path / "free", workers=0)
    np.testing.assert_allclose(pulled["kappa"], free["kappa"], rtol=1e-6)


@pytest.mark.parametrize(
    ("boundary", "changes", "said"),
    [
        (
            None,
            {"limits": {"eps_c": [1 / 8]}},
            r"normal_traction: you gave wave.npy \(256 values\); gfmd allows .* 512 nodes",
        ),
        (
            {"normal_traction": 1.0},
            {},
            r"boundary.normal_traction: you gave a mean of 1; gfmd allows a mean of 0, as loading",
        ),
        (
            {"normal_traction": "nowhere.npy"},
            {},
            r"boundary.normal_traction: you gave 'nowhere.npy'; gfmd allows an existing file",
        ),
        (
            {"normal_displacement": 0.0},
            {},
            "boundary.normal_displacement: you gave 0.*; gfmd allows only tractions with",
        ),
    ],
)
def test_what_cannot_be_prescribed_in_every_case_is_refused(wave, boundary, changes, said):
    with pytest.raises(InputError, match=said):
        plan(of(boundary or wave, **changes))


def test_what_accuracy_costs_is_not_studied_with_tractions_known_at_nodes_alone(wave):
    with pytest.raises(InputError, match=r"boundary.normal_traction: .*numbers for `gfmd accuracy`, as"):
        next(studies(plan(of(wave))))


def test_errors_under_a_uniform_pull_along_a_slab_are_those_without_it():
    """Without friction it moves the whole surface sideways."""
    pulled, alone = (
        [point.error for point in study_of(plan(campaign), 2).discretisation("eps_f")]
        for campaign in (of({"tangential_traction": 0.01}), of({}) | {"scene": SCENE})
    )
    assert len(pulled) == 5
    assert pulled == pytest.approx(alone, abs=1e-6)
