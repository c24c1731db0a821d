"""Random maps under a law of gap and slip, as in the benchmark: each path is solved, and checked by NumPy alone."""

import runpy
from pathlib import Path

import pytest

from gfmd_numba.solvers.status import Status

HUNT = runpy.run_path(str(Path(__file__).parents[2] / "benchmarks" / "map_cohesion_hunt.py"))


def hunt(kind, seeds):
    """Paths that were not solved, and those with a step that is called ok and fails the check."""
    ended = {seed: found for seed in seeds if (found := HUNT["follow"](kind, seed)) is not None}
    unsolved = [seed for seed, (status, _, _) in ended.items() if status != Status.ok]
    return unsolved, [seed for seed, (_, worst, _) in ended.items() if not worst <= 1.0]


@pytest.mark.parametrize("kind", ["cohesive", "rigid"])
def test_random_maps_are_solved(kind):
    assert hunt(kind, range(20, 25)) == ([], [])


def test_a_map_is_solved_that_slips_so_far_that_the_energy_vanishes_there():
    assert hunt("cohesive", [1523]) == ([], [])


@pytest.mark.long
@pytest.mark.parametrize("kind", ["cohesive", "rigid"])
def test_sixty_random_maps_are_solved(kind):
    assert hunt(kind, range(100, 160)) == ([], [])


def test_the_check_sees_a_wrong_displacement_along_y():
    path = HUNT["load_path"](HUNT["read_contact"](*HUNT["load_scene"](HUNT["random_scene"]("cohesive", 0))))
    contact = next(HUNT["solve_path"](path))
    assert HUNT["violation"](path.problems[0], contact, (0.0, 0.0))[0] <= 1.1e-8
    sideways = contact.equilibrium.tangential.displacement
    sideways[0, 1, 3, 3] += 1e-6 * abs(contact.equilibrium.displacement).max()
    assert HUNT["violation"](path.problems[0], contact, (0.0, 0.0))[0] > 1e-6
