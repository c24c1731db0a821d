"""What a run takes in addition to its contacts is part of what is predicted."""

import re
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from gfmd_numba.campaign import overhead
from gfmd_numba.campaign.plan import plan
from gfmd_numba.cli import main
from support.campaigns import campaign


@pytest.fixture
def machine(empty_cache, monkeypatch):
    """One that starts a process in 2 s, and fits each group in 203 s; it counts both."""
    seen = SimpleNamespace(now=0.0, starts=0, fits=[])

    def started(*_, **__):
        seen.starts += 1
        return SimpleNamespace(stdout="2.0\n")

    def fit_tfc(results, **_):
        groups = len(set(zip(results["hurst"].values, results["reduced_pressure"].values, strict=True)))
        seen.fits.append(groups)
        seen.now += groups * 203.0

    monkeypatch.setattr(overhead.subprocess, "run", started)
    monkeypatch.setattr(overhead, "fit_tfc", fit_tfc)
    monkeypatch.setattr(overhead, "time", SimpleNamespace(thread_time=lambda: seen.now))
    return seen


def test_the_fit_is_rehearsed_with_some_groups(tmp_path, machine):
    grid = {"grid: {hurst: [0.3, 0.8]}": "grid: {hurst: [0.2, 0.4, 0.6, 0.8], reduced_pressure: [0.01, 0.1]}"}
    found = overhead.overhead(plan(campaign(tmp_path, **grid)), 0)
    assert machine.fits == [6, 6]
    assert found["fit and picture"] == pytest.approx(8 * 203.0 + 0.4 * 2.0)


def test_a_fit_of_many_realisations_is_rehearsed_with_fewer(tmp_path, empty_cache, monkeypatch):
    now, asked = [0.0], []

    def fit_tfc(results, **_):
        asked.append(results.sizes["realisation"])
        assert results["kappa"].notnull().all()
        assert (results["realisations"] == asked[-1]).all()
        now[0] += 1e-3 * asked[-1]

    monkeypatch.setattr(overhead, "fit_tfc", fit_tfc)
    monkeypatch.setattr(overhead, "time", SimpleNamespace(thread_time=lambda: now[0]))
    monkeypatch.setattr(overhead, "_start", lambda: 0.0)
    found = overhead.overhead(plan(campaign(tmp_path, **{"realisations: 6": "realisations: 300000"})), 0)
    assert max(asked) == 20_000
    assert found["fit and picture"] == pytest.approx(1e-3 * 300_000)


def test_a_campaign_without_limits_has_no_fit(tmp_path, machine):
    planned = plan(campaign(tmp_path, **{"limits:": "# limits:"}))
    assert overhead.overhead(planned, 0)["fit and picture"] == 0.0
    assert not machine.fits


def test_the_start_is_measured_once(tmp_path, machine):
    planned = plan(campaign(tmp_path))
    first, second = overhead.overhead(planned, 0), overhead.overhead(planned, 0)
    assert first["start"] == second["start"] >= 2.0
    assert machine.starts == 1


def test_every_worker_starts_too(tmp_path, machine):
    planned = plan(campaign(tmp_path))
    alone, three = overhead.overhead(planned, 1), overhead.overhead(planned, 3)
    assert three["workers"] == pytest.approx(3 * alone["workers"])
    assert alone["workers"] >= 2.0
    assert overhead.overhead(planned, 0)["workers"] == 0.0


def test_the_time_of_a_plan_is_that_of_all_its_parts(tmp_path, machine):
    said = CliRunner().invoke(main, ["plan", str(campaign(tmp_path)), "--workers=2", "--pilot=0.01"])
    assert said.exit_code == 0, said.output
    total = re.search(r"CPU time +([\d.]+) min", said.output)
    assert float(total[1]) * 60 > 2 * 203 + 2 + 2 * 2
    parts = " ".join(said.output.split())
    assert re.search(r"of CPU time contacts .*, start 2.3 s, workers .* s, .*, fit and picture 6.8 min", parts)
