"""Neither the number of workers nor where they run changes a number."""

import subprocess
import sys

import pytest
import xarray as xr
from distributed import LocalCluster

import gfmd_numba
from gfmd_numba.campaign.run import run as run_campaign
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.scene import InputError
from support.campaigns import TINY, campaign, numbers


@pytest.mark.long
def test_worker_count_changes_no_number(finished, tmp_path):
    result = gfmd_numba.run(campaign(tmp_path), tmp_path / "out", workers=2)
    xr.testing.assert_identical(numbers(result), numbers(finished))


@pytest.mark.long
def test_an_existing_scheduler_changes_no_number(finished, tmp_path):
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address="127.0.0.1:0") as cluster:
        path, failures = run_campaign(campaign(tmp_path), tmp_path / "out", Workers(address=cluster.scheduler_address))
    assert failures == {}
    xr.testing.assert_identical(numbers(gfmd_numba.open_campaign(path)), numbers(finished))


@pytest.mark.parametrize("address", ["nowhere://127.0.0.1:1", "tcp://127.0.0.1:x"])
def test_a_wrong_scheduler_is_named(tmp_path, address):
    with pytest.raises(
        InputError, match=f"--scheduler: you gave {address} .*; gfmd allows the address of a running dask"
    ):
        run_campaign(campaign(tmp_path), tmp_path / "out", Workers(address=address))
    run_campaign(campaign(tmp_path), tmp_path / "out", Workers(0))  # a client that failed is not in the way


@pytest.mark.long
def test_a_script_without_a_main_guard_may_run_a_campaign(tmp_path):
    campaign(tmp_path, TINY)
    script = tmp_path / "script.py"
    script.write_text("import gfmd_numba\ngfmd_numba.run('campaign.yaml', 'out')\n")
    subprocess.run([sys.executable, script], cwd=tmp_path, check=True)
    assert (tmp_path / "out" / "tiny.nc").exists()
