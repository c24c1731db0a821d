"""Linear algebra has one thread meanwhile: on a busy machine threads of small matrices wait for one another."""

import sys
from contextlib import nullcontext

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import gfmd_numba
from gfmd_numba.arrays import threads as thread_team
from gfmd_numba.campaign.execution import compute, perform
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.provenance import versions
from gfmd_numba.contact import solution
from gfmd_numba.elasticity import fields
from support.campaigns import campaign
from support.cases import some_of
from support.scenes import SCENE


def threads():
    return {pool["num_threads"] for pool in threadpool_info()}


@pytest.mark.parametrize("door", some_of(["solve", "load_curve", "run", "body_fields"], 0, 1))
def test_it_has_one_thread_wherever_contacts_are_solved(monkeypatch, tmp_path, door):
    seen = []

    def watch(module, name):
        original = getattr(module, name)
        monkeypatch.setattr(module, name, lambda *given: seen.append(threads()) or original(*given))

    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE)
    contact = gfmd_numba.solve(scene)
    watch(solution, "begin")
    watch(fields, "depth_of")
    with threadpool_limits(limits=2):
        before = threads()
        {
            "solve": lambda: gfmd_numba.solve(scene),
            "load_curve": lambda: gfmd_numba.load_curve(scene, [0.01, 0.1]),
            "run": lambda: gfmd_numba.run(campaign(tmp_path), tmp_path / "out", workers=0),
            "body_fields": lambda: gfmd_numba.body_fields(contact),
        }[door]()
        assert threads() == before
    assert seen
    assert all(found == {1} for found in seen)


@pytest.mark.parametrize(
    "solve", [lambda task, folder: perform(task, folder, None), lambda task, _: compute(task, "run", versions(), None)]
)
def test_all_blocks_of_a_task_are_seen_to_once(monkeypatch, tmp_path, solve):
    looked = []
    monkeypatch.setattr(thread_team, "one_thread_of_algebra", lambda: looked.append(1) or nullcontext())
    task = tuple(plan(campaign(tmp_path)).blocks)
    assert len(task) > 1
    (tmp_path / "shards").mkdir()
    solve(task, tmp_path)
    assert looked == [1]


def test_its_libraries_are_looked_for_again_where_modules_may_have_loaded_some(monkeypatch):
    """To find them takes as long as a small contact."""
    looked, found = [], thread_team.ThreadpoolController()
    monkeypatch.setattr(thread_team, "ThreadpoolController", lambda: looked.append(1) or found)
    thread_team._libraries.cache_clear()
    for _ in range(2):
        with thread_team.one_thread_of_algebra():
            assert threads() == {1}
    assert looked == [1]
    monkeypatch.setitem(sys.modules, "loaded_meanwhile", None)
    with thread_team.one_thread_of_algebra():
        assert looked == [1, 1]
    thread_team._libraries.cache_clear()
