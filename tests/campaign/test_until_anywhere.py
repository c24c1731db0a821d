"""A run until an error ends with the same digest whoever does its work, and whenever its process is killed."""

import os
import random
import signal
import subprocess
import sys
import time
from functools import partial

import pytest
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.cli import main
from support.campaigns import campaign

ONE = {
    "reference: {": "fit: {exponents: free, fixed: {eps_c: 2}}\nreference: {",
    "grid: {hurst: [0.3, 0.8]}": "",
}
UNTIL = "--until=kappa=1.5%"
SECONDS = 300.0  # by when a run has ended on any machine


def command(path, out, *options):
    return ["run", str(path), "-o", str(out), UNTIL, *options]


def digest(out):
    return gfmd_numba.open_campaign(out).attrs["content_sha256"]


@pytest.fixture(scope="module")
def serial(tmp_path_factory):
    """Digest of a run in this process, which takes more rounds than the pilot, and how long that takes as a process."""
    folder = tmp_path_factory.mktemp("serial")
    done = CliRunner().invoke(main, command(campaign(folder, **ONE), folder / "out", "--workers=0"))
    assert done.exit_code == 0, done.output
    assert gfmd_numba.open_campaign(folder / "out").sizes["round"] > 1
    return digest(folder / "out")


@pytest.mark.long
def test_two_workers_make_the_same_decisions_and_numbers(serial, tmp_path):
    done = CliRunner().invoke(main, command(campaign(tmp_path, **ONE), tmp_path / "out", "--workers=2"))
    assert done.exit_code == 0, done.output
    assert digest(tmp_path / "out") == serial


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_a_process_killed_at_any_time_resumes_to_the_same_digest(serial, tmp_path):
    """Twice in one campaign; `benchmarks/kill_and_resume.py until` does it twenty times."""
    rng = random.Random(0)
    path, out = campaign(tmp_path, **ONE), tmp_path / "out"
    begin = partial(
        subprocess.Popen,
        [sys.executable, "-m", "gfmd_numba", *command(path, out, "--workers=0")],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    for n_shards in (1, 4):  # new ones: the start-up of a process is no news
        process, before = begin(), len(list(out.glob("shards/*.shard")))
        late = time.monotonic() + SECONDS
        while process.poll() is None and len(list(out.glob("shards/*.shard"))) < min(before + n_shards, 8):
            assert time.monotonic() < late
            time.sleep(0.01)
        time.sleep(rng.uniform(0.0, 0.1))
        assert process.poll() is None, "it ended before it was killed"
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    last = begin()
    assert last.wait(SECONDS) == 0
    assert digest(out) == serial
