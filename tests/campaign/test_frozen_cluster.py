"""A worker of an existing dask cluster that freezes is replaced, and its block is tried again."""

import signal
import sys

import psutil
import pytest
from distributed import LocalCluster

from gfmd_numba.campaign import cluster as cluster_of_run
from gfmd_numba.campaign.execution import Workers, execute
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.shards import Finished
from support.campaigns import campaign


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGSTOP")
def test_a_frozen_worker_of_a_cluster_is_replaced(tmp_path, monkeypatch):
    monkeypatch.setattr(cluster_of_run, "_HEARTBEATS", 8.0)
    blocks = list(plan(campaign(tmp_path)).blocks)
    stopped, ended = [], []
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address="127.0.0.1:0") as cluster:
        tasks = [(block,) for block in blocks]
        for number, failures in execute(tasks, tmp_path, Workers(address=cluster.scheduler_address), 2.0):
            if not stopped:
                worker = psutil.Process(cluster.workers[0].pid)
                worker.send_signal(signal.SIGSTOP)
                stopped.append(worker)
            assert failures == {}
            ended.append(number)
        assert not stopped[0].is_running()
    assert sum(ended) == len(blocks)
    assert all(Finished(tmp_path).is_sound(block.name) for block in blocks)
