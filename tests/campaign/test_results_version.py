"""Shards of another version of the tables are never taken for those of this one."""

import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.campaign.plan import plan
from gfmd_numba.contact import evaluation, results_version
from gfmd_numba.contact.observables import OBSERVABLES, Observable
from gfmd_numba.solvers.table import SOLVERS
from support.campaigns import SMALL, campaign

TINY = SMALL.replace("limits", "# limits").replace("hurst: [0.3, 0.8]", "hurst: [0.8]")


@pytest.fixture(autouse=True)
def _fresh():
    results_version.results_version.cache_clear()
    yield
    results_version.results_version.cache_clear()


def test_a_new_observable_is_computed_and_no_old_shard_is_used(tmp_path, monkeypatch):
    path = campaign(tmp_path, TINY)
    gfmd_numba.run(path, tmp_path / "out", workers=0)
    (before,) = {case.problem.identity for case in plan(path).cases}
    toy = Observable("contact", "pressure", "largest pressure", "gfmd_numba.contact.evaluation:largest_pressure")
    monkeypatch.setattr(
        evaluation, "largest_pressure", lambda contact: contact.equilibrium.pressure.max(axis=-1), raising=False
    )
    monkeypatch.setitem(OBSERVABLES, "largest_pressure", toy)
    results_version.results_version.cache_clear()
    (after,) = {case.problem.identity for case in plan(path).cases}
    assert before != after
    dataset = gfmd_numba.run(path, tmp_path / "out", workers=0)
    assert set(dataset["case_id"].values) == {after}
    assert (dataset["status"] == 0).all()
    assert (dataset["largest_pressure"] > dataset["mean_pressure"]).all()
    assert dataset["largest_pressure"].long_name == "largest pressure"
    shards = {file.name.split("-")[0] for file in (tmp_path / "out" / "shards").glob("*.shard")}
    assert shards == {before, after}
    with xr.open_dataset(tmp_path / "out" / "small.nc") as written:
        assert "largest_pressure" in written


def test_the_version_follows_units_and_solvers_but_not_prose(monkeypatch):
    found = results_version.results_version()

    def changed(table, name, **fields):
        with monkeypatch.context() as patch:
            patch.setitem(table, name, type(table[name])(**(vars(table[name]) | fields)))
            results_version.results_version.cache_clear()
            return results_version.results_version()

    assert changed(OBSERVABLES, "kappa", unit="1") != found
    assert changed(SOLVERS, "verlet", gives_up_after=7) != found
    assert changed(OBSERVABLES, "kappa", long_name="another sentence") == found
    assert changed(SOLVERS, "verlet", sentence="another sentence") == found
