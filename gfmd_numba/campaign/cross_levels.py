"""Cross levels that a pilot adds to a campaign without any, to see whether its corrections add up."""

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations, product
from math import prod

from gfmd_numba.analysis.selection import at_nyquist
from gfmd_numba.campaign.axes import DISCRETISATIONS
from gfmd_numba.campaign.cases import expand
from gfmd_numba.campaign.doubts import is_resolved
from gfmd_numba.campaign.file import Campaign, load_campaign
from gfmd_numba.campaign.limits import CROSS, Limits
from gfmd_numba.campaign.plan import Plan
from gfmd_numba.scene import InputError
from gfmd_numba.text.input_error import ABSENT


def with_cross_levels(planned: Plan) -> Plan:
    """Return the plan with the coarsest cross level of each pair of limits, if its campaign has none."""
    if planned.campaign.limits.crossed:
        return planned
    pairs = combinations(_usable_levels(planned.campaign).items(), 2)
    found = [next(_usable(planned.campaign, *pair), None) for pair in pairs]
    levels = [level for level in found if level is not None]
    if not levels:
        return planned
    return planned.changed(limits=_with(planned.campaign, levels).limits)


def added(planned: Plan) -> str:
    """Return the cross levels that were added to a plan, as one would write them in the campaign file."""
    given = planned.document.value(("limits", CROSS))
    return as_written(planned.campaign) if planned.campaign.limits.crossed and given in (ABSENT, None) else ""


def as_written(campaign: Campaign) -> str:
    """Return the cross levels of a campaign on one line, as its file would have them."""
    levels = [
        ", ".join(f"{axis}: {_fraction(eps)}" for axis, eps in level.items()) for level in campaign.limits.crossed
    ]
    return f"[{', '.join(f'{{{level}}}' for level in levels)}]"


def _usable_levels(campaign: Campaign) -> dict[str, list[float]]:
    """Return the levels of each limit that have surfaces and enter a fit."""
    found: dict[str, list[float]] = {}
    for placed in campaign.discretisations():
        if placed.limit in DISCRETISATIONS:
            eps = getattr(placed.discretisation, placed.limit)
            if placed.limit != "eps_c" or not at_nyquist(eps):
                found.setdefault(placed.limit, []).append(eps)
    return found


def _usable(
    campaign: Campaign, one: tuple[str, list[float]], other: tuple[str, list[float]]
) -> Iterator[dict[str, float]]:
    """Yield the cross levels of two limits that the campaign may have, the coarsest first."""
    for chosen in sorted(product(one[1], other[1]), key=prod, reverse=True):
        level = dict(zip((one[0], other[0]), chosen, strict=True))
        crossed = _with(campaign, [level])
        try:
            load_campaign(crossed)
        except InputError:  # waves that are not whole, or too coarse a grid
            continue
        if is_resolved(expand(crossed)):
            yield level


def _with(campaign: Campaign, levels: list[dict[str, float]]) -> Campaign:
    given = campaign.limits.model_dump(exclude_unset=True)
    return campaign.model_copy(update={"limits": Limits.model_validate(given | {CROSS: levels})})


def _fraction(eps: float) -> str:
    """Return a fraction that is read as the same number, or else the number itself."""
    near = Fraction(eps).limit_denominator(10**9)
    return str(near) if near.numerator / near.denominator == eps else repr(eps)
