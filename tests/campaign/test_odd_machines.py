"""Machines whose clock is wrong, or that have neither a home nor a compiler."""

import os
import subprocess
import sys
import time

import pytest

from gfmd_numba.campaign.run import run
from gfmd_numba.campaign.status import progress
from gfmd_numba.campaign.workers import Workers
from support.campaigns import TINY, campaign


@pytest.mark.long
@pytest.mark.parametrize("shift", [-1e9, 1e9])
def test_a_clock_set_wrong_is_no_failure(tmp_path, shift):
    """Files that seem to come from another decade; work left to do has then no honest end in sight."""
    path, out = campaign(tmp_path, TINY + "grid: {hurst: [0.3, 0.8]}\n"), tmp_path / "out"
    run(path, out, Workers(0))
    next(out.glob("shards/*.shard")).unlink()
    for file in (out / ".gfmd-campaign", *out.glob("shards/*.shard")):
        os.utime(file, (time.time() + shift,) * 2)
    found = progress(out)
    assert found.done == found.blocks - 1
    assert found.seconds_left is None or found.seconds_left >= 0.0
    run(path, out, Workers(0))
    assert progress(out).done == found.blocks


@pytest.mark.long
def test_a_campaign_runs_without_a_home_or_a_compiler(tmp_path):
    """Nor a cache that can be written: a file stands where the folders should be. Kernels run as plain Python."""
    (tmp_path / "file").touch()
    path = tmp_path / "tiny.yaml"
    path.write_text(TINY)
    nowhere = {name: str(tmp_path / "file" / "home") for name in ("HOME", "XDG_CACHE_HOME", "MPLCONFIGDIR")}
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA", "GFMD"))} | nowhere
    environment["NUMBA_DISABLE_JIT"] = "1"
    command = [sys.executable, "-m", "gfmd_numba", "run", str(path), "-o", str(tmp_path / "out"), "--workers", "0"]
    ran = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    assert "Traceback" not in ran.stderr
    assert list((tmp_path / "out").glob("*.nc"))
