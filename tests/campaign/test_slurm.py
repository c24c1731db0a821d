"""A run in jobs of a real SLURM, which this test starts on this machine where it is installed."""

import subprocess
import sys
from threading import Timer

import pytest
from slurm_kills import CAMPAIGN, kill_jobs

import gfmd_numba
from support.one_machine_slurm import missing, one_machine_slurm

pytest.importorskip("dask_jobqueue", reason="the extra `cluster` is not installed")
_LONGEST = 900.0  # s of the run in jobs, which takes one minute
CLUSTER = "cores: 2\nmemory: 2 GB\nwalltime: 1 h\njobs: {max: 1}\n"


@pytest.mark.long
@pytest.mark.skipif(bool(missing()), reason=missing() or "SLURM is there")
def test_killed_jobs_of_slurm_change_no_digest(tmp_path, tmp_path_factory):
    path = tmp_path / "campaign.yaml"
    path.write_text(CAMPAIGN.replace("realisations: 1200", "realisations: 800"))  # more work than two jobs can finish
    digest = gfmd_numba.run(path, tmp_path / "serial").attrs["content_sha256"]
    (tmp_path / "cluster.yaml").write_text(CLUSTER)
    command = [sys.executable, "-m", "gfmd_numba", "run", str(path), "-o", "jobs", "--cluster", "cluster.yaml"]
    with (
        one_machine_slurm(tmp_path_factory.mktemp("slurm")) as environment,
        subprocess.Popen(command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True) as run,
    ):
        bound = Timer(_LONGEST, run.kill)
        bound.start()
        try:
            killed = kill_jobs(run, 2, tmp_path / "jobs", environment)
            said = run.communicate()[1]
        finally:
            bound.cancel()
    assert run.returncode == 0, said
    assert killed == 2, said
    assert gfmd_numba.open_campaign(tmp_path / "jobs").attrs["content_sha256"] == digest
