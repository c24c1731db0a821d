"""Fits of fewer levels, or of exponents that nobody asserts: where they disagree with a fit, its laws do not hold."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gfmd_numba.analysis.laws import Given
from gfmd_numba.analysis.selection import LIMITS, Group, fractions
from gfmd_numba.arrays import Reals
from gfmd_numba.theory.exponents import exponent_ranges

_FEWEST = 4  # levels of a limit, of which one may be left out
_SIGNIFICANT = 2.0  # standard deviations by which a rival may differ by chance


@dataclass(frozen=True)
class Rival:
    """Another fit of the same groups, and what it does differently, in words.

    `asserted` is the limit whose exponent the fit asserts and the rival does not, "" where the rival has fewer levels.
    """

    what: str
    groups: list[Group]
    given: Given
    asserted: str = ""


def rivals(groups: Sequence[Group], given: Given) -> Iterator[Rival]:
    """Yield the fits without the coarsest or finest level of a limit, and with the range of an asserted exponent."""
    expected = exponent_ranges(groups[0].dimension, max(group.parameters.get("hurst", np.nan) for group in groups))
    for limit in LIMITS:
        levels = _levels(groups, limit)
        if len(levels) >= _FEWEST:
            for name, level in (("coarsest", levels[-1]), ("finest", levels[0])):
                what = f"without the {name} level of {limit}, {fractions(np.array([level]))}"
                yield Rival(what, _without(groups, limit, level), given)
        low, high = given.get(limit, (0.0, 1.0))
        if low == high and len(levels) > 2:
            low, high = expected[limit]
            what = f"with an exponent of {limit} between {low:g} and {high:g}, as the levels tell it,"
            yield Rival(what, list(groups), {**given, limit: expected[limit]}, asserted=limit)


def without_coarsest(groups: Sequence[Group]) -> tuple[str, list[Group]] | None:
    """Return the groups without the coarsest level of a limit, and what it was; None where none can be spared."""
    for limit in ("eps_f", "eps_t", "eps_c"):
        levels = _levels(groups, limit)
        if len(levels) >= _FEWEST:
            return f"{limit} = {fractions(levels[-1:])}", _without(groups, limit, levels[-1])
    return None


def disagreement(value: float, variance: float, rival: float, rival_variance: float) -> float:
    """Return by how much more a rival differs than its own scatter explains."""
    by_chance = _SIGNIFICANT**2 * max(rival_variance - variance, 1e-3 * variance)
    return float(np.copysign(np.sqrt(max(0.0, (rival - value) ** 2 - by_chance)), rival - value))


def _levels(groups: Sequence[Group], limit: str) -> Reals:
    """Return the levels of a limit that all groups have, from fine to coarse."""
    levels = [set(group.levels[limit].tolist()) for group in groups if limit in group.levels]
    return np.sort(list(set.intersection(*levels))) if levels else np.empty(0)


def _without(groups: Sequence[Group], limit: str, level: float) -> list[Group]:
    return [group.without(limit, level) if limit in group.levels else group for group in groups]
