"""Random paths with laws between the surfaces, as in the benchmark: each is solved, and checked by NumPy alone."""

import runpy
from pathlib import Path

import pytest

from gfmd_numba.solvers.status import Status
from support.cases import some_of

HUNT = runpy.run_path(str(Path(__file__).parents[2] / "benchmarks" / "law_hunt.py"))
MODERATE = (
    *("exponential", "cohesive", "rigid", "friction", "friction_and_law", "friction_and_repulsion"),
    *("rigid_friction_and_law", "sticking_and_law", "limited_friction", "limited_friction_and_other_law"),
)


def hunt(kind, seeds):
    """Paths that were not solved, and those with a step that is called ok and fails the check."""
    ended = {seed: found for seed in seeds if (found := HUNT["follow"](kind, seed)) is not None}
    unsolved = [seed for seed, (status, _, _) in ended.items() if status != Status.ok]
    return unsolved, [seed for seed, (_, worst, _) in ended.items() if not worst <= 1.0]


@pytest.mark.parametrize("kind", some_of([kind for kind in MODERATE if kind != "rigid"], 1, 3, 8))
def test_random_paths_are_solved(kind):
    assert hunt(kind, range(1)) == ([], [])


@pytest.mark.long
@pytest.mark.parametrize("kind", MODERATE)
def test_more_random_paths_are_solved(kind):
    assert hunt(kind, range(100, 101 if kind == "rigid" else 102)) == ([], [])  # those take ten times as long


@pytest.mark.long
def test_what_would_jump_open_and_shut_at_a_rigid_mean_is_solved():
    """The law softens nearly as fast as the shortest wave stiffens, so that volume moves node by node."""
    assert hunt("rigid", (231, 798, 1161)) == ([], [])


@pytest.mark.long
def test_tractions_too_small_to_square_end_a_newton_step():
    """At the last displacement of a random path, at which no node touches."""
    scene = HUNT["random_scene"]("cohesive", 2020)
    scene["scene"]["loading"] = {"displacement": scene["path"][-1]["displacement"]}
    problem, _ = HUNT["read_contact"](*HUNT["load_scene"](scene | {"path": []})).reduced
    (contact,) = HUNT["solve_path"](problem, 0)
    assert contact.equilibrium.status[0] == Status.ok
    assert 0.0 < abs(contact.equilibrium.pressure).max() < 1e-80
    assert HUNT["violation"](problem, contact, 0.0, None)[0] <= 1.1e-8


@pytest.mark.parametrize(("kind", "seed"), [("exponential", 3305), ("other_law", 3141)])
def test_a_body_that_is_drawn_off_until_hardly_anything_acts_is_solved(kind, seed):
    """Its restoring traction falls by 50 powers of ten, of which sums keep 16."""
    assert hunt(kind, (seed,)) == ([], [])


def test_the_check_sees_a_wrong_displacement():
    scene = HUNT["random_scene"]("cohesive", 0)
    problem, _ = HUNT["read_contact"](*HUNT["load_scene"](scene)).reduced
    contact = next(HUNT["solve_path"](problem, 0))
    assert HUNT["violation"](problem, contact, 0.0, None)[0] <= 1.1e-8
    contact.equilibrium.displacement[0, 3] -= 1e-6 * abs(contact.equilibrium.displacement).max()
    assert HUNT["violation"](problem, contact, 0.0, None)[0] > 1e-6
