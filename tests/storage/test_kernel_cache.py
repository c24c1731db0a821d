"""Compiled kernels: found again, compiled again when damaged, run only if this user has written them."""

import json
import os
import pickle
import shutil
import subprocess
import sys

import pytest

from gfmd_numba.storage import kernel_cache

COMPILE = """
import os
import numpy as np
from gfmd_numba import kernels
numbers = np.zeros(2, dtype=int)
kernels.count(numbers, np.array([0]), 1)  # the one that is compiled soonest
assert numbers.tolist() == [1, 0]
print(sum(kernels.count.stats.cache_hits.values()) if hasattr(kernels.count, "stats") else -1, flush=True)
os._exit(0)  # as after a kill: nothing is done at the end
"""
FORKS = """
import json, os, resource, sys
import numba
import gfmd_numba.storage.kernel_cache
numba.njit(lambda: 0)()  # to start Python and a compiler takes longer than to compile
for line in sys.stdin:
    environment, umask, size, said = json.loads(line)
    child = os.fork()
    if child == 0:
        for stream, name in ((1, ".out"), (2, ".err")):
            os.dup2(os.open(said + name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), stream)
        os.environ.update(environment)
        os.umask(umask)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
        exec(COMPILE)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""


@pytest.fixture(scope="module")
def compile_in(tmp_path_factory):
    """Function of a cache, which returns how a process ends that compiles there, and what it says.

    It prints the number of kernels that it finds. Each is forked from a process that knows nothing of a cache yet.
    """
    said = tmp_path_factory.mktemp("said") / "said"
    surroundings = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA")}
    process = subprocess.Popen(
        [sys.executable, "-c", f"COMPILE = {COMPILE!r}\n{FORKS}"],
        env=surroundings,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )

    def compiled_in(folder, umask=0o022, size=-1, **environment):
        asked = ({"GFMD_CACHE_DIR": str(folder)} | environment, umask, size, str(said))
        process.stdin.write(json.dumps(asked) + "\n")
        process.stdin.flush()
        ended = int(process.stdout.readline())
        return ended, *(said.with_suffix(end).read_text() for end in (".out", ".err"))

    yield compiled_in
    process.communicate()


@pytest.fixture(scope="module")
def compiled(compile_in, tmp_path_factory):
    """Cache with one compiled kernel, for tests to copy."""
    cache = tmp_path_factory.mktemp("compiled") / "cache"
    assert compile_in(cache) == (0, "0\n", "")
    return cache


def copied(compiled, cache):
    """A copy of the cache as this user would have made it."""
    cache.parent.mkdir(mode=0o700, exist_ok=True)
    return shutil.copytree(compiled, cache)


def files(folder):
    return [path for path in folder.rglob("*") if path.is_file()]


@pytest.mark.long
@pytest.mark.parametrize("damage", ["altered", "cut", "emptied", "zeroed"])
def test_a_damaged_kernel_is_not_found(compiled, tmp_path, monkeypatch, damage):
    (code,) = files(copied(compiled, tmp_path / "own" / "cache"))
    monkeypatch.setattr(kernel_cache, "folder", lambda: code.parent)
    assert kernel_cache.load(code.name) is not None
    content = bytearray(code.read_bytes())
    if damage == "altered":
        content[len(content) // 2] ^= 0xFF
    elif damage == "zeroed":
        content[len(content) // 2 :] = bytes(len(content) - len(content) // 2)
    else:
        content = content[: len(content) // 2 if damage == "cut" else 0]
    code.write_bytes(content)
    assert kernel_cache.load(code.name) is None


@pytest.mark.long
def test_a_damaged_kernel_is_compiled_again(compiled, compile_in, tmp_path):
    cache = copied(compiled, tmp_path / "own" / "cache")
    (code,) = files(cache)
    code.write_bytes(code.read_bytes()[:-1])
    assert compile_in(cache) == (0, "0\n", "")
    (again,) = files(cache)
    code = again.read_bytes()[kernel_cache._HEAD :]
    assert again.read_bytes() == kernel_cache._seal(again.name, code) + code


@pytest.mark.long
def test_kernels_are_compiled_once(compiled, compile_in):
    assert compile_in(compiled) == (0, "1\n", "")


@pytest.mark.long
def test_a_cache_is_for_its_user_alone_whatever_the_umask(tmp_path, compile_in):
    cache = tmp_path / "new" / "cache"
    compile_in(cache, umask=0)
    assert files(cache)
    assert {path.stat().st_mode & 0o777 for path in files(cache)} == {0o600}
    folders = [tmp_path / "new", cache, *(path for path in cache.rglob("*") if path.is_dir())]
    assert {path.stat().st_mode & 0o777 for path in folders} == {0o700}
    assert compile_in(cache, umask=0) == (0, "1\n", "")


class Witness:
    """Code that leaves a file where it is run, and then ends the process."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return exec, (f"import os; open({str(self.path)!r}, 'w').close(); os._exit(1)",)


def given_away(path):
    if os.geteuid() != 0:
        pytest.skip("only root can give files away")
    os.chown(path, 65534, 65534)


def linked(path):
    path.rename(path.with_suffix(".moved"))
    path.symlink_to(path.with_suffix(".moved"))


DANGERS = {
    "file of another": lambda cache, file: given_away(file),
    "file that others may write": lambda cache, file: file.chmod(0o622),
    "link": lambda cache, file: linked(file),
    "cache of another": lambda cache, file: given_away(cache),
    "cache that others may write": lambda cache, file: cache.chmod(0o777),
    "cache that a group may write": lambda cache, file: cache.chmod(0o770),
    "nothing": lambda cache, file: None,
}


@pytest.mark.long
def test_nothing_is_run_that_somebody_else_may_have_put_there(compiled, compile_in, tmp_path):
    """The seal is no secret: who can write a file can seal it, too. Each danger has a process of its own."""
    for danger, endangered in DANGERS.items():
        cache = copied(compiled, tmp_path / danger / "cache")
        (file,) = files(cache)
        code = pickle.dumps(Witness(tmp_path / f"{danger} ran"))
        file.write_bytes(kernel_cache._seal(file.name, code) + code)
        endangered(cache, file)
        ended, hits, said = compile_in(cache)
        if danger == "nothing":
            assert ended == 1
            continue
        assert (ended, hits) == (0, "0\n"), danger
        whole = "cache" in danger
        assert ("is not used: it belongs to somebody else, or others may write to it" in said) == whole, danger
    assert [path.name for path in tmp_path.glob("* ran")] == ["nothing ran"]


def test_a_link_to_a_cache_is_followed_once(tmp_path):
    """Who owns the link may lead it elsewhere after the look at what it led to."""
    own, link = tmp_path / "own", tmp_path / "link"
    own.mkdir(mode=0o700)
    link.symlink_to(own)
    script = "from gfmd_numba.storage import cache; print(cache.directory())"
    done = subprocess.run(
        [sys.executable, "-c", script], env=os.environ | {"GFMD_CACHE_DIR": str(link)}, capture_output=True, text=True
    )
    assert done.stdout.strip() == str(own.resolve())


@pytest.mark.long
def test_no_cache_is_no_failure(tmp_path, compile_in):
    """A file where the folder should be: not even root can write there."""
    (tmp_path / "file").touch()
    assert compile_in(tmp_path / "file" / "cache", HOME=str(tmp_path / "file"))[:2] == (0, "0\n")


@pytest.mark.long
def test_a_full_cache_disk_is_no_failure(tmp_path, compile_in):
    assert compile_in(tmp_path, size=100) == (0, "0\n", "")
    assert files(tmp_path) == []
