"""Looking at a campaign while it runs and afterwards: status, collect, verify, and running parts of it."""

import json
import shlex
import shutil

import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.campaign import execution, failures, provenance, shards
from gfmd_numba.campaign.failures import Ending
from gfmd_numba.campaign.output_directory import claimed
from gfmd_numba.campaign.plan import plan
from gfmd_numba.storage import json_file
from gfmd_numba.storage.atomic_file import write_dataset
from support.campaigns import TINY, campaign, numbers
from support.command_line import gfmd, unfolded

pytestmark = pytest.mark.usefixtures("undrawn")
TWO = {"limits:": "#"}  # cases


@pytest.fixture(scope="module")
def left(tmp_path_factory):
    folder = tmp_path_factory.mktemp("left")
    gfmd_numba.run(campaign(folder, **TWO), folder / "out", 0)
    json_file.write(folder / "out" / "rounds.json", {"of": "another version"})
    return folder


@pytest.fixture
def ran(left, tmp_path):
    return shutil.copytree(left, tmp_path / "copy") / "out"


@pytest.mark.long
def test_parts_of_a_campaign_add_up_to_the_whole(left, tmp_path):
    path, out, whole = campaign(tmp_path, **TWO), tmp_path / "out", gfmd_numba.open_campaign(left / "out")
    ran = gfmd("run", path, "-o", out, "--workers=0", "--only=hurst=0.3", "--limit=1")
    assert ran.exit_code == 0, ran.output
    assert "6 of the 12 simulations of the whole campaign have not run yet: a run without --only" in unfolded(
        ran.output
    )
    part = gfmd_numba.open_campaign(out)
    done = part["status"].values == 0
    assert part["hurst"].values[done.all(axis=1)].tolist() == [0.3]
    assert (part["status"].values[~done] == Ending.unfinished).all()
    assert json.loads(gfmd("status", out, "--json").output)["done"] == 1
    assert "1 of 2 blocks done; not running" in gfmd("status", out).output
    assert gfmd("run", path, "-o", out, "--workers=0").exit_code == 0
    xr.testing.assert_identical(numbers(gfmd_numba.open_campaign(out)), numbers(whole))
    assert gfmd_numba.open_campaign(out).attrs["content_sha256"] == whole.attrs["content_sha256"]
    assert "2 of 2 blocks done; finished" in gfmd("status", out).output


@pytest.mark.parametrize(
    ("only", "said"),
    [
        ("hirst=0.3", "--only: you gave hirst; gfmd allows case_id, limit"),
        ("hurst=0.4", "--only: you gave hurst=0.4; gfmd allows a value of the campaign, like 0.3, 0.8"),
        ("hurst", "a coordinate and its value, like hurst=0.8"),
        ("hurst=0.3 --only hurst=0.8", "and another value of hurst; gfmd allows one value of each name"),
    ],
)
def test_a_part_that_is_not_there_is_refused(tmp_path, only, said):
    ran = gfmd("run", campaign(tmp_path), "-o", tmp_path / "out", "--only", *only.split())
    assert ran.exit_code == 2
    assert said in " ".join(ran.output.split())
    assert not (tmp_path / "out").exists()


@pytest.mark.long
def test_a_failed_block_is_left_alone_until_it_is_to_be_tried_again(finished, tmp_path, monkeypatch):
    path, out = campaign(tmp_path), tmp_path / "it's p_a;touch X"
    bad = next(plan(path).blocks)
    solve, calls = execution.measured, []

    def fails(problem, realisations):
        if problem.identity == bad.problem.identity and problem.surface.nx == bad.problem.surface.nx:
            calls.append(problem)
            raise FloatingPointError("boom")
        return solve(problem, realisations)

    monkeypatch.setattr(execution, "measured", fails)
    for _ in range(2):
        ran = gfmd("run", path, "-o", out, "--workers=0")
        assert ran.exit_code == 3
        assert f"block {bad.name} crashed: FloatingPointError: boom" in unfolded(ran.output)
    assert len(calls) == 1
    assert "FloatingPointError: boom" in gfmd_numba.open_campaign(out).attrs["failures"]
    state = gfmd("status", out).output.replace("\\\n", "")  # a long command is folded
    assert "9 of 10 blocks done, 1 failed" in state
    monkeypatch.undo()
    command = next(line for line in state.splitlines() if "--retry-failed" in line)
    assert "'" in command
    command = shlex.split(command)
    assert command[0] == "gfmd"
    assert gfmd(*command[1:]).exit_code == 0
    assert failures.of(out, bad.name) is None
    xr.testing.assert_identical(numbers(gfmd_numba.open_campaign(out)), numbers(finished))


def test_fail_fast_stops_at_the_first_failure(tmp_path, monkeypatch):
    def fails(*_):
        raise FloatingPointError("boom")

    monkeypatch.setattr(execution, "measured", fails)
    monkeypatch.setattr("gfmd_numba.campaign.run.compile_kernels", lambda problems: None)
    out = tmp_path / "out"
    ran = gfmd("run", campaign(tmp_path), "-o", out, "--workers=0", "--fail-fast")
    assert ran.exit_code == 3
    assert len(json.loads(gfmd("status", out, "--json").output)["failed"]) <= 2  # those of one task


def test_results_are_collected_at_any_time(ran):
    (ran / "small.nc").unlink()
    next(ran.glob("shards/*.shard")).unlink()
    assert gfmd("collect", ran).exit_code == 0
    assert (gfmd_numba.open_campaign(ran)["status"].values == Ending.unfinished).sum() == 6


def test_verify_finds_what_was_altered(tmp_path):
    path, out = campaign(tmp_path, **{"[0.3, 0.8]": "[0.8]"}), tmp_path / "out"
    dataset = gfmd_numba.run(path, out)
    sound = gfmd("verify", out)
    assert sound.exit_code == 0
    assert "5 sound, 0 damaged, 0 missing" in sound.output
    shard, other, gone, *_ = sorted(out.glob("shards/*.shard"))
    shard.write_bytes(shard.read_bytes()[:-1])
    other.rename(other.with_name("foreign.shard"))
    gone.unlink()
    dataset["kappa"][0, 0] += 1e-12
    (out / "small.nc").unlink()
    write_dataset(out / "small.nc", dataset)
    ran = gfmd("verify", out)
    assert ran.exit_code == 3
    assert "2 sound, 1 damaged, 2 missing" in ran.output
    assert f"damaged  {shard.stem}" in ran.output
    assert "foreign  foreign:" in ran.output
    assert "small.nc, differs from its digest" in unfolded(ran.output)


def flipped(file):
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


def cut(file):
    file.write_bytes(file.read_bytes()[:-1])


def another(file):
    file.write_text("precious")


NOTED = {"small.nc": "`gfmd collect", "run.json": "it is not used", "rounds.json": "it is not used"}


@pytest.mark.parametrize(
    ("name", "damage"),
    [
        (".gfmd-campaign", flipped),
        ("small.nc", flipped),
        pytest.param("rounds.json", flipped, marks=pytest.mark.long),
        pytest.param(".gfmd-campaign", cut, marks=pytest.mark.long),
        pytest.param("small.nc", another, marks=pytest.mark.long),
    ],
)
def test_verify_finds_whatever_file_is_not_as_it_was_left(ran, name, damage):
    """One flipped bit of the mark locked its owner out, and `verify` called all sound."""
    out = ran
    before = (out / name).read_bytes()
    assert gfmd("verify", out).exit_code == 0
    damage(out / name)
    damaged = (out / name).read_bytes()
    said = gfmd("verify", out)
    assert said.exit_code == 3
    assert name in said.output
    if name in NOTED:
        assert NOTED[name] in unfolded(said.output)
        assert "2 sound, 0 damaged, 0 missing" in said.output
    ran_again = gfmd("run", out.parent / "campaign.yaml", "-o", out, "--workers=0")
    assert ran_again.exit_code == (0 if name == "rounds.json" else 2), ran_again.output
    assert (out / name).read_bytes() == damaged
    (out / name).rename(out.parent / "away")
    if name == ".gfmd-campaign":
        assert gfmd("verify", out).exit_code == 2  # it is no output directory now, until a run makes it one
        assert gfmd("run", out / "campaign.yaml", "-o", out, "--workers=0", "--limit=1").exit_code in (0, 3)
        assert gfmd("verify", out).exit_code == 0
    (out / name).write_bytes(before)
    assert gfmd("verify", out).exit_code == 0


def test_the_status_of_a_running_campaign_is_shown(ran):
    shard, gone = ran.glob("shards/*.shard")
    gone.unlink()
    with claimed(ran, "small", (ran / "campaign.yaml").read_text()):
        shard.touch()
        assert "1 of 2 blocks done; running, about" in gfmd("status", ran).output


@pytest.mark.parametrize("command", ["status", "collect", "verify"])
def test_a_directory_of_no_campaign_is_refused(tmp_path, command):
    ran = gfmd(command, tmp_path)
    assert ran.exit_code == 2
    assert "you gave a directory without .gfmd-campaign; gfmd allows one that `gfmd run` made" in ran.output


@pytest.mark.long
def test_results_of_two_versions_say_so_and_a_run_warns(tmp_path, monkeypatch):
    """The version of the last part of a run stood for all of it."""
    path, out = campaign(tmp_path, TINY + "grid: {hurst: [0.3, 0.8]}\n"), tmp_path / "out"
    first = gfmd("run", path, "-o", out, "--workers=0", "--limit=1")
    assert "different versions" not in unfolded(first.output)
    now = dict(provenance.versions_of_numbers())
    monkeypatch.setattr(shards, "versions_of_numbers", lambda: now | {"numba": "0.0.1", "gfmd-numba": "0.0.1"})
    said = gfmd("run", path, "-o", out, "--workers=0")
    assert said.exit_code == 0
    warning = f"gfmd: parts of these results were computed with different versions (numba 0.0.1 and {now['numba']})"
    assert warning in unfolded(said.stderr)
    assert warning in unfolded(gfmd("collect", out).stderr)
    results = gfmd_numba.open_campaign(out)
    written = json.loads(results.attrs["versions"])
    assert written["numba"] == f"0.0.1 and {now['numba']}"
    assert written["gfmd-numba"] == f"0.0.1 and {now['gfmd-numba']}"
    assert written["numpy"] == now["numpy"]
    assert {"fftw", "python", "llvmlite", "xarray"} <= written.keys()
    assert "different versions" in results.attrs["validity"]


def test_results_are_of_the_versions_of_their_blocks_not_of_those_that_collect_them(ran, monkeypatch):
    before = json.loads(gfmd_numba.open_campaign(ran).attrs["versions"])
    monkeypatch.setattr(provenance, "version", lambda name: "9")
    provenance.versions_of_numbers.cache_clear()
    try:
        assert "different versions" not in unfolded(gfmd("collect", ran).stderr)
    finally:
        provenance.versions_of_numbers.cache_clear()
    after = json.loads(gfmd_numba.open_campaign(ran).attrs["versions"])
    assert after["numpy"] == before["numpy"] != after["xarray"] == "9"


def test_the_file_says_where_it_comes_from(finished):
    attributes = finished.attrs
    assert {"campaign_sha256", "versions", "git_commit", "machine", "threads", "fft_plans"} <= attributes.keys()
    assert 0 < attributes["predicted_cpu_seconds_p50"] <= attributes["predicted_cpu_seconds_p90"]
    assert attributes["cpu_seconds"] == pytest.approx(float(finished["case_seconds"].sum()))
    assert attributes["cpu_seconds"] > 0
