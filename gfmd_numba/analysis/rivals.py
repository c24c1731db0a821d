"""Fits of fewer levels, or of exponents that nobody asserts: where they disagree with a fit, its laws do not hold."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gfmd_numba.analysis.fit_warnings import inseparable
from gfmd_numba.analysis.laws import Given, choices
from gfmd_numba.analysis.selection import LIMITS, Group, fractions
from gfmd_numba.arrays import Reals
from gfmd_numba.theory.exponents import exponent_ranges

_FEWEST = 4  # levels of a limit, of which one may be left out
_SIGNIFICANT = 2.0  # standard deviations by which a rival may differ by chance


@dataclass(frozen=True)
class Rival:
    """Another fit of the same groups, and what it does differently, in words.

    `asserted` is the limit whose exponent the fit asserts and the rival does not, "" where the rival has fewer levels.
    A rival `from_theory` is better founded than the fit, whose error is then not below that of the rival.
    """

    what: str
    groups: list[Group]
    given: Given
    asserted: str = ""
    from_theory: bool = False

    def doubt(self, value: float, variance: float, rival: float, rival_variance: float) -> float:
        """Return the error of a fitted value that is due to this rival."""
        if not self.from_theory:
            return abs(disagreement(value, variance, rival, rival_variance))
        return float(np.sqrt((rival - value) ** 2 + max(0.0, rival_variance - variance)))


def rivals(groups: Sequence[Group], given: Given) -> Iterator[Rival]:
    """Yield the fits without the coarsest or finest level of a limit, by theory, and without asserted exponents."""
    hursts = [group.parameters.get("hurst", np.nan) for group in groups]
    expected = exponent_ranges(groups[0].variable, groups[0].dimension, max(hursts))
    for limit in LIMITS:
        levels = _levels(groups, limit)
        if len(levels) >= _FEWEST:
            for name, level in (("coarsest", levels[-1]), ("finest", levels[0])):
                if (fewer := _without(groups, limit, level)) is not None:
                    yield Rival(f"without the {name} level of {limit}, {fractions(np.array([level]))}", fewer, given)
        low, high = given.get(limit, (0.0, 1.0))
        asserted = limit if low == high else ""
        others = {name: each for name, each in given.items() if name != limit}
        by_theory = {law.name for laws in choices([limit], groups, others) for law in laws.values()}
        by_fit = {law.name for laws in choices([limit], groups, given) for law in laws.values()}
        if by_theory != by_fit:
            yield Rival("by the law of the unseen slope alone", list(groups), others, asserted, from_theory=True)
        elif asserted and len(levels) > 2:
            what = "with an exponent of {} between {:g} and {:g}, as the levels tell it,".format(
                limit, *expected[limit]
            )
            yield Rival(what, list(groups), {**given, limit: expected[limit]}, asserted)


def without_coarsest(groups: Sequence[Group]) -> tuple[str, list[Group]] | None:
    """Return the groups without the coarsest level of a limit, and what it was; None where none can be spared."""
    for limit in ("eps_f", "eps_t", "eps_c"):
        levels = _levels(groups, limit)
        if len(levels) >= _FEWEST and (fewer := _without(groups, limit, levels[-1])) is not None:
            return f"{limit} = {fractions(levels[-1:])}", fewer
    return None


def disagreement(value: float, variance: float, rival: float, rival_variance: float) -> float:
    """Return by how much more a rival differs than its own scatter explains."""
    by_chance = _SIGNIFICANT**2 * max(rival_variance - variance, 1e-3 * variance)
    return float(np.copysign(np.sqrt(max(0.0, (rival - value) ** 2 - by_chance)), rival - value))


def _levels(groups: Sequence[Group], limit: str) -> Reals:
    """Return the levels of a limit that all groups have, from fine to coarse."""
    levels = [set(group.levels[limit].tolist()) for group in groups if limit in group.levels]
    return np.sort(list(set.intersection(*levels))) if levels else np.empty(0)


def _without(groups: Sequence[Group], limit: str, level: float) -> list[Group] | None:
    """Return the groups without a level of a limit; None if the rest cannot tell the correction of each limit."""
    fewer = [group.without(limit, level) if limit in group.levels else group for group in groups]
    same = all(each.levels.keys() == group.levels.keys() for each, group in zip(fewer, groups, strict=True))
    return fewer if same and not any(inseparable(each) for each in fewer) else None
