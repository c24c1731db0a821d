"""What the shards in an output directory tell: how far each case is, what it cost, and what nobody asked for."""

from collections.abc import Sequence
from pathlib import Path

from gfmd_numba.campaign import failures
from gfmd_numba.campaign.block_work import SECONDS
from gfmd_numba.campaign.execution import held
from gfmd_numba.campaign.plan import Plan
from gfmd_numba.campaign.price import price_of_transform
from gfmd_numba.campaign.shards import Finished


def finished(planned: Plan, directory: Path, fewest: Sequence[int]) -> list[int]:
    """Realisations (case) from the first one up to which all have ended, but no less than the fewest (case)."""
    reach: dict[str, int] = {}
    stopped: set[str] = set()
    stored = Finished(directory)
    for block in planned.blocks_in(directory):  # those of a problem come in order
        identity = block.problem.identity
        ended = block.name in stored or failures.of(directory, block.name) is not None
        if ended and identity not in stopped:
            reach[identity] = block.stop
        elif not ended:
            stopped.add(identity)
    cases = zip(planned.cases, fewest, strict=True)
    return [max(least, min(case.realisations, reach.get(case.problem.identity, 0))) for case, least in cases]


def seconds_per_price(planned: Plan, directory: Path) -> float | None:
    """Processor time in s over the price, of all shards of a plan; None where none tells."""
    seconds = price = 0.0
    stored = Finished(directory)
    for block in planned.blocks_in(directory):
        measured = stored.read(block.name)
        if measured is not None:
            seconds += float(measured[SECONDS].sum())
            price += float(measured["n_transforms"].sum() * price_of_transform(block.problem.surface.nodes))
    return seconds / price if seconds > 0 and price > 0 else None


def unused(planned: Plan, directory: Path) -> int:
    """Number of simulations in a directory that are of a plan's problems, and more than it asks for."""
    reach = {identity: max(stop for _, stop in ranges) for identity, ranges in held(Finished(directory)).items()}
    return sum(max(0, reach.get(identity, 0) - wanted) for identity, wanted in planned.demand.items())
