"""The command line as a user meets it: what it prints, writes and returns."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr
from click.testing import CliRunner
from folded import unfolded
from test_campaign import SMALL, campaign

import gfmd_numba
from gfmd_numba.campaign.execution import Workers
from gfmd_numba.campaign.run import run as run_campaign
from gfmd_numba.cli import main
from gfmd_numba.solvers import integrators

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


@pytest.mark.parametrize("realisations", [1, 6])
def test_a_campaign_without_limits_prints_its_means(tmp_path, realisations):
    text = "\n".join(line for line in SMALL.splitlines() if not line.startswith("limits"))
    path = campaign(tmp_path, text, **{"realisations: 6": f"realisations: {realisations}"})
    done = gfmd("run", path, "-o", tmp_path / "out", "--workers=0")
    assert done.exit_code == 0
    assert "exponent" not in done.output
    kappa = xr.open_dataset(tmp_path / "out" / "small.nc")["kappa"]
    assert "nu = 0.33, a = inf, p* = 0.05, eps_c = 0.25, eps_f = 0.0625, eps_t = 0.5\n" in done.output
    rows = [line.split() for line in done.output.splitlines() if line.startswith("0.")]
    assert [row[0] for row in rows] == ["0.3", "0.8"]
    found = [row[1].partition("±") for row in rows]
    assert [mean for mean, _, _ in found] == [f"{mean:.3f}" for mean in kappa.mean("realisation").values]
    assert all((error != "") == (realisations > 1) for _, _, error in found)
    assert "nan" not in done.output
    message = refused("plot", tmp_path / "out", "-o", tmp_path / "out.png")
    assert "small.nc: given results in which no discretisation is varied; allowed: " in message


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    return run_campaign(campaign(folder), folder / "out", Workers(0))[0]


@pytest.mark.parametrize(
    "option",
    ["eps_c", "eps_c=one", "eps_c=1:two", "eps_c=1:", "eps_x=1", "eps_c=nan", "eps_c=-1", "eps_c=2:1", "eps_c=.inf"],
)
def test_malformed_exponent(results, option):
    message = refused("fit", results, "--fixed", option)
    assert "'--fixed'" in message
    assert f"given {option!r}; allowed: eps_c, eps_f, eps_t with a number above 0 or a range, like eps_t=1" in message


def test_runs_that_do_not_converge_exit_with_3(tmp_path):
    path = campaign(tmp_path, **{"grid:": "numerics: {max_iterations: 1}\ngrid:"})
    done = gfmd("run", path, "-o", tmp_path / "out", "--workers=0")
    assert done.exit_code == 3
    assert "60 of 60 simulations are not ok" in done.stderr


def test_a_campaign_says_how_many_runs_are_unstable(tmp_path, monkeypatch):
    path = campaign(tmp_path, **{"grid:": "numerics: {solver: verlet}\ngrid:"})
    limit = integrators.stability_limit
    monkeypatch.setattr(integrators, "stability_limit", lambda *modes: 1.1 * limit(*modes))
    done = gfmd("run", path, "-o", tmp_path / "out", "--workers=0")
    assert done.exit_code == 3
    least = int(gfmd_numba.open_campaign(tmp_path / "out")["n_iterations"].min())
    assert (
        f"60 are unstable, the first after {least} iterations. Tractions grew without bound: lower numerics"
        in unfolded(done.stderr)
    )


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
        ("zeros.csv", b"0\n1\n0\0\n2\n", "a zero byte at byte 5: no text"),
        ("flat.csv", "z [um]\n1\n1\n1\n1\n", "rms gradient of 0"),
        ("nan.csv", "z [um]\n1\n2\nnan\n4\n", "height nan at index 2"),
        ("short.csv", "1\n2\n", "2 heights, not at least 4"),
        ("columns.csv", "0,1\n1,2\n2,1\n3,0\n", "positions along x and heights without a unit"),
        ("words.csv", "one\ntwo\nthree\nfour\n", "no row of numbers, but 'one'"),
        ("empty.csv", "", "no number"),
        ("broken.npy", "no array", "no .npy array"),
        ("broken.nc", "no dataset", "no netCDF file"),
    ],
)
def test_unusable_profile(tmp_path, name, content, given):
    (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
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


def refused(*arguments):
    """The one line that a command says before it exits with 2, without a traceback."""
    done = gfmd(*arguments)
    assert done.exit_code == 2, done.output
    assert "Traceback" not in done.stderr
    return done.stderr.strip().splitlines()[-1]


@pytest.fixture(scope="module")
def contact(tmp_path_factory):
    folder = tmp_path_factory.mktemp("contact")
    (folder / "scene.yaml").write_text(SCENE)
    assert gfmd("solve", folder / "scene.yaml", "-o", folder / "contact.nc").exit_code == 0
    return folder / "contact.nc"


@pytest.mark.parametrize("command", ["fit", "plot"])
@pytest.mark.parametrize("content", ["", "name: text\n"])
def test_files_that_are_no_results(tmp_path, command, content):
    for name in ("results.nc", "results.yaml"):
        (tmp_path / name).write_text(content)
        message = refused(command, tmp_path / name, "-o", tmp_path / "out.png")
        assert f"{tmp_path / name}: given a file that is not netCDF" in message
        assert "; allowed: a netCDF file that gfmd has written" in message


def test_results_of_another_kind(tmp_path, results, contact):
    assert gfmd("fit", results, "--fixed=eps_c=1", "--fixed=eps_f=1/2:1", "-o", tmp_path / "fit.nc").exit_code == 0
    for command in ("fit", "plot"):
        message = refused(command, tmp_path / "fit.nc", "-o", tmp_path / "out.png")
        assert message.startswith(f"gfmd: {tmp_path / 'fit.nc'}: given no campaign's results; allowed: ")
    assert refused("fit", contact).startswith(f"gfmd: {contact}: given no campaign's results; allowed: ")
    xr.open_dataset(contact).drop_vars("gap").to_netcdf(tmp_path / "nogap.nc")
    assert f"{tmp_path / 'nogap.nc'}: given no results of a contact" in refused("plot", tmp_path / "nogap.nc")
    xr.Dataset().to_netcdf(tmp_path / "empty.nc")
    for command in ("fit", "plot"):
        assert f"{tmp_path / 'empty.nc'}: given no campaign's results" in refused(command, tmp_path / "empty.nc")


def test_unknown_variable_and_picture(tmp_path, results):
    assert "'kapa' is not one of 'kappa', 'kappa_counted', 'kappa_r'" in refused("fit", results, "--variable=kapa")
    message = refused("plot", results, "-o", tmp_path / "picture.doc")
    assert f"given {tmp_path / 'picture.doc'}; allowed: a picture ending in" in message


def test_inputs_are_not_overwritten(tmp_path, results):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE.replace("{method: psd, hurst: 0.8, rms_gradient: 0.01}", "{method: measured, file: p.csv}"))
    scene.write_text(scene.read_text().partition("discretisation")[0])
    (tmp_path / "p.csv").write_text("0\n1\n0\n2\n")
    before = {file: file.read_bytes() for file in (scene, tmp_path / "p.csv", results)}
    assert f"--output: given {scene}, which is an input; allowed: another file" in refused("solve", scene, "-o", scene)
    assert "p.csv, which is an input" in refused("solve", scene, "-o", tmp_path / "p.csv")
    assert "which is an input" in refused("fit", results.parent, "-o", results)
    assert "which is an input" in refused("plot", results, "-o", results.parent / "campaign.yaml")
    assert {file: file.read_bytes() for file in before} == before


def test_an_output_that_cannot_be_written_is_told_before_solving(tmp_path, monkeypatch):
    (tmp_path / "scene.yaml").write_text(SCENE)
    monkeypatch.setattr("gfmd_numba.solve", None)
    message = refused("solve", tmp_path / "scene.yaml", "-o", tmp_path / "no" / "out.nc")
    assert f"allowed: a file in an existing folder, unlike {tmp_path / 'no'}" in message
    monkeypatch.setattr("os.access", lambda path, mode: mode != os.W_OK)
    assert "may not be written" in refused("solve", tmp_path / "scene.yaml", "-o", tmp_path / "out.nc")


def test_fit_prints_each_groups_own_reference_and_each_reason_once(results):
    done = gfmd("fit", results.parent, "--fixed", "eps_c=1", "--fixed", "eps_f=1")
    dataset = xr.open_dataset(results)
    kappa = dataset["kappa"].isel(case=dataset["is_reference"].values)
    for row, mean, error in zip(
        (line for line in done.output.splitlines() if line.startswith("0.")),
        kappa.mean("realisation").values,
        (kappa.std("realisation", ddof=1) / 6**0.5).values,
        strict=True,
    ):
        assert f"{mean:.3f}±{error:.3f}" in row
    said = gfmd("fit", results, "--fixed=eps_f=1").output.replace("\n         ", " ")  # notes are folded
    notes = [line for line in said.splitlines() if line.startswith("note")]
    assert len(notes) == len(set(notes)) < 6
    assert sum("--fixed eps_" in note and "fit: {fixed: {" in note for note in notes) == 1


def test_notes_name_the_group_and_the_case(tmp_path, results):
    dataset = xr.open_dataset(results).load()
    dataset["kappa"][1] = float("nan")
    dataset.to_netcdf(tmp_path / "broken.nc")
    done = gfmd("fit", tmp_path / "broken.nc", "--fixed", "eps_c=1", "--fixed", "eps_f=1")
    assert "H = 0.3: left out, no good realisation: eps_c = 1/2, eps_f = 1/16, eps_t = 1/2" in unfolded(done.output)


def test_picture_of_a_directory_is_named_like_that_of_a_run(results):
    assert gfmd("plot", results.parent, "--fixed=eps_c=1", "--fixed=eps_f=1").exit_code == 0
    assert (results.parent / "small.png").exists()


def test_a_prescribed_displacement_has_no_pressure_in_the_table_but_a_picture(tmp_path):
    changes = {
        "{reduced_pressure: 0.05}": "{displacement: 1e-4}",
        "0.33}": "0.33, aspect_ratio: 0.5}",
        "grid:": "fit: {fixed: {eps_c: 1, eps_f: 1}}\ngrid:",
    }
    done = gfmd("run", campaign(tmp_path, **changes), "-o", tmp_path / "out", "--workers=0")
    assert done.exit_code == 0
    assert "nan" not in done.output
    assert (tmp_path / "out" / "small.png").stat().st_size > 10_000


def test_solve_follows_a_path(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE + "path: [{reduced_pressure: 0.1}, {reduced_pressure: 0.05}]\n")
    done = gfmd("solve", scene, "-o", tmp_path / "out.nc")
    assert done.exit_code == 0
    result = xr.load_dataset(tmp_path / "out.nc")
    assert result.sizes == {"step": 3, "x": 256}
    assert result["reduced_pressure"].values.tolist() == [0.05, 0.1, 0.05]
    kappa = [f"{float(k):.6g}" for k in result["kappa"]]
    rows = [line.split()[:3] for line in done.output.splitlines() if re.match(r" +\d ", line)]
    assert rows == [["0", "0.05", kappa[0]], ["1", "0.1", kappa[1]], ["2", "0.05", kappa[2]]]
    assert kappa[0] == kappa[2]
    scene.write_text(SCENE + "path: [{reduced_pressure: 0.1}]\nnumerics: {max_iterations: 1}\n")
    done = gfmd("solve", scene, "-o", tmp_path / "out.nc")
    assert done.exit_code == 3
    said = unfolded(done.stderr)
    assert "not_converged after 1 iterations in step 0, not_converged after 1 iterations in step 1" in said
    assert "raise numerics.max_iterations" in said


def test_an_unstable_run_says_when_and_by_which_wave(tmp_path, monkeypatch):
    scene, out = tmp_path / "scene.yaml", tmp_path / "out.nc"
    scene.write_text(SCENE + "path: [{reduced_pressure: 0.1}]\nnumerics: {solver: verlet}\n")
    assert gfmd("solve", scene, "-o", out).exit_code == 0
    assert "growing_wave" not in xr.load_dataset(out)
    limit = integrators.stability_limit
    monkeypatch.setattr(integrators, "stability_limit", lambda *modes: 1.1 * limit(*modes))
    done = gfmd("solve", scene, "-o", out)
    assert done.exit_code == 3
    result = xr.load_dataset(out)
    steps, wave = int(result["n_iterations"][0]), int(result["growing_wave"][0])
    assert wave > 100  # of 128
    said = unfolded(done.stderr)
    assert f"unstable after {steps} iterations with wave {wave} growing in step 0" in said
    assert said.count("gfmd: Tractions grew without bound: lower numerics.time_step") == 1


def test_init_writes_a_campaign_that_can_be_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert gfmd("init").exit_code == 0
    assert "a campaign of 16 cases x 60 realisations" in gfmd("check", "campaign.yaml").output
    again = gfmd("init")
    assert again.exit_code == 2
    assert "given a file that exists; allowed: a new name" in again.output


@pytest.mark.parametrize("kind", ["campaign", "scene", "boundary", "surface"])
def test_schemas_are_json(kind):
    schema = json.loads(gfmd("schema", kind).output)
    assert schema["additionalProperties"] is False


def test_plan_says_what_is_shared_and_what_it_costs(tmp_path):
    text = SMALL.replace("grid: {", "grid: {poissons_ratio: [0.2, 0.3], aspect_ratio: [.inf, 1.5], ")
    path = tmp_path / "campaign.yaml"
    path.write_text(text)
    said = unfolded(gfmd("plan", path, "--pilot=1").output)
    assert "cases differ from another one in poissons_ratio and aspect_ratio alone" in said
    assert re.search(r"CPU time +\S+ m?s, with 90 % probability below", said)
    assert re.search(r"dropped +slab of aspect ratio 1.5, .* at most \S+, below numerics.effects = 0.0001", said)


def test_doctor_finds_a_sound_installation():
    said = gfmd("doctor")
    assert said.exit_code == 0, said.output
    assert "of Westergaard's peak pressure" in said.output
    assert "2 started" in said.output


def test_doctor_finds_a_wrong_pressure(monkeypatch):
    monkeypatch.setattr("gfmd_numba.theory.closed_forms.westergaard_pressure", lambda x, p, a: x + 1.0)
    said = gfmd("doctor")
    assert said.exit_code == 3
    assert "failed: ArithmeticError" in said.output
