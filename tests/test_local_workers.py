"""Local worker processes: nobody else can reach them, and one that hangs does not stall a run."""

import os
import signal
import subprocess
import sys
import time

import psutil
import pytest
from test_campaign import campaign
from test_execution import perform_all, poisoned

from gfmd_numba.campaign import processes, shards
from gfmd_numba.campaign.execution import Workers, shard_path
from gfmd_numba.campaign.plan import plan


def family(process):
    try:
        parent = psutil.Process(process.pid)
        return [parent, *parent.children(recursive=True)]
    except psutil.NoSuchProcess:
        return []


def doors(process):
    """Where a process can be reached from outside: listening sockets, and local sockets with a name."""
    try:
        sockets = process.net_connections(kind="all")
    except psutil.Error:
        return []
    return [s.laddr for s in sockets if s.status == psutil.CONN_LISTEN or (isinstance(s.laddr, str) and s.laddr)]


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere sockets of processes are hard to see")
@pytest.mark.parametrize("command", ["run", "doctor"])
def test_what_works_for_us_listens_to_nobody(tmp_path, command):
    path, out = campaign(tmp_path, **{"realisations: 6": "realisations: 60"}), tmp_path / "out"
    arguments = [command] if command == "doctor" else [command, path, "-o", out, "--workers=2"]
    process = subprocess.Popen(
        [sys.executable, "-m", "gfmd_numba.cli", *map(str, arguments)], stdout=subprocess.DEVNULL
    )
    most, found = 0, []
    while process.poll() is None:
        members = family(process)
        most = max(most, len(members))
        found += [door for member in members for door in doors(member)]
        time.sleep(0.01)
    assert process.returncode == 0
    assert found == []
    assert most >= 3  # this one saw the workers


def stopped_by_itself(marker):
    """Freeze the first process that comes here, as SIGSTOP from outside would."""
    if not marker.exists():
        marker.touch()
        os.kill(os.getpid(), signal.SIGSTOP)
    return marker.name


def frozen_for_good(_):
    os.kill(os.getpid(), signal.SIGSTOP)


def test_a_frozen_worker_is_told_at_the_deadline_and_replaced(tmp_path):
    tasks = [tmp_path / "first", tmp_path / "second", tmp_path / "first"]
    found = [answer for _, answer in processes.answers(stopped_by_itself, tasks, 1, timeout=1.0)]
    assert found == [processes.Lost.frozen, processes.Lost.frozen, "first"]
    assert not [child for child in psutil.Process().children() if "spawn_main" in " ".join(child.cmdline())]


def test_a_frozen_worker_is_found_without_a_deadline(monkeypatch):
    monkeypatch.setattr(processes, "_FROZEN", 3.0)
    assert list(processes.answers(frozen_for_good, [0], 1, None)) == [(0, processes.Lost.frozen)]


def test_a_sleeping_parent_counts_for_no_deadline(tmp_path):
    """After Ctrl-Z and `fg` no task is late that worked for less than its time."""
    found = []
    for task, answer in processes.answers(time.sleep, [0.0, 6.3], 1, timeout=4.0):
        found.append((task, answer))
        time.sleep(6.0)
    assert found == [(0.0, None), (6.3, None)]


def test_workers_that_cannot_start_are_an_error_not_a_loop():
    with pytest.raises(ChildProcessError, match="worker processes end while they start"):
        list(processes.answers(Unknown(), [0], 2, None))


class Unknown:
    """A function that cannot be read where it is needed."""

    def __reduce__(self):
        return int, ("no number",)


def shard_count(out):
    return len(list(out.glob("shards/*.shard")))


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGSTOP")
@pytest.mark.parametrize("timeout", ["case_timeout: 3", ""])
def test_a_worker_stopped_from_outside_changes_nothing_but_the_time(tmp_path, timeout):
    text_of = {"realisations: 6": f"realisations: 2000\n{timeout}"}
    path, out = campaign(tmp_path, **text_of), tmp_path / "out"
    code = (
        "import sys; from gfmd_numba.campaign import processes; processes._FROZEN = 10.0\n"
        "from gfmd_numba.cli import main; main(sys.argv[1:])"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, "run", str(path), "-o", str(out), "--workers=2"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    while process.poll() is None and shard_count(out) < 2:
        time.sleep(0.001)
    worker = next(child for child in family(process)[1:] if "spawn_main" in " ".join(child.cmdline()))
    worker.suspend()
    said = process.communicate(timeout=300)[0]
    assert process.returncode == 0, said
    assert not psutil.pid_exists(worker.pid)
    blocks = list(plan(path).blocks)
    assert shard_count(out) == len(blocks)


def test_a_block_that_freezes_every_worker_is_named(tmp_path):
    planned = plan(campaign(tmp_path))
    sound = [(block,) for block in list(planned.blocks)[:2]]
    bad = poisoned(sound[0][0].problem, ["freeze"])
    failures = perform_all([*bad, *sound], tmp_path, Workers(2), timeout=4.0)
    assert {name: failure.status for name, failure in failures.items()} == {bad[0][0].name: "crashed"}
    assert "its worker froze, also with nothing else at work" in failures[bad[0][0].name].reason
    assert all(shards.read(shard_path(tmp_path, block)) is not None for (block,) in sound)
