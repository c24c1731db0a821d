"""A small campaign that has run, a machine on which nothing was measured before, and what workers are given."""

import pickle

import pytest

import gfmd_numba
from gfmd_numba.campaign import execution
from gfmd_numba.campaign.run import run as run_campaign
from gfmd_numba.campaign.workers import Workers
from support.campaigns import campaign


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("finished")
    path, failures = run_campaign(campaign(folder), folder / "out", Workers(0))
    assert failures == {}
    return gfmd_numba.open_campaign(path)


@pytest.fixture
def pickled(monkeypatch):
    """This process works at copies of its tasks that were pickled, as a worker does."""
    perform = execution.perform

    def at_a_copy(task, *others, **options):
        return perform(pickle.loads(pickle.dumps(task)), *others, **options)

    monkeypatch.setattr(execution, "perform", at_a_copy)


@pytest.fixture
def empty_cache(tmp_path, monkeypatch):
    monkeypatch.setattr("gfmd_numba.storage.cache.directory", lambda: tmp_path / "cache")
    (tmp_path / "cache").mkdir()
