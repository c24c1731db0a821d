"""The predicted cost of maps too large for a pilot: smaller ones tell it."""

import pytest

from gfmd_numba.campaign import cost
from gfmd_numba.campaign.plan import plan
from support.campaigns import MAPS, campaign
from support.costs import noise, predicted, true_seconds

ISOTROPIC = "{reduced_pressure: [0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32], eps_c: [1/2, 1/4]}"
ANISOTROPIC = "{anisotropy: [1, 2, 4], reduced_pressure: [0.01, 0.1], eps_c: [1/2, 1/4]}"


@pytest.fixture
def machine(empty_cache, monkeypatch):
    """One that is told how many times slower anisotropic maps are; it lists the grids of its pilot."""
    grids = []

    def law(problem, *_):
        grids.append(problem.surface.nx)
        return seconds(problem) * noise(problem)

    monkeypatch.setattr(cost, "_measured", law)
    return grids


def seconds(problem):
    return true_seconds(problem) * problem.surface.generator.anisotropy**0.7


def maps(folder, grid):
    text = f"{MAPS}reference: {{eps_c: 1/4, eps_f: 1/50, eps_t: 1/4}}\ngrid: {grid}\n"
    return plan(campaign(folder, text, **{"realisations: 2": "realisations: 4"}))


@pytest.mark.parametrize("grid", [ISOTROPIC, pytest.param(ANISOTROPIC, marks=pytest.mark.long)])
@pytest.mark.parametrize("budget", [0.5, 10.0])
def test_smaller_maps_predict_those_that_take_too_long(tmp_path, machine, grid, budget):
    planned = maps(tmp_path, grid)
    found = predicted(planned, budget)
    assert min(machine) < 800
    total = 4 * sum(map(seconds, planned.problems))
    assert found.quantile(0.5) == pytest.approx(total, rel=0.5)
    assert found.quantile(0.05) < total < found.quantile(0.95)
    assert found.quantile(0.9) < 2.5 * total


def test_a_pilot_keeps_to_its_budget(tmp_path, machine):
    planned = maps(tmp_path, ISOTROPIC)
    found = predicted(planned, budget=0.2)
    assert found.pilot == 0
    assert 0 < found.smaller == len(machine)


def test_how_time_goes_with_anisotropy_is_learnt(tmp_path, machine):
    planned = maps(tmp_path, ANISOTROPIC)
    found = predicted(planned)
    slow, fast = (
        sum(found.seconds[p.identity] for p in planned.problems if p.surface.generator.anisotropy == gamma)
        for gamma in (4, 1)
    )
    assert slow / fast == pytest.approx(4**0.7, rel=0.3)


def test_a_map_has_the_same_physics_on_a_smaller_grid(tmp_path):
    """Waves that fit it, as many nodes to the shortest, and long ones along y that fit the period."""
    for problem in maps(tmp_path, ANISOTROPIC).problems:
        surface = problem.surface
        for smaller in cost._smaller(problem):
            nx, waves = smaller.surface.nx, smaller.surface.generator
            assert 64 <= nx < surface.nx
            assert waves.anisotropy <= waves.longest_wave_index <= waves.shortest_wave_index <= nx // 2
            assert nx / waves.shortest_wave_index == pytest.approx(
                surface.nx / surface.generator.shortest_wave_index, rel=0.1
            )
            assert (smaller.body, smaller.mean_pressure) == (problem.body, problem.mean_pressure)
