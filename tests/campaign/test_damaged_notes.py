"""What a run notes next to its shards, damaged or forged, and looking at a directory that cannot be written."""

import subprocess

import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.campaign import failures
from gfmd_numba.campaign.collection import NOTED, NOTES, noted
from gfmd_numba.campaign.failures import Ending
from gfmd_numba.campaign.output_directory import at_work, claimed
from gfmd_numba.campaign.plan import plan
from gfmd_numba.storage import json_file
from gfmd_numba.storage.atomic_file import write_dataset
from support.campaigns import TINY, campaign, numbers
from support.command_line import gfmd, unfolded

FEW = ["[" * 100_000, '{"status": "ok", "reason": "all is well"}']
MORE = [
    "",
    "null",
    "\ud800",
    "[]",
    "{",
    '{"a":' * 100_000,
    '{"status": null, "reason": null}',
    '{"status": "exploded", "reason": "boom"}',
    '{"status": ["crashed"], "reason": "boom"}',
    '{"status": "crashed", "reason": {"a": 1}}',
]


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    folder = tmp_path_factory.mktemp("out")
    gfmd_numba.run(campaign(folder, TINY + "grid: {hurst: [0.3, 0.8]}\n"), folder / "out")
    return folder / "out"


def assert_kept(out, note):
    """Assert that nothing runs over a note that is not ours; take it out of the way."""
    before = note.read_bytes()
    if before:
        said = gfmd("run", out / "campaign.yaml", "-o", out, "--workers=0")
        assert said.exit_code == 2
        assert f"{note.name}: you gave a path which gfmd did not write" in unfolded(said.stderr)
        assert note.read_bytes() == before
        said = gfmd("verify", out)
        assert said.exit_code == 3
        assert f"{note.name}, a file that gfmd did not write, or that was changed since" in unfolded(said.output)
    note.unlink()


@pytest.mark.parametrize("content", FEW + MORE)
def test_a_file_without_our_mark_says_nothing(tmp_path, content):
    """Whatever it holds; the commands below meet two of these."""
    for file in (failures.path_of(tmp_path, "block"), tmp_path / NOTES):
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(content.encode("utf-8", "surrogatepass"))
    assert failures.of(tmp_path, "block") is None
    assert noted(tmp_path) == {}


@pytest.mark.long
@pytest.mark.parametrize("content", FEW[1:])
def test_a_damaged_failure_is_forgotten_and_its_block_computed(out, content):
    block = next(plan(out / "campaign.yaml").blocks)
    (out / "shards" / f"{block.name}.shard").unlink()
    (out / "shards" / f"{block.name}.failed").write_bytes(content.encode("utf-8", "surrogatepass"))
    assert failures.of(out, block.name) is None
    before = numbers(gfmd_numba.open_campaign(out))
    for command in ("status", "collect"):
        assert gfmd(command, out).exit_code == 0
    assert int((gfmd_numba.open_campaign(out)["status"] == Ending.unfinished).sum()) == 2
    note = out / "shards" / f"{block.name}.failed"
    content_of_it = note.read_bytes()
    gfmd_numba.run(out / "campaign.yaml", out)
    assert note.read_bytes() == content_of_it
    said = gfmd("verify", out)
    assert said.exit_code == (3 if content_of_it else 0)
    note.unlink()
    xr.testing.assert_identical(numbers(gfmd_numba.open_campaign(out)), before)


@pytest.mark.long
@pytest.mark.parametrize("content", FEW[:1])
def test_damaged_notes_of_a_run_stop_nothing(out, content):
    (out / "run.json").write_bytes(content.encode("utf-8", "surrogatepass"))
    assert gfmd("collect", out).exit_code == 0
    assert not {"last_run_seconds", "last_run_blocks", "status", "reason"} & gfmd_numba.open_campaign(out).attrs.keys()
    next(out.glob("shards/*.shard")).unlink()
    assert_kept(out, out / "run.json")
    assert gfmd_numba.run(out / "campaign.yaml", out).attrs["last_run_blocks"] == 1


def test_notes_of_a_run_replace_nothing_that_the_results_say(out):
    assert gfmd("collect", out).exit_code == 0
    before = gfmd_numba.open_campaign(out).attrs
    (out / "run.json").unlink(missing_ok=True)
    json_file.write(out / "run.json", dict.fromkeys(before.keys() - set(NOTED), "forged") | {"last_run_seconds": 2.5})
    assert gfmd("collect", out).exit_code == 0
    after = gfmd_numba.open_campaign(out).attrs
    assert "forged" not in map(str, after.values())
    assert after["last_run_seconds"] == 2.5
    for name in ("campaign", "versions", "fit", "title", "seed", "content_sha256"):
        assert after[name] == before[name]


@pytest.mark.long
@pytest.mark.parametrize("name", ["campaign", "fit"])
def test_verify_notices_results_that_say_something_else_of_the_campaign(out, name):
    assert gfmd("collect", out).exit_code == 0
    assert gfmd("verify", out).exit_code == 0
    dataset = gfmd_numba.open_campaign(out)
    for value in ("forged", None):
        del dataset.attrs[name]
        if value is not None:
            dataset.attrs[name] = value
        (out / "tiny.nc").unlink()
        write_dataset(out / "tiny.nc", dataset)
        said = gfmd("verify", out)
        assert said.exit_code == 3
        assert "tiny.nc, differs from its digest" in unfolded(said.output)
        dataset.attrs[name] = value
    assert gfmd("collect", out).exit_code == 0


def test_looking_at_a_run_does_not_write(out, tmp_path):
    before = {path: path.stat().st_mtime_ns for path in (out, *out.rglob("*"))}
    for command in ("status", "verify"):
        assert gfmd(command, out).exit_code == 0
    assert {path: path.stat().st_mtime_ns for path in (out, *out.rglob("*"))} == before
    (out / ".lock").chmod(0o444)
    assert not at_work(out)
    (out / ".lock").chmod(0o644)
    with claimed(out, "tiny", (out / "campaign.yaml").read_text()):
        assert at_work(out)
        assert "2 of 2 blocks done; running" in gfmd("status", out).output


def test_a_read_only_directory_can_be_looked_at(out, tmp_path):
    seen = tmp_path / "seen"
    seen.mkdir()
    for options in (["--bind", out], ["-o", "remount,ro,bind"]):
        if subprocess.run(["mount", *options, seen], capture_output=True).returncode:
            pytest.skip("only root can mount a directory")
    try:
        said = gfmd("status", seen)
        assert (said.exit_code, said.output) == (0, "tiny: 2 of 2 blocks done; finished\n")
        assert gfmd("verify", seen).exit_code == 0
        refused = gfmd("run", out / "campaign.yaml", "-o", seen, "--workers=0")
        assert refused.exit_code == 2
        assert "it may not be written" in refused.stderr
    finally:
        subprocess.run(["umount", seen], check=True)
