"""How far a campaign is, and whether its files are sound, from what lies in its output directory."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby, takewhile
from pathlib import Path

from gfmd_numba.campaign import failures, rounds
from gfmd_numba.campaign.cases import Block, groups
from gfmd_numba.campaign.collection import NOTES, is_altered, results_path
from gfmd_numba.campaign.cost import price_of_transform
from gfmd_numba.campaign.execution import SECONDS
from gfmd_numba.campaign.failures import Failure
from gfmd_numba.campaign.output_directory import LABEL, MARK, at_work, check_label
from gfmd_numba.campaign.plan import Plan, plan
from gfmd_numba.campaign.rounds import Rounds
from gfmd_numba.campaign.shards import Finished
from gfmd_numba.storage.atomic_file import foreign as foreign_file
from gfmd_numba.storage.mark import is_note
from gfmd_numba.text.printable import word

_OTHERS = "a file that gfmd did not write, or that was changed since"


@dataclass(frozen=True)
class Progress:
    """Blocks of a campaign: in all, done and failed; `seconds_left` is None if it cannot be estimated.

    `retry` has the command that runs each failed block again, in one process. `ended` says how a run with a target has
    ended, and is empty if it has not; None without a target.
    """

    campaign: str
    running: bool
    blocks: int
    done: int
    failed: dict[str, Failure]
    seconds_left: float | None
    retry: dict[str, str]
    ended: str | None


@dataclass(frozen=True)
class Verdict:
    """How many blocks are sound or missing, and the names of `damaged` ones and of `foreign` ones of other campaigns.

    `altered` has other files that are not as a run left them, with what they are and what to do.
    """

    sound: int
    damaged: list[str]
    missing: int
    foreign: list[str]
    altered: dict[Path, str]


def campaign_in(directory: Path) -> tuple[Plan, Rounds | None]:
    """Return the plan in an output directory, and the rounds whose last one it is, if any; raises InputError."""
    check_label(directory)
    found = rounds.read(directory)
    if found is None:
        return plan(directory / LABEL), None
    planned = plan(directory / LABEL, found.goal.targets)
    piloted = rounds.pilot_plan(planned, found.goal)
    return (rounds.in_round(piloted, found.now), found) if found.of(groups(piloted.cases)) else (planned, None)


def progress(directory: Path) -> Progress:
    """Return the progress of the campaign in a directory, by the names of its finished blocks; raises InputError."""
    planned, found = campaign_in(directory)
    blocks = planned.blocks_in(directory)
    stored = Finished(directory)
    begun = (directory / MARK).stat().st_mtime
    done = [block for block in blocks if block.name in stored]
    missing = {block.name: block for block in blocks if block.name not in stored}
    failed = failures.of_all(directory, missing)
    left = sum(_work(block) for name, block in missing.items() if name not in failed)
    recent = sum(_work(block) for block in done if stored.written(block.name) >= begun)  # since the run began
    seconds_left = left * max(0.0, time.time() - begun) / recent if recent > 0.0 else None
    again = (
        f"gfmd run {word(directory / LABEL)} --output {word(directory)} --only case_id={{}} --retry-failed --workers 0"
    )
    return Progress(
        campaign=planned.campaign.name,
        running=at_work(directory),
        blocks=len(blocks),
        done=len(done),
        failed=failed,
        seconds_left=seconds_left if left > 0.0 else 0.0,
        retry={name: again.format(missing[name].problem.identity) for name in failed},
        ended=None if found is None else found.ended,
    )


def verify(directory: Path) -> Verdict:
    """Compare the files of the campaign in a directory with their digests.

    Raises InputError, and AlteredError if it is not sure to which campaign they belong.
    """
    planned, _ = campaign_in(directory)
    expected = {block.name for block in planned.blocks_in(directory)}
    sound = 0
    damaged: list[str] = []
    foreign: list[str] = []
    problems = {problem.identity for problem in planned.problems}
    stored = Finished(directory)
    for name in sorted(stored):
        ours = name in expected or name.rsplit("-", 2)[0] in problems  # also of more realisations than now
        if ours and stored.is_sound(name):
            sound += 1
        else:
            (damaged if name in expected else foreign).append(name)
    damaged += sorted(file.name for file in stored.unreadable)
    altered = {file: f"{_OTHERS}: move it away, and `gfmd run` computes its blocks again" for file in stored.foreign}
    notes = (directory / NOTES, directory / rounds.FILE, *(failures.path_of(directory, b.name) for b in planned.blocks))
    altered |= {note: f"{_OTHERS}: it is not used, move it away" for note in notes if foreign_file(note, is_note)}
    results = results_path(planned, directory)
    if foreign_file(results):
        altered[results] = f"{_OTHERS}: move it away, and `gfmd collect {word(directory)}` writes it again"
    elif results.exists() and is_altered(results, planned):
        altered[results] = f"differs from its digest: `gfmd collect {word(directory)}` writes it again"
    return Verdict(sound, damaged, len(expected.difference(stored)), foreign, altered)


def finished(planned: Plan, directory: Path, fewest: Sequence[int]) -> list[int]:
    """Return how many realisations (case) have ended, without a gap after the first, but at least the fewest (case)."""
    blocks, stored = planned.blocks_in(directory), Finished(directory)
    ended = stored.keys() | failures.of_all(directory, [block.name for block in blocks])
    reach: dict[str, int] = {}
    for name, each in groupby(blocks, lambda block: block.problem.identity):  # in order
        reach[name] = max((block.stop for block in takewhile(lambda block: block.name in ended, each)), default=0)
    cases = zip(planned.cases, fewest, strict=True)
    return [max(least, min(case.realisations, reach.get(case.problem.identity, 0))) for case, least in cases]


def seconds_per_price(planned: Plan, directory: Path) -> float | None:
    """Return processor time in s over price of all shards of a plan; None without shards."""
    seconds = price = 0.0
    stored = Finished(directory)
    for block in planned.blocks_in(directory):
        measured = stored.read(block.name)
        if measured is not None:
            seconds += float(measured[SECONDS].sum())
            price += float(measured["n_transforms"].sum() * price_of_transform(block.problem.surface.nodes))
    return seconds / price if seconds > 0 and price > 0 else None


def _work(block: Block) -> float:
    return block.size * block.problem.n_loads * float(price_of_transform(block.problem.surface.nodes))
