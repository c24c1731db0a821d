"""A run in jobs of a queueing system, which here are processes of this machine."""

import gc
import subprocess
import sys
import time

import pytest
import xarray as xr
import yaml

import gfmd_numba
from gfmd_numba.campaign.run import StoppedError
from gfmd_numba.campaign.run import run as run_campaign
from gfmd_numba.campaign.workers import check, workers_of
from gfmd_numba.cli.terminal import show_queue
from gfmd_numba.scene import InputError
from support.campaigns import campaign, numbers
from support.command_line import gfmd
from support.fake_slurm import fake_slurm, jobs_of, kill_job

pytest.importorskip("dask_jobqueue.slurm", reason="the extra `cluster` is not installed")
job_queue = pytest.importorskip("gfmd_numba.campaign.job_queue")
QueueState, columns_of = job_queue.QueueState, job_queue.columns_of

PYTHON = f"env INSIDE=1 {sys.executable}"  # of several words, as that of a container is
CLUSTER = {"cores": 1, "memory": 2e9, "walltime": 3600.0, "jobs": {"max": 1}}


@pytest.fixture
def slurm(tmp_path, monkeypatch):
    folder = tmp_path / "slurm"
    folder.mkdir()
    fake_slurm(folder, monkeypatch)
    monkeypatch.setattr(job_queue, "_SECONDS_BETWEEN_LOOKS", 0.2)
    monkeypatch.setattr(job_queue, "_SECONDS_TO_FIRST_LOOK", 0.2)
    monkeypatch.setattr(job_queue, "_INTERVAL", "0.2s")
    yield folder
    deadline = time.monotonic() + 5.0
    while jobs_of(folder):
        assert time.monotonic() < deadline, "a job outlived its run"
        time.sleep(0.1)
    if (tmp_path / "out").exists():
        gc.collect()  # what a run has left open fails its own test


@pytest.mark.long
def test_jobs_that_are_killed_are_replaced_and_change_no_number(finished, tmp_path, slurm):
    """The first before its worker comes, the second when it has done a block."""
    out, keys, readable = tmp_path / "out", [], []

    def ended(blocks):
        if not keys:
            keys.extend(out.glob("jobs/.dask-jobqueue.worker.*"))
            readable.extend(path for path in keys if path.stat().st_mode & 0o077)
            for job in jobs_of(slurm):
                kill_job(slurm, job)

    workers = workers_of(
        CLUSTER | {"setup": [f"mkdir {slurm}/first && exit 1"], "directives": ["--nice"], "python": PYTHON}
    )
    path, failures = run_campaign(campaign(tmp_path), out, workers, lambda *_: ended)
    assert failures == {}
    xr.testing.assert_identical(numbers(gfmd_numba.open_campaign(path)), numbers(finished))
    scripts = [path.read_text() for path in slurm.glob("*.script")]
    assert len(scripts) >= 3  # a worker that a busy machine loses is replaced, too
    for script in scripts:
        assert "#SBATCH --nice\n" in script
        assert "#SBATCH -t 60\n" in script
        assert f"mkdir {slurm}/first && exit 1\n" in script
        assert f"\n{PYTHON} -m distributed.cli.dask_worker tls://" in script
    assert len(keys) == 3
    assert not readable, "others may read a key"
    assert not list(out.glob("jobs/.dask*")), "a key outlived its run"


@pytest.mark.long
def test_a_run_whose_jobs_wait_says_so_and_why_and_ends_whatever_still_holds_them(tmp_path, slurm, monkeypatch):
    """The queue is full until that has been told; a cluster that closes asks each job that is not yet forgotten."""
    (slurm / "full").touch()
    said, held, start = [], [], job_queue.SLURMJob.start

    async def remembered(job):
        held.append(job)
        await start(job)

    monkeypatch.setattr(job_queue.SLURMJob, "start", remembered)

    def show(state):
        said.append(state)
        (slurm / "full").unlink(missing_ok=True)

    monkeypatch.setattr("gfmd_numba.cli.campaigns.show_queue", lambda state: (show(state), show_queue(state)))
    (tmp_path / "cluster.yaml").write_text(yaml.safe_dump(CLUSTER))
    done = gfmd("run", campaign(tmp_path), "-o", tmp_path / "out", "--cluster", tmp_path / "cluster.yaml")
    assert done.exit_code == 0, done.output
    assert held
    assert said[:2] == [QueueState(1, "Resources", 0), QueueState(0, "", 1)]
    lines = [line for line in done.stderr.splitlines() if line.startswith("jobs ")]
    assert lines[:2] == ["jobs     1 waiting (Resources), 0 running", "jobs     0 waiting, 1 running"]


def test_a_state_of_the_queue_counts_jobs_that_have_begun():
    printed = "7 PD Priority\n8 PD Resources\n9 PD Resources\n10 CF None\n11 R None\n12 CG None\n"
    assert QueueState.of(columns_of(printed)) == QueueState(4, "Resources", 1)
    assert QueueState.of(columns_of("")) == QueueState()


@pytest.mark.long
def test_jobs_that_end_before_their_workers_come_stop_the_run(tmp_path, slurm):
    with pytest.raises(StoppedError, match=r"before any of their workers came; what they printed is in .*out/jobs"):
        gfmd_numba.run(campaign(tmp_path), tmp_path / "out", CLUSTER | {"python": "false", "jobs": {"max": 6}})


def test_what_slurm_refuses_is_told_before_anything_is_made(tmp_path, slurm):
    with pytest.raises(
        InputError, match=r"--cluster: you gave jobs that SLURM does not take \(.*invalid partition: nowhere\)"
    ):
        gfmd_numba.run(campaign(tmp_path), tmp_path / "out", CLUSTER | {"partition": "nowhere"})
    assert not (tmp_path / "out").exists()


def test_an_interface_that_is_not_there_is_refused(tmp_path, slurm):
    with pytest.raises(InputError, match=r"--cluster: you gave the interface ib7; gfmd allows one of .*\blo\b"):
        check(workers_of(CLUSTER | {"interface": "ib7"}), tmp_path / "out")


def test_a_queue_that_does_not_answer_is_told(tmp_path, slurm, monkeypatch):
    (slurm / "sbatch").write_text("#!/bin/sh\nexec sleep 60\n")
    monkeypatch.setattr(job_queue, "_PATIENCE", 0.2)
    with pytest.raises(InputError, match=r"--cluster: sbatch did not answer in 0.2 s; gfmd needs a SLURM"):
        check(workers_of(CLUSTER), tmp_path / "out")


def test_what_sbatch_says_is_told(tmp_path, slurm):
    (slurm / "sbatch").write_text("#!/bin/sh\necho 'Could not establish a configuration source' >&2\nexit 1\n")
    with pytest.raises(InputError, match=r"SLURM does not take \(Could not .*\); gfmd allows a SLURM that is up"):
        check(workers_of(CLUSTER), tmp_path / "out")


def test_an_output_that_a_script_cannot_name_is_refused(tmp_path, slurm):
    with pytest.raises(
        InputError, match=r"--output: you gave '.*my results' with --cluster; gfmd allows a path of letters"
    ):
        check(workers_of(CLUSTER), tmp_path / "my results")


def test_a_script_of_a_job_runs_nothing_that_the_path_of_python_holds(tmp_path, monkeypatch):
    odd = tmp_path / "my envs; touch stolen $(touch stolen)" / "python"
    odd.parent.mkdir()
    odd.symlink_to(sys.executable)
    monkeypatch.setattr(sys, "executable", str(odd))
    job = job_queue.SLURMJob(
        "tls://192.0.2.1:8786", name="test", **job_queue._options(workers_of(CLUSTER).cluster, "test")
    )
    (tmp_path / "job.sh").write_text(job.job_script().replace("-m distributed.cli.dask_worker", "-c 'print(1)' --"))
    done = subprocess.run(["sh", "job.sh"], cwd=tmp_path, capture_output=True, text=True)
    assert (done.stdout, done.returncode) == ("1\n", 0), done.stderr
    assert not list(tmp_path.rglob("stolen"))


def test_jobs_with_too_little_memory_are_refused(tmp_path, slurm):
    with pytest.raises(
        InputError, match=r"--cluster: you gave jobs of 0.2 GB for 8 workers; gfmd allows a memory of at"
    ):
        gfmd_numba.run(campaign(tmp_path), tmp_path / "out", CLUSTER | {"cores": 8, "memory": 2e8})


def test_a_machine_without_slurm_is_told(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="--cluster: this machine has no sbatch; gfmd needs a machine that submits"):
        check(workers_of(CLUSTER), tmp_path / "out")
