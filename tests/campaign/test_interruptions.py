"""Runs that are killed, interrupted, damaged or crash: no number changes, and finished work is kept."""

import os
import signal
import subprocess
import sys
import time
import uuid

import numpy as np
import psutil
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.campaign import execution
from gfmd_numba.campaign.failures import Ending, Failure
from gfmd_numba.campaign.output_directory import claimed
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.run import run as run_campaign
from gfmd_numba.campaign.shards import Finished
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.scene import InputError
from gfmd_numba.storage.atomic_file import temporary
from support.campaigns import TINY, campaign, numbers

TWO = {"limits:": "#"}  # cases, which are the references


def references(finished):
    return finished.isel(case=finished["is_reference"].values).assign_coords(case=[0, 1])


@pytest.mark.long
def test_a_killed_run_resumes_to_the_same_numbers(finished, tmp_path):
    """SIGKILL as soon as the first shards are there; what is finished is not computed again, whoever goes on."""
    path, out = campaign(tmp_path), tmp_path / "out"
    command = [sys.executable, "-m", "gfmd_numba", "run", str(path), "-o", str(out), "--workers=0"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and len(list(out.glob("shards/*.shard"))) < 3:
        time.sleep(0.01)
    process.kill()
    process.wait()
    left = {shard: shard.stat().st_mtime_ns for shard in out.glob("shards/*.shard")}
    assert len(left) >= 3
    result = gfmd_numba.run(path, out, 0)
    xr.testing.assert_identical(numbers(result), numbers(finished))
    assert {shard: shard.stat().st_mtime_ns for shard in left} == left


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="no process groups to interrupt")
@pytest.mark.parametrize(("send", "which"), [(os.killpg, signal.SIGINT), (os.kill, signal.SIGTERM)])
def test_an_interrupt_is_one_message_and_leaves_nothing_running(tmp_path, send, which):
    """Ctrl-C reaches the worker, too, at any moment after the first shard; a queue terminates the command alone."""
    path, out = campaign(tmp_path, **{"realisations: 6": "realisations: 600"}), tmp_path / "out"
    command = [sys.executable, "-m", "gfmd_numba", "run", str(path), "-o", str(out), "--workers=1"]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True, preexec_fn=_heeding
    )
    while process.poll() is None and not list(out.glob("shards/*.shard")):
        time.sleep(0.01)
    time.sleep(np.random.default_rng().uniform(0, 0.2))
    send(process.pid, which)
    said = [line for line in process.communicate()[0].decode().splitlines() if not line.startswith("busy ")]
    assert process.returncode == 130
    assert said == ["gfmd: interrupted; finished work is kept, the same command resumes"]
    finished = Finished(out)
    assert list(finished)
    assert all(finished.is_sound(name) for name in finished)
    left = [p for p in psutil.process_iter() if p.status() != psutil.STATUS_ZOMBIE and session(p) == process.pid]
    assert not psutil.wait_procs(left, timeout=5)[1]  # one that was killed takes a moment to give back its memory


def _heeding():
    """A shell's background jobs, and what they start, ignore interrupts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def session(process: psutil.Process) -> int | None:
    try:
        return os.getsid(process.pid)
    except ProcessLookupError:
        return None


@pytest.mark.long
def test_a_damaged_shard_is_computed_again(finished, tmp_path):
    path, out = campaign(tmp_path), tmp_path / "out"
    gfmd_numba.run(path, out, 0)
    first, second, third, *_ = sorted(out.glob("shards/*.shard"))
    content = first.read_bytes()
    first.write_bytes(content[:-10])
    altered = bytearray(second.read_bytes())
    altered[len(altered) // 2] ^= 1
    second.write_bytes(altered)
    third.write_bytes(b"")
    xr.testing.assert_identical(numbers(gfmd_numba.run(path, out, 0)), numbers(finished))
    assert first.read_bytes()[:13] == content[:13]
    assert all(Finished(out).is_sound(shard.stem) for shard in (first, second, third))


def test_a_crashed_task_is_named_and_leaves_the_others_alone(finished, tmp_path, monkeypatch):
    planned, finished = plan(campaign(tmp_path, **TWO)), references(finished)
    bad = next(planned.blocks)
    solve = execution.measured

    def fails_once(problem, realisations):
        if problem.identity == bad.problem.identity:
            raise FloatingPointError("boom")
        return solve(problem, realisations)

    monkeypatch.setattr(execution, "measured", fails_once)
    path, failures = run_campaign(tmp_path / "campaign.yaml", tmp_path / "out", Workers(0))
    assert failures == {bad.name: Failure("crashed", "FloatingPointError: boom")}
    result = gfmd_numba.open_campaign(path)
    crashed = result["case_id"] == bad.problem.identity
    assert (result["status"].where(crashed, drop=True) == Ending.crashed).all()
    assert result["kappa"].where(crashed, drop=True).isnull().all()
    xr.testing.assert_identical(
        numbers(result).isel(case=~crashed.values), numbers(finished).isel(case=~crashed.values)
    )


def test_leftovers_of_a_killed_run_do_not_block_it(tmp_path):
    path, out = campaign(tmp_path, **TWO), tmp_path / "out"
    out.mkdir(parents=True)
    leftovers = [temporary(out / "small.nc"), temporary(out / ".gfmd-campaign")]
    for leftover in (*leftovers, out / ".lock"):
        leftover.touch()
    leftovers[0].write_text("half of a fi")
    with claimed(out, "small", path.read_text()):
        assert not any(leftover.exists() for leftover in leftovers)
    (out / "shards").mkdir()
    leftovers += [temporary(out / "shards" / "a.shard")]
    for leftover in leftovers:
        leftover.touch()
    with claimed(out, "small", path.read_text()):
        pass
    assert not any(leftover.exists() for leftover in leftovers)


@pytest.mark.long
def test_files_that_look_like_leftovers_are_not_removed(tmp_path):
    path, out = campaign(tmp_path, TINY), tmp_path / "out"
    mine = ["notes.late.tmp", f"a.{uuid.uuid4().hex}.tmp", f".{32 * 'a'}.tmp", "notes.tmp"]
    out.mkdir()
    for name in mine:
        (out / name).write_text("precious")
        with pytest.raises(InputError, match="holds something else"):
            gfmd_numba.run(path, out, 0)
        assert (out / name).read_text() == "precious"
        (out / name).unlink()
    gfmd_numba.run(path, out, 0)
    precious = [folder / name for folder in (out, out / "shards") for name in mine]
    for file in precious:
        file.write_text("precious")
    gfmd_numba.run(path, out, 0)
    assert all(file.read_text() == "precious" for file in precious)
