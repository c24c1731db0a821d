"""A campaign that runs until its limit has the error you want: what the terminal shows meanwhile, and how it ends."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from re import sub
from typing import TYPE_CHECKING

import click

from gfmd_numba.cli.progress import progress_bar
from gfmd_numba.cli.tables import duration
from gfmd_numba.cli.terminal import say
from gfmd_numba.text.input_error import InputError

if TYPE_CHECKING:
    from gfmd_numba.campaign.block_work import Failures
    from gfmd_numba.campaign.execution import Workers
    from gfmd_numba.campaign.goal import Goal
    from gfmd_numba.campaign.plan import Plan
    from gfmd_numba.campaign.rounds import Round, Rounds
    from gfmd_numba.campaign.run import Choice, Watch
    from gfmd_numba.campaign.until import Outcome, Told

    Show = Callable[[Path, Failures], bool]


def check_options(until: object, budget: float | None, choice: Choice) -> None:
    """Raise a usage error for options that do not go together."""
    if not until and budget is not None:
        raise click.UsageError(
            "--budget: you gave no --until, whose processor time it bounds, and FILE has no target; give both, or none"
        )
    if until and (choice.only or choice.limit):
        name = "--only" if choice.only else "--limit"
        allowed = "one of the two, as the error of a limit needs all cases"
        raise click.UsageError(f"{name}: you gave --until, or a target in FILE, as well; gfmd allows {allowed}")


def run_rounds(
    file: Path,
    output: Path | None,
    workers: Workers,
    choice: Choice,
    until: dict[str, float],
    budget: float | None,
    show: Show,
) -> bool:
    """Run a campaign until its limit has an error, and show the results; return False if that or some blocks failed.

    If Ctrl-C stops it, the best estimate is shown first.
    """
    from gfmd_numba.campaign.until import InterruptedRunError, run_until

    try:
        with options_named("until"), rounds_shown() as (watch, told):
            outcome = run_until(file, goal_in(file, until, budget), output, workers, watch, choice, told)
    except InterruptedRunError as interrupted:
        _show(interrupted.outcome, show)
        raise
    return _show(outcome, show) and outcome.reached


def goal_in(file: Path, until: dict[str, float], budget: float | None) -> Goal:
    """Return the goal of a campaign in a file: without a name, an error of what the campaign fits."""
    from gfmd_numba.campaign.file import fitted_variable
    from gfmd_numba.campaign.goal import goal_of

    return goal_of({variable or fitted_variable(file): target for variable, target in until.items()}, budget)


@contextmanager
def options_named(target: str) -> Iterator[None]:
    """Name the options of the command in errors that name the arguments of the Python function."""
    named = {"until": f"--{target}:", "budget": "--budget:"}
    try:
        yield
    except InputError as error:
        lines = (sub(r"^(until|budget):", lambda found: named[found[1]], str(line)) for line in error.args)
        raise InputError(*lines, more=error.more) from None


@contextmanager
def rounds_shown() -> Iterator[tuple[Watch, Told]]:
    """Yield two functions that show the rounds of a run, each with its progress."""
    caption = ["blocks"]

    def told(rounds: Rounds, planned: Plan, left: int) -> None:
        caption[0] = _tell(rounds, planned, left)

    with progress_bar(lambda: caption[0]) as watch:
        yield watch, told


def levels_of(now: Round) -> str:
    """Return how fine the levels of a round are."""
    import numpy as np

    from gfmd_numba.analysis.selection import fractions
    from gfmd_numba.campaign.axes import DISCRETISATIONS

    finest = [min(level[i] for of_group in now.levels for level in of_group) for i in range(len(DISCRETISATIONS))]
    shown = [f"{name} to {fractions(np.array([eps]))}" for name, eps in zip(DISCRETISATIONS, finest, strict=True)]
    return f"{', '.join(shown)}: {len(now.realisations)} cases"


def _tell(rounds: Rounds, planned: Plan, left: int) -> str:
    """Say what a round is about to do, and return the caption of its progress bar."""
    from gfmd_numba.campaign.cross_levels import added
    from gfmd_numba.campaign.file import is_without_levels

    number, now = len(rounds.rounds) - 1, rounds.now
    chosen = is_without_levels(planned.document, planned.campaign)
    if left and now.levels != (rounds.rounds[-2].levels if number else ()) and (number or chosen):
        say("levels", levels_of(now), err=True)
    if number == 0:
        if left and not chosen and (crossed := added(planned)):
            say("added", f"cross levels {crossed}, to see whether corrections add up", err=True)
        if left:
            say("round", f"0, the pilot: {left} simulations", err=True)
        return "pilot"
    before, targets = rounds.rounds[-2], rounds.goal.targets
    aims = []
    for name, target in targets.items():
        found = before.told_of(name)["error"]
        error = "unknown" if found is None else f"{found:.2%}"
        aims.append((f"{name} " if len(targets) > 1 else "", error, f"{target:.2%}"))
    of_which = f" of {now.variable}" if len(targets) > 1 else ""
    expected = "" if now.predicted_error is None else f", {now.predicted_error:.2%}{of_which} expected"
    cost = [
        f"{duration(max(0.0, price - before.price) * rounds.seconds_per_price)} {what}"
        for price, what in (
            (now.price, "of processor time"),
            (now.target_price, f"until the target{of_which} is reached"),
        )
        if price is not None and before.price is not None and rounds.seconds_per_price is not None
    ]
    takes = f"; about {', '.join(cost)}" if cost else ""
    if left:
        aim = ", ".join(f"{name}error {error}, target {target}" for name, error, target in aims)
        say("round", f"{number}: {aim}; {left} simulations more{expected}{takes}", err=True)
    return f"round {number}, {', '.join(f'{name}{error} of {target}' for name, error, target in aims)}"


def _show(outcome: Outcome, show: Show) -> bool:
    well = show(outcome.results, outcome.failures)
    if outcome.n_unused:
        say(
            "note",
            f"{outcome.n_unused} more simulations of an earlier run lie in {outcome.results.parent}: this target does "
            "not need them, and they are kept for a smaller one",
        )
    return well
