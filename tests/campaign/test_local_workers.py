"""Local workers: nobody else can use them, they keep their memory, and one that freezes does not stall a run."""

import asyncio
import os
import platform
import re
import resource
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request

import dask
import numpy as np
import psutil
import pytest
from distributed.comm import connect
from distributed.security import Security

from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.workers import local
from support.campaigns import campaign
from support.command_line import python


def family(process):
    try:
        parent = psutil.Process(process.pid)
        return [parent, *parent.children(recursive=True)]
    except psutil.NoSuchProcess:
        return []


def ports(process):
    """TCP ports on which a process listens, and the addresses they are bound to."""
    try:
        return {s.laddr for s in process.net_connections(kind="tcp") if s.status == psutil.CONN_LISTEN}
    except psutil.Error:
        return set()


async def admitted(address, **connection):
    """Whether a scheduler or worker answers who connects like this."""
    try:
        async with asyncio.timeout(5):
            comm = await connect(address, timeout=4, **connection)
            await comm.write({"op": "identity", "reply": True})
            return bool(await comm.read())
    except Exception:
        return False


def says_nothing(port):
    """Whether the port answers a web browser with no more than that there is nothing."""
    for page in ("", "status", "info/main/workers.html", "json/identity.json", "metrics", "health"):
        try:
            urllib.request.urlopen(f"http://127.0.0.1:{port}/{page}", timeout=2)
        except urllib.error.HTTPError as error:
            if error.code != 404:
                return False
        except (OSError, ValueError):  # it does not speak with browsers at all
            continue
        else:
            return False
    return True


@pytest.fixture(scope="module")
def client():
    with local(1) as client:
        yield client


@pytest.mark.long
@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere sockets of processes are hard to see")
@pytest.mark.filterwarnings("ignore")
def test_a_client_without_the_key_of_a_run_is_refused_everywhere(client):
    assert client.submit(sum, [1, 2]).result() == 3
    found = {address for member in family(psutil.Process()) for address in ports(member)}
    assert len(found) >= 3  # a scheduler and a nanny with its worker
    assert {address.ip for address in found} == {"127.0.0.1"}
    assert all(says_nothing(address.port) for address in found)
    stranger = Security.temporary().get_connection_args("client")  # TLS, but with a key of its own

    async def attempts():
        addresses = [f"127.0.0.1:{address.port}" for address in found]
        plain = [admitted(f"tcp://{address}") for address in addresses]
        return await asyncio.gather(*plain, *(admitted(f"tls://{address}", **stranger) for address in addresses))

    assert not any(asyncio.run(attempts()))
    friend = client.security.get_connection_args("client")
    assert asyncio.run(admitted(client.scheduler.address, **friend))  # who has the key gets in by the same way


def faults():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(100):
        np.ones(2**17), np.ones(2**19)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


@pytest.mark.long
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="other libraries know no such thresholds")
@pytest.mark.filterwarnings("ignore")
def test_arrays_of_a_worker_are_made_of_kept_pages(client):
    """A worker makes its arrays of memory that it has, not of new pages of the system."""
    for _ in range(2):  # until the heap has its size: the second time it may still grow by one array
        client.submit(faults, pure=False).result()
    assert client.submit(faults, pure=False).result() < 256  # of 100 * 256 pages of the smaller array


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
@pytest.mark.filterwarnings("ignore")
def test_a_worker_that_takes_long_to_start_again_is_waited_for():
    """Dask would close its nanny meanwhile, and a run without workers waits for ever."""
    with dask.config.set({"distributed.deploy.lost-worker-timeout": "10ms"}), local(1) as client:
        (first,) = client.run(os.getpid).values()
        os.kill(first, signal.SIGKILL)
        deadline = time.monotonic() + 120.0
        while not set(client.run(os.getpid, on_error="ignore").values()) - {first}:
            assert time.monotonic() < deadline, "nobody has taken its place"
            time.sleep(0.1)
        time.sleep(3.0)  # in which a nanny that is closed would end it
        assert client.submit(sum, [1, 2]).result(timeout=120) == 3


def is_worker(child):
    try:
        return not child.children() and re.search("forkserver|spawn_main", str(child.cmdline()))
    except psutil.NoSuchProcess:  # one that has just ended
        return False


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGSTOP")
def test_a_run_goes_on_without_the_worker_that_was_stopped_from_outside(tmp_path):
    path, out = campaign(tmp_path, **{"realisations: 6": "realisations: 60\ncase_timeout: 6"}), tmp_path / "out"
    command = [sys.executable, "-m", "gfmd_numba", "run", str(path), "-o", str(out), "--workers=2"]
    soon = os.environ | {"DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL": "8s"}  # dask looks for silent workers as often
    process = subprocess.Popen(command, env=soon, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    while process.poll() is None and len(list(out.glob("shards/*.shard"))) < 1:
        time.sleep(0.01)
    workers = list(filter(is_worker, family(process)[1:]))
    workers[-1].suspend()
    said = process.communicate(timeout=300)[0]
    assert process.returncode == 0, said
    assert len(list(out.glob("shards/*.shard"))) == len(list(plan(path).blocks))


@pytest.mark.long
@pytest.mark.skipif(sys.platform != "linux", reason="no copies of processes")
def test_workers_are_born_with_the_package(client):
    assert set(client.run(eval, "'gfmd_numba.campaign.execution' in __import__('sys').modules").values()) == {True}


def summed(folder):
    """What a script in a folder prints, whose worker adds two numbers."""
    script = """from gfmd_numba.campaign.workers import local
if __name__ == "__main__":
    with local(1) as client:
        print(client.submit(sum, [1, 2]).result())"""
    (folder / "script.py").write_text(script)
    done = subprocess.run([sys.executable, folder / "script.py"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.long
def test_workers_work_where_the_temporary_folder_has_a_long_name(tmp_path, monkeypatch):
    folder = tmp_path / ("x" * 120)  # no socket has a path of more than 108 characters
    folder.mkdir()
    monkeypatch.setenv("TMPDIR", str(folder))
    assert summed(tmp_path) == "3\n"


@pytest.mark.long
def test_workers_import_nothing_from_where_the_run_is_started(tmp_path, monkeypatch):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "statistics.py").write_text("from pathlib import Path; Path('imported').touch()")
    monkeypatch.chdir(tmp_path / "data")
    assert summed(tmp_path) == "3\n"
    assert not (tmp_path / "data" / "imported").exists()


def test_workers_share_a_temporary_cache(tmp_path, monkeypatch):
    """Where there is no home, it is found before the process begins of which workers are copies."""
    (tmp_path / "file").touch()
    script = """import os
from multiprocessing import forkserver
from gfmd_numba.campaign.workers import Workers, begin_loading
forkserver.ensure_running = lambda: print("GFMD_CACHE_DIR" in os.environ)
begin_loading(Workers(1))"""
    for name in ("HOME", "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, str(tmp_path / "file" / "home"))
    monkeypatch.delenv("GFMD_CACHE_DIR", raising=False)
    assert python(script) == ("True\n" if sys.platform == "linux" else "")
