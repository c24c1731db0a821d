"""Workers of a cluster that can neither see nor write the output directory hand their blocks back."""

import os
import subprocess
import sys
import time

import pytest
import xarray as xr
from distributed import LocalCluster

import gfmd_numba
from gfmd_numba.campaign.execution import TooLongError, compute, expired_here
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.run import run as run_campaign
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.scene import InputError
from support.campaigns import campaign, numbers

FORBID = """\
import os, sys

def forbid(event, arguments):
    if any(str(given).startswith({folder!r}) for given in arguments[:2] if isinstance(given, (str, os.PathLike))):
        raise PermissionError(f"{{event}} {{arguments[:2]}}")

sys.addaudithook(forbid)
"""


@pytest.fixture
def stranger(tmp_path):
    """Address of a scheduler with a worker that works in a folder of its own and may not touch `out`."""
    preload = tmp_path / "forbid.py"
    preload.write_text(FORBID.format(folder=str(tmp_path / "out")))
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    with LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0", scheduler_kwargs={"dashboard": False}) as cluster:
        command = [sys.executable, "-m", "distributed.cli.dask_worker", cluster.scheduler_address, "--no-nanny"]
        options = ["--no-dashboard", "--nthreads=1", "--local-directory=.", f"--preload={preload}"]
        (tmp_path / "own").mkdir()
        worker = subprocess.Popen(
            [*command, *options], cwd=tmp_path / "own", env=environment, stderr=subprocess.DEVNULL
        )
        deadline = time.monotonic() + 60.0
        while not cluster.scheduler.workers:
            assert time.monotonic() < deadline
            time.sleep(0.1)
        yield cluster.scheduler_address
        worker.kill()
        worker.wait()


@pytest.mark.long
def test_a_worker_without_the_output_directory_changes_no_number(finished, tmp_path, stranger):
    path, failures = run_campaign(campaign(tmp_path), tmp_path / "out", Workers(address=stranger))
    assert failures == {}
    result = gfmd_numba.open_campaign(path)
    xr.testing.assert_identical(numbers(result), numbers(finished))
    assert result.attrs["content_sha256"] == finished.attrs["content_sha256"]


@pytest.fixture
def block(tmp_path):
    return next(iter(plan(campaign(tmp_path)).blocks))


def test_a_block_that_ended_a_process_of_this_machine_is_not_tried_again(block, tmp_path, monkeypatch):
    monkeypatch.setattr("gfmd_numba.campaign.execution.gettempdir", lambda: str(tmp_path))
    trace = tmp_path / f"gfmd-run-{block.name}.late.tmp"
    trace.write_text("Timeout!")
    measured, failures = compute((block,), "run", {}, 5.0)
    assert measured == {}
    assert failures[block.name].status == "timeout"
    assert not trace.exists()
    trace.write_text("Timeout!")
    assert expired_here("run", [block.name, "another"]) == [block.name]
    assert compute((block,), "run", {}, 60.0)[0].keys() == {block.name}


def test_a_block_that_takes_too_long_is_a_timeout(block, monkeypatch):
    def late(*_):
        raise TooLongError

    monkeypatch.setattr("gfmd_numba.campaign.execution.measured", late)
    assert compute((block,), "run", {}, 5.0)[1][block.name].status == "timeout"


def test_a_worker_that_comes_later_with_other_packages_is_refused(block):
    with pytest.raises(InputError, match=r"cluster: you gave a worker with numba .*; gfmd allows 0.1, as here"):
        compute((block,), "run", {"numba": "0.1"}, None)
