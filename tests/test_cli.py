"""The command line as a user meets it: what it prints, writes and returns."""

import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr
from click.testing import CliRunner
from test_campaign import SMALL, campaign

from gfmd_numba.campaign.run import run as run_campaign
from gfmd_numba.cli import main

CAMPAIGNS = Path(__file__).parent.parent / "campaigns"
SCENE = """
scene:
  length: 1e-4
  body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: 1/2}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
discretisation: {eps_c: 1/4, eps_f: 1/16, eps_t: 1/2}
"""


def gfmd(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments], catch_exceptions=False)


def test_help_and_check_import_nothing_of_weight(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE)
    script = (
        "import sys; from gfmd_numba.cli import main\n"
        "try: main(sys.argv[1:])\n"
        "finally: print([m for m in ('numpy', 'numba', 'dask', 'xarray', 'scipy') if m in sys.modules])"
    )
    for arguments in (["--help"], ["check", str(campaign(tmp_path))], ["check", str(scene)]):
        done = subprocess.run([sys.executable, "-c", script, *arguments], capture_output=True, text=True, check=True)
        assert done.stdout.endswith("[]\n")


def test_check_tells_campaigns_from_scenes(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE)
    assert gfmd("check", scene).output == f"{scene}: a scene\n"
    path = campaign(tmp_path)
    assert gfmd("check", path).output == f"{path}: a campaign of 10 cases x 6 realisations\n"


def test_bad_input_exits_with_2_and_names_the_place(tmp_path):
    path = campaign(tmp_path, **{"hurst: 0.8": "hurts: 0.8"})
    for command in (["check", path], ["plan", path], ["run", path]):
        done = gfmd(*command)
        assert done.exit_code == 2
        assert f"{path}:7:28" in done.stderr
        assert "did you mean 'hurst'" in done.stderr
    assert list(tmp_path.iterdir()) == [path]


def test_plan_counts_cases_and_distinct_problems(tmp_path):
    path = campaign(tmp_path, **{"hurst: [0.3, 0.8]": "poissons_ratio: [0.2, 0.33]"})
    output = gfmd("plan", path).output
    assert "10, of which 5 distinct problems" in output
    assert "nx = 512" in output
    assert "Poisson's ratio" in output


def test_run_fit_plot(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = campaign(tmp_path)
    done = gfmd("run", path, "--workers=0")
    assert done.exit_code == 0
    assert "results  small/small.nc" in done.output
    assert (tmp_path / "small" / "small.png").stat().st_size > 10_000
    assert xr.open_dataset(tmp_path / "small" / "small.nc").sizes["case"] == 10
    again = gfmd("run", path, "--workers=0")
    assert "tasks" not in again.stderr  # nothing was left to do
    done = gfmd("fit", "small", "--fixed", "eps_c=1", "--fixed", "eps_f=0.5:1", "-o", "fit.nc")
    assert done.exit_code == 0
    fitted = xr.open_dataset(tmp_path / "fit.nc")
    assert (fitted["fit_status"] == "ok").all()
    assert f"{float(fitted['kappa_tfc'][0]):.3f}" in done.output
    done = gfmd("plot", "small/small.nc", "-o", "picture.png", "--variable", "kappa_counted")
    assert done.exit_code == 0
    assert (tmp_path / "picture.png").stat().st_size > 10_000


def test_a_campaign_without_limits_runs_without_a_fit(tmp_path):
    text = "\n".join(line for line in SMALL.splitlines() if not line.startswith("limits"))
    done = gfmd("run", campaign(tmp_path, text), "-o", tmp_path / "out", "--workers=0")
    assert done.exit_code == 0
    assert "exponent" not in done.output


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    return run_campaign(campaign(folder), folder / "out", workers=0)[0]


@pytest.mark.parametrize("option", ["eps_c", "eps_c=one", "eps_c=1:two"])
def test_malformed_exponent(results, option):
    done = gfmd("fit", results, "--fixed", option)
    assert done.exit_code == 2
    assert "give it like eps_t=1" in done.stderr


def test_runs_that_do_not_converge_exit_with_3(tmp_path):
    path = campaign(tmp_path, **{"grid:": "numerics: {max_iterations: 10}\ngrid:"})
    done = gfmd("run", path, "-o", tmp_path / "out", "--workers=0")
    assert done.exit_code == 3
    assert "60 of 60 simulations are not ok" in done.stderr


def test_solve_writes_fields_and_scalars(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE)
    done = gfmd("solve", scene, "-o", tmp_path / "out.nc")
    assert done.exit_code == 0
    result = xr.open_dataset(tmp_path / "out.nc")
    assert result.sizes == {"x": 256}
    assert {"height", "pressure", "displacement", "gap", "kappa", "status"} <= set(result.data_vars)
    assert gfmd("plot", tmp_path / "out.nc").exit_code == 0
    assert (tmp_path / "out.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("name", "content", "given"),
    [
        ("flat.csv", "1\n1\n1\n1\n", "rms gradient of 0"),
        ("nan.csv", "1\n2\nnan\n4\n", "height nan at index 2"),
        ("short.csv", "1\n2\n", "2 heights"),
        ("columns.csv", "0,1\n1,2\n2,1\n3,0\n", "2 columns"),
        ("words.csv", "one\ntwo\nthree\nfour\n", "could not convert string 'one'"),
        ("empty.csv", "", "0 heights"),
        ("broken.npy", "no array", "no .npy array"),
        ("broken.nc", "no dataset", "no netCDF file"),
    ],
)
def test_unusable_profile(tmp_path, name, content, given):
    (tmp_path / name).write_text(content)
    scene = tmp_path / "scene.yaml"
    text = SCENE.replace("{method: psd, hurst: 0.8, rms_gradient: 0.01}", f"{{method: measured, file: {name}}}")
    scene.write_text(text.partition("discretisation")[0])
    done = gfmd("solve", scene, "-o", tmp_path / "out.nc")
    assert done.exit_code == 2
    assert f"{scene}:5:39: scene.roughness.file: given {name} (" in done.stderr
    assert given in done.stderr
    assert "allowed: at least 4 equidistant finite heights" in done.stderr


@pytest.mark.parametrize("path", sorted(CAMPAIGNS.glob("*.yaml")), ids=lambda path: path.name)
def test_shipped_campaigns_check(path):
    assert gfmd("check", path).exit_code == 0
