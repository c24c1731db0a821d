"""A law that the grid does not resolve is told by `check`, `solve` and `run`, and in their files."""

import warnings

import numpy as np
import pytest
import yaml

import gfmd_numba
from gfmd_numba.contact.relative_softening import NAME
from support.command_line import gfmd, unfolded

pytestmark = pytest.mark.usefixtures("undrawn")

AMPLITUDE, WORK, RANGE = 0.1, 6e-3, 2e-3
ADHESIVE = {"work_of_adhesion": WORK, "range": RANGE}


def scene(points, tmp_path, **interface):
    np.save(tmp_path / "wave.npy", AMPLITUDE * np.cos(2 * np.pi * np.arange(points) / points))
    file = {
        "scene": {
            "body": {"poissons_ratio": 0.3, "aspect_ratio": 1},
            "roughness": {"method": "measured", "file": "wave.npy"},
            "interface": {"hard_wall": {}} | interface,
            "loading": {"displacement": 0.0},
        }
    }
    path = tmp_path / "wave.yaml"
    path.write_text(yaml.safe_dump(file))
    return path


@pytest.mark.filterwarnings("ignore:an rms gradient of 0.444")  # of a wave for Johnson's closed form
def test_an_unresolved_law_is_told_by_check_solve_and_file(tmp_path):
    path = scene(1024, tmp_path, exponential=ADHESIVE)
    expected = "the grid does not resolve the interaction law: it softens 0.933 times as fast as the shortest wave"
    checked = gfmd("check", path)
    assert checked.exit_code == 0
    assert expected in unfolded(checked.stderr)
    assert "at least 4776 points" in unfolded(checked.stderr)
    solved = gfmd("solve", path, "-o", tmp_path / "out.nc")
    assert solved.exit_code == 0
    assert expected in unfolded(solved.stderr)
    with pytest.warns(UserWarning, match=expected):
        dataset = gfmd_numba.solve(path)
    assert expected in dataset.validity
    assert float(dataset[NAME]) == pytest.approx(WORK / RANGE**2 / (np.pi * 1024 / 2), rel=1e-4)
    assert dataset[NAME].units == "1"


def test_a_law_that_softens_faster_than_any_wave_stiffens_is_refused_with_the_shortest_range(tmp_path):
    path = scene(512, tmp_path, exponential=ADHESIVE)
    for command in (["check"], ["solve", "-o", tmp_path / "out.nc"]):
        refused = gfmd(command[0], path, *command[1:])
        assert refused.exit_code == 2
        assert "scene.interface.exponential.range: you gave 0.002; gfmd allows at least 0.00273" in unfolded(
            refused.stderr
        )
        assert "at least 4776 points" in unfolded(refused.stderr)
    with warnings.catch_warnings(action="ignore"):
        gfmd_numba.solve(scene(512, tmp_path, exponential=ADHESIVE | {"range": 0.00274}))


def test_a_resolved_law_is_solved_without_a_word(tmp_path):
    path = scene(512, tmp_path, exponential={"work_of_adhesion": 6e-4, "range": RANGE})
    with warnings.catch_warnings(action="error"):
        warnings.filterwarnings("ignore", "an rms gradient of 0.444")  # of a wave for Johnson's closed form
        assert "resolve" not in gfmd_numba.solve(path).validity
    assert "resolve" not in gfmd("check", path).stderr


def test_a_random_surface_is_told_its_eps_c(tmp_path):
    path = scene(
        512, tmp_path, cohesive={"work_of_adhesion": 0.01, "normal_length": RANGE, "tangential_length": 3 * RANGE}
    )
    file = yaml.safe_load(path.read_text())
    file["scene"]["roughness"] = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1}
    file["discretisation"] = {"eps_c": "1/4", "eps_f": "1/64", "eps_t": 1}
    path.write_text(yaml.safe_dump(file).replace("'", ""))
    told = unfolded(gfmd("check", path).stderr)
    assert "law: it softens 0.421 times as fast" in told
    assert "eps_c = 1/9 (nx = 1152)" in told


CAMPAIGN = """
name: adhesive
seed: 1
realisations: 1
scene:
  body: {poissons_ratio: 0.3}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.1}
  interface: {hard_wall: {}, exponential: {work_of_adhesion: 0.05, range: 0.0625}}
  loading: {reduced_pressure: 0.5}
reference: {eps_c: 1/8, eps_f: 1/8, eps_t: 1}
limits: {eps_c: [1]}
numerics: {residual: 1.0e-6}
"""


@pytest.mark.long
def test_a_campaign_says_how_many_of_its_cases_do_not_resolve_the_law(tmp_path):
    path = tmp_path / "adhesive.yaml"
    path.write_text(CAMPAIGN)
    expected = "in 1 of 2 cases the grid does not resolve the interaction law: it softens 0.509 times as fast"
    assert expected in unfolded(gfmd("check", path).stderr)
    done = gfmd("run", path, "-o", tmp_path / "out", "--workers=0")
    assert expected in unfolded(done.stderr)
    collected = gfmd_numba.open_campaign(tmp_path / "out")
    assert expected in collected.validity
    np.testing.assert_allclose(collected[NAME], [0.06366, 0.5093], rtol=1e-3)


def test_a_campaign_refuses_the_range_that_no_case_may_have(tmp_path):
    path = tmp_path / "adhesive.yaml"
    path.write_text(CAMPAIGN.replace("reference:", "grid: {interaction_range: [0.0625, 0.01]}\nreference:"))
    for command in ("check", "plan", "run"):
        refused = gfmd(command, path)
        assert refused.exit_code == 2
        assert "grid.interaction_range[1]: you gave 0.01; gfmd allows at least 0.0446" in unfolded(refused.stderr)
