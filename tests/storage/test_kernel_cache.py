"""Compiled kernels: found again, compiled again when damaged, run only if this user has written them."""

import os
import pickle
import resource
import shutil
import subprocess
import sys

import pytest

from gfmd_numba.storage import kernel_cache

COMPILE = """
import os
import numpy as np
from gfmd_numba import kernels
spectrum = np.ones((1, 4), dtype=complex)
kernels.multiply(spectrum, np.full(4, 2.0), np.array([0]))
assert (spectrum == 2.0).all()
print(sum(kernels.multiply.stats.cache_hits.values()) if hasattr(kernels.multiply, "stats") else -1, flush=True)
os._exit(0)  # as after a kill: nothing is done at the end
"""


def compile_in(folder, before=None, **environment):
    """Number of kernels found in a cache, and what is said meanwhile."""
    surroundings = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA")}
    ran = subprocess.run(
        [sys.executable, "-c", COMPILE],
        env=surroundings | {"GFMD_CACHE_DIR": str(folder)} | environment,
        preexec_fn=before,
        capture_output=True,
        text=True,
    )
    assert ran.returncode == 0, ran.stderr
    return int(ran.stdout), ran.stderr


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    """Cache with one compiled kernel, for tests to copy: to start Python and compile takes seconds."""
    cache = tmp_path_factory.mktemp("compiled") / "cache"
    assert compile_in(cache) == (0, "")
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
def test_a_damaged_kernel_is_compiled_again(compiled, tmp_path):
    cache = copied(compiled, tmp_path / "own" / "cache")
    (code,) = files(cache)
    code.write_bytes(code.read_bytes()[:-1])
    assert compile_in(cache) == (0, "")
    (again,) = files(cache)
    code = again.read_bytes()[kernel_cache._HEAD :]
    assert again.read_bytes() == kernel_cache._seal(again.name, code) + code


@pytest.mark.long
def test_kernels_are_compiled_once(compiled):
    assert compile_in(compiled) == (1, "")


@pytest.mark.long
def test_a_cache_is_for_its_user_alone_whatever_the_umask(tmp_path):
    cache = tmp_path / "new" / "cache"
    compile_in(cache, before=lambda: os.umask(0))
    assert files(cache)
    assert {path.stat().st_mode & 0o777 for path in files(cache)} == {0o600}
    folders = [tmp_path / "new", cache, *(path for path in cache.rglob("*") if path.is_dir())]
    assert {path.stat().st_mode & 0o777 for path in folders} == {0o700}
    assert compile_in(cache, before=lambda: os.umask(0)) == (1, "")


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


IN_EACH = """
import os, sys
import numba  # which takes longer than to compile
for folder in sys.argv[1:]:
    child = os.fork()
    if child == 0:
        os.environ["GFMD_CACHE_DIR"] = folder
        for stream, name in ((1, ".out"), (2, ".err")):
            os.dup2(os.open(folder + name, os.O_WRONLY | os.O_CREAT), stream)
        exec(COMPILE)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""


@pytest.mark.long
def test_nothing_is_run_that_somebody_else_may_have_put_there(compiled, tmp_path):
    """The seal is no secret: who can write a file can seal it, too. Each danger has a process of its own."""
    caches = [copied(compiled, tmp_path / danger / "cache") for danger in DANGERS]
    for (danger, endangered), cache in zip(DANGERS.items(), caches, strict=True):
        (file,) = files(cache)
        code = pickle.dumps(Witness(tmp_path / f"{danger} ran"))
        file.write_bytes(kernel_cache._seal(file.name, code) + code)
        endangered(cache, file)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA")}
    script = f"COMPILE = {COMPILE!r}\n{IN_EACH}"
    done = subprocess.run([sys.executable, "-c", script, *caches], env=environment, capture_output=True, text=True)
    ended = dict(zip(DANGERS, done.stdout.split(), strict=True))
    assert ended == dict.fromkeys(DANGERS, "0") | {"nothing": "1"}
    assert [path.name for path in tmp_path.glob("* ran")] == ["nothing ran"]
    for danger, cache in zip(DANGERS, caches, strict=True):
        if danger != "nothing":
            hits, said = (cache.with_name(f"cache{end}").read_text() for end in (".out", ".err"))
            whole = "cache" in danger
            assert int(hits) == 0
            assert ("is not used: it belongs to somebody else, or others may write to it" in said) == whole, danger


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
def test_no_cache_is_no_failure(tmp_path):
    """A file where the folder should be: not even root can write there."""
    (tmp_path / "file").touch()
    assert compile_in(tmp_path / "file" / "cache", HOME=str(tmp_path / "file"))[0] == 0


@pytest.mark.long
def test_a_full_cache_disk_is_no_failure(tmp_path):
    assert compile_in(tmp_path, before=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))) == (0, "")
    assert files(tmp_path) == []
