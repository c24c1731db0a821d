"""What can go wrong with the workers of a campaign, and that it touches nothing but its own block."""

import ctypes
import os
import resource
import signal
import sys
import threading
import time
from dataclasses import dataclass, replace

import cloudpickle
import pytest
from distributed import LocalCluster

from gfmd_numba.campaign.cases import Block
from gfmd_numba.campaign.cluster import connected
from gfmd_numba.campaign.execution import execute
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.shards import Finished
from gfmd_numba.campaign.workers import Workers, check
from gfmd_numba.scene import InputError
from support.campaigns import campaign
from support.command_line import gfmd, unfolded

POISONS = ("segfault", "exception", "endless")


@dataclass(frozen=True)
class Poison:
    """A surface that does harm to whoever looks at it."""

    kind: str
    nx: int = 64
    shape: tuple = (64,)

    def heights(self, realisations):
        if self.kind == "segfault":
            os.kill(os.getpid(), signal.SIGSEGV)
        if self.kind == "freeze":
            os.kill(os.getpid(), signal.SIGSTOP)
        if self.kind == "endless":
            while True:
                ctypes.PyDLL(None).sleep(1000)  # like a compiled kernel, it does not let go of the interpreter
        raise ZeroDivisionError("poison")


def perform_all(tasks, folder, workers, timeout=None):
    failures = {}
    for _, failed in execute(tasks, folder, workers, timeout):
        failures.update(failed)
    return failures


def poisoned(problem, kinds=POISONS):
    return [(Block(replace(problem, surface=Poison(kind)), 0, 1),) for kind in kinds]


@pytest.fixture
def sound(tmp_path):
    """Sound tasks of a small campaign."""
    planned = plan(campaign(tmp_path))
    blocks = list(planned.blocks)
    return [tuple(blocks[i : i + 2]) for i in range(0, len(blocks), 2)]


@pytest.mark.long
def test_poison_kills_no_other_task(tmp_path, sound):
    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    bad = poisoned(sound[0][0].problem)
    tasks = [sound[0], (*bad[0], *sound[1]), bad[1], *sound[2:], bad[2]]
    (tmp_path / "before").mkdir()
    begun = time.perf_counter()
    assert not perform_all(sound[:1], tmp_path / "before", Workers(1))
    limit = max(4.0, time.perf_counter() - begun)  # what a worker takes to start, load its kernels and solve
    failures = perform_all(tasks, tmp_path, Workers(2), timeout=limit)
    assert [failures[task[0].name].status for task in bad] == ["crashed", "crashed", "timeout"]
    reasons = (
        "its worker died or froze, even when nothing else was running",
        "ZeroDivisionError: poison",
        f"case_timeout of {limit:g} s",
    )
    for task, reason in zip(bad, reasons, strict=True):
        assert reason in failures[task[0].name].reason
    assert len(failures) == 3
    assert all(Finished(tmp_path).is_sound(block.name) for task in sound for block in task)
    assert not list(tmp_path.glob("shards/*.tmp"))


def test_poison_in_this_process_fails_its_own_block_only(tmp_path, sound, monkeypatch):
    monkeypatch.setattr(Poison, "heights", lambda self, realisations: time.sleep(60))
    bad = poisoned(sound[0][0].problem, ["endless"])
    failures = perform_all([*bad, *sound], tmp_path, Workers(0), timeout=2.0)
    assert {name: failure.status for name, failure in failures.items()} == {bad[0][0].name: "timeout"}
    assert all(Finished(tmp_path).is_sound(block.name) for task in sound for block in task)


def test_a_time_out_does_not_end_the_process_of_the_user(tmp_path, sound):
    """Outside the main thread nothing stops a block gently: it is then let run."""
    failures = []
    thread = threading.Thread(
        target=lambda: failures.append(perform_all(sound[:1], tmp_path, Workers(0), timeout=1e-6))
    )
    thread.start()
    thread.join()
    assert failures == [{}]


@pytest.mark.long
def test_a_full_disk_is_one_message_and_loses_nothing(tmp_path):
    """A limit to the size of files stops a run with a worker as a full disk would."""
    path, out = campaign(tmp_path), tmp_path / "out"
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (5000, before[1]))
    try:
        stopped = gfmd("run", path, "-o", out, "--workers=1")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert stopped.exit_code == 3
    lines = stopped.stderr.splitlines()
    said = unfolded(" ".join(line for line in lines if not line.startswith(("blocks", "busy"))))
    assert said.count("gfmd: ") == 1
    assert said.startswith("gfmd: [Errno 27] File too large")
    assert said.endswith("finished work is kept, the same command resumes")
    finished = Finished(out)
    assert all(finished.is_sound(name) for name in finished)
    assert gfmd("run", path, "-o", out, "--workers=0").exit_code == 0


@pytest.fixture
def cluster():
    """A worker in this process, which is there at once; tasks come to it as to any other."""
    address = "127.0.0.1:0"
    with LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, protocol="tcp", dashboard_address=address
    ) as cluster:
        yield cluster


@pytest.mark.long
def test_a_lost_scheduler_is_told(tmp_path, sound, cluster):
    ended = execute(sound, tmp_path, Workers(address=cluster.scheduler_address), None)
    next(ended)
    cluster.close()
    with pytest.raises(OSError, match="the dask scheduler is lost"):
        next(ended)


@pytest.mark.long
def test_two_runs_on_one_cluster_each_get_their_own_shards(tmp_path, sound, cluster):
    """The second begins while the first has the same blocks in flight."""
    folders = [tmp_path / "first", tmp_path / "second"]
    workers = Workers(address=cluster.scheduler_address)
    folders[0].mkdir()
    for _ in execute(sound, folders[0], workers, None):
        if not folders[1].exists():
            folders[1].mkdir()
            list(execute(sound, folders[1], workers, None))
    for folder in folders:
        assert all(Finished(folder).is_sound(block.name) for task in sound for block in task)


@pytest.mark.parametrize(
    ("address", "allowed"),
    [("tcp://192.0.2.1:8786", "or --insecure with it"), ("nowhere://127.0.0.1:1", "the address of a running dask")],
)
def test_a_scheduler_that_cannot_be_used_is_refused(tmp_path, address, allowed):
    with (
        pytest.raises(InputError, match=f"--scheduler: you gave {address}.*gfmd allows .*{allowed}"),
        connected(address, None, False),
    ):
        pass


@pytest.mark.long
def test_workers_with_other_packages_are_refused(tmp_path, monkeypatch, cluster):
    monkeypatch.setattr("gfmd_numba.campaign.cluster.versions", OtherVersions())
    with pytest.raises(InputError, match=r"--scheduler: you gave tcp://.* with numba .*; gfmd allows 0.1, as here"):
        check(Workers(address=cluster.scheduler_address), tmp_path)


class OtherVersions:
    """Here the versions of long ago; where they are unpickled the present ones."""

    def __call__(self):
        return {"numba": "0.1"}

    def __reduce__(self):
        from gfmd_numba.campaign import provenance

        return getattr, (provenance, "versions")
