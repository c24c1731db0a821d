"""Finished blocks: each is written and read whole, or not at all, in a file of its own or with others."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.campaign import execution
from gfmd_numba.campaign.execution import perform
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.run import run
from gfmd_numba.campaign.shards import Finished, path_of, store
from gfmd_numba.campaign.status import verify
from gfmd_numba.campaign.workers import Workers
from support.campaigns import campaign

ARRAYS = {"kappa": np.array([1.0, np.nan]), "status": np.array([0, 1], dtype=np.int8)}
OTHERS = {"kappa": np.array([2.0]), "status": np.array([0], dtype=np.int8)}
BLOCKS = {"a-000000-000002": ARRAYS, "b-000000-000001": OTHERS}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "shards").mkdir()
    return tmp_path


def same(stored, arrays):
    assert stored is not None
    assert list(stored) == list(arrays)
    for name, values in arrays.items():
        np.testing.assert_array_equal(stored[name], values)
        assert stored[name].dtype == values.dtype


def test_shards_are_all_or_nothing(folder):
    assert Finished(folder).read("a") is None
    store(folder, {"a": ARRAYS})
    same(Finished(folder).read("a"), ARRAYS)
    path = folder / "shards" / "a.shard"
    content = path.read_bytes()
    (folder / "shards" / "b.shard").write_bytes(content)
    assert Finished(folder).read("b") is None
    (folder / "shards" / "b.shard").unlink()
    for cut in range(0, len(content), 7):
        path.write_bytes(content[:cut])
        assert Finished(folder).read("a") is None
    assert list((folder / "shards").iterdir()) == [path]


def test_blocks_of_a_bundle_are_read_one_by_one(folder):
    store(folder, BLOCKS)
    assert list((folder / "shards").iterdir()) == [path_of(folder, list(BLOCKS))]
    found = Finished(folder)
    assert list(found) == list(BLOCKS)
    for name, arrays in BLOCKS.items():
        same(found.read(name), arrays)
    assert all(map(found.is_sound, BLOCKS))


def test_a_damaged_byte_costs_one_block_or_all_of_a_bundle_and_none_is_wrong(folder):
    store(folder, BLOCKS)
    path = path_of(folder, list(BLOCKS))
    content = path.read_bytes()
    head = content.index(b"\x89gfmd shard")
    magic = content.index(b"\n") + 1
    for place in range(0, len(content), 5):
        altered = bytearray(content)
        altered[place] ^= 1
        path.write_bytes(altered)
        found = Finished(folder)
        if place < magic:  # it may be anybody's
            assert (list(found), found.foreign) == ([], [path])
            continue
        sound = [name for name in BLOCKS if found.is_sound(name)]
        assert len(sound) == (0 if place < head else 1)
        assert found.unreadable == ([path] if place < head else [])
        for name in sound:
            same(found.read(name), BLOCKS[name])
    for cut in range(0, len(content), 7):
        path.write_bytes(content[:cut])
        assert not all(Finished(folder).is_sound(name) for name in BLOCKS)


def test_a_block_that_was_damaged_and_stored_again_is_sound(folder):
    store(folder, BLOCKS)
    path = path_of(folder, list(BLOCKS))
    path.write_bytes(path.read_bytes()[:-1])
    store(folder, {"b-000000-000001": OTHERS})
    same(Finished(folder).read("b-000000-000001"), OTHERS)


@pytest.mark.long
def test_many_small_blocks_share_files_and_give_the_same_results(tmp_path, monkeypatch):
    path, out = campaign(tmp_path, **{"limits:": "#", "[0.3, 0.8]": "[0.2, 0.4, 0.6, 0.8]"}), tmp_path / "out"
    apart = gfmd_numba.run(path, tmp_path / "apart").attrs["content_sha256"]
    monkeypatch.setattr(execution, "_MOST_FILES", 2)
    monkeypatch.setattr("gfmd_numba.campaign.plan._TASKS_PER_WORKER", 0.5)  # all in one
    results, failures = run(path, out, Workers(0))
    assert failures == {}
    assert len(list(out.glob("shards/*"))) < 4
    assert (verify(out).sound, verify(out).damaged, verify(out).missing) == (4, [], 0)
    bundle = next(out.glob("shards/*.bundle"))
    bundle.write_bytes(bundle.read_bytes()[:-1])  # of one block
    assert verify(out).damaged
    results, _ = run(path, out, Workers(0))
    assert (verify(out).sound, verify(out).damaged, verify(out).missing) == (4, [], 0)
    with open(results, "rb") as file:
        assert apart.encode() in file.read()


def test_an_interrupt_keeps_the_blocks_before_it(folder, tmp_path, monkeypatch):
    task, solve, solved = tuple(plan(campaign(tmp_path)).blocks), execution.measured, []

    def interrupted(*given):
        if len(solved) == 3:
            raise KeyboardInterrupt
        solved.append(given)
        return solve(*given)

    monkeypatch.setattr(execution, "measured", interrupted)
    with pytest.raises(KeyboardInterrupt):
        perform(task, folder, None, together=5)
    assert list(Finished(folder)) == [block.name for block in task[:3]]
    assert len(os.listdir(folder / "shards")) == 1


FEW_FILES = """
import sys
from gfmd_numba.campaign import execution, plan
execution._MOST_FILES, plan._TASKS_PER_WORKER = 5, 0.5
from gfmd_numba.cli import main
main(sys.argv[1:])
"""


@pytest.mark.long
def test_a_run_killed_between_bundles_resumes_to_the_same_numbers(finished, tmp_path):
    path, out = campaign(tmp_path), tmp_path / "out"
    command = [sys.executable, "-c", FEW_FILES, "run", str(path), "-o", str(out), "--workers=0"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and len(list(out.glob("shards/*.bundle"))) < 2:
        time.sleep(0.01)
    process.kill()
    process.wait()
    left = {bundle: bundle.stat().st_mtime_ns for bundle in out.glob("shards/*.bundle")}
    assert len(left) >= 2
    assert gfmd_numba.run(path, out, 0).attrs["content_sha256"] == finished.attrs["content_sha256"]
    assert {bundle: bundle.stat().st_mtime_ns for bundle in left} == left
