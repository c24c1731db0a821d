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
    """One that starts a process in 2 s, and counts how often it does."""
    seen = SimpleNamespace(starts=0)

    def started(*_, **__):
        seen.starts += 1
        return SimpleNamespace(stdout="2.0\n")

    monkeypatch.setattr(overhead.subprocess, "run", started)
    return seen


def test_a_fit_takes_longer_for_more_groups_limits_and_steps(tmp_path, machine):
    grid = {"grid: {hurst: [0.3, 0.8]}": "grid: {hurst: [0.2, 0.4, 0.6, 0.8]}"}
    path = {"name: small": "name: small\npath: [{reduced_pressure: 0.1}]"}
    limit = {", eps_f: [1/8, 1/16, 1/32]}": "}"}
    two, four, along, one = (
        overhead.overhead(plan(campaign(tmp_path, **changed))).fit - 0.4 * 2.0 for changed in ({}, grid, path, limit)
    )
    assert four == pytest.approx(2.0 * two)
    assert along == pytest.approx(2.0 * two)
    assert one == pytest.approx(0.5 * two, rel=0.01)


def test_a_campaign_without_limits_has_no_fit(tmp_path, machine):
    planned = plan(campaign(tmp_path, **{"limits:": "# limits:"}))
    assert overhead.overhead(planned).fit == 0.0


def test_the_start_is_measured_once(tmp_path, machine):
    planned = plan(campaign(tmp_path))
    first, second = overhead.overhead(planned), overhead.overhead(planned)
    assert first.start == second.start >= 2.0
    assert machine.starts == 1


def test_every_worker_starts_too(tmp_path, machine):
    found = overhead.overhead(plan(campaign(tmp_path)))
    assert found.cpu_seconds(3) - found.cpu_seconds(0) == pytest.approx(3 * found.worker)
    assert found.wall_seconds(3) - found.wall_seconds(0) == pytest.approx(found.worker)
    assert found.worker >= 2.0


def test_the_time_of_a_plan_is_that_of_all_its_parts(tmp_path, machine):
    said = CliRunner().invoke(main, ["plan", str(campaign(tmp_path)), "--workers=2", "--pilot=0.01"])
    assert said.exit_code == 0, said.output
    total = re.search(r"CPU time +([\d.]+) s", said.output)
    assert float(total[1]) > 2.3 + 2 * 3.2 + 0.8
    parts = " ".join(said.output.split())
    assert re.search(r"of CPU time contacts .*, start 2.3 s, workers .* s, .*, fit and picture 0.9 s", parts)
