"""What may be wrong with a fit of (4.3): data that cannot tell its parameters, exponents at an end, another law."""

from collections.abc import Collection, Sequence

import numpy as np

from gfmd_numba.analysis.fit_dataset import PAIRS, Estimates
from gfmd_numba.analysis.laws import BOUNDS, STEEPEST
from gfmd_numba.analysis.linear_fit import Laws
from gfmd_numba.analysis.posterior import Choice
from gfmd_numba.analysis.selection import LIMITS, Group, fractions
from gfmd_numba.arrays import Reals
from gfmd_numba.theory.exponents import exponent_ranges

_PRESSED = 0.15  # of a range: the mean of an exponent that the data do not know lies in its middle
_AT_THE_END = 0.02  # of a range: the 90 % interval of an exponent that the data press begins closer to its end
_WORTH_A_CROSS_LEVEL = 0.2  # of the error: less hardly adds to it
_COUNTS = 0.05  # share of the weight below which a choice of laws is not spoken of
# ends of the 90 % interval of a free exponent before there are data: beyond them, the data press it against a bound
_LOWEST, _HIGHEST = (float(BOUNDS[0] ** (1 - share) * BOUNDS[1] ** share) for share in (0.05, 0.95))
WIDEST = 8.0  # ratio of the ends of an exponent's 90 % interval beyond which it is not identified


def inseparable(group: Group) -> str:
    """Return why the group's cases cannot determine its coefficients at any exponent, or nothing."""
    if np.isnan(list(group.reference.values())).all():
        return "surfaces have grids and lengths of their own: no discretisation is varied, so there is no limit to fit"
    if not group.levels:
        return "no discretisation is varied over two or more good levels: add levels to the campaign"
    if not group.complete.any():
        return f"no realisation is good in all {group.n_cases} cases: run more, or repeat the failed ones"
    if (np.nan_to_num(group.values[group.complete]) == 0.0).all(axis=0).any():
        return "it is 0 in all realisations of a case: there is nothing to extrapolate"
    columns = [np.exp(0.7 * group.log_ratio(name)) for name in group.levels]
    if np.linalg.matrix_rank(np.column_stack([np.ones(group.n_cases), *columns])) <= len(columns):
        varied = ", ".join(group.levels)
        return f"{group.n_cases} cases cannot tell {varied} apart: add cases in which only one of them differs"
    return ""


def shortage(groups: Sequence[Group], choices: Sequence[Laws]) -> str:
    """Return which free exponent has fewer than three levels in every group, or nothing."""
    for name in LIMITS:
        levels = max((np.unique(group.levels[name]) for group in groups if name in group.levels), key=len, default=None)
        if levels is not None and len(levels) < 3 and _free(choices, name):
            lack = f"exponent of {name} needs three levels, has two ({fractions(levels)})"
            return f"{lack}\n{advice([name], groups[0].variable, groups[0].dimension)}"
    return ""


def _free(choices: Sequence[Laws], limit: str) -> bool:
    """Whether nothing is known of the exponent of a limit."""
    return any(
        parameter.limit == limit and parameter.is_free for laws in choices for parameter in laws[limit].parameters
    )


def doubtful(groups: Sequence[Group], choices: Sequence[Choice], shares: Sequence[Reals]) -> dict[str, str]:
    """Return the free exponents that the data do not identify, and why."""
    doubt = {}
    for limit in LIMITS:
        for choice, share in zip(choices, shares, strict=True):
            for index, parameter in enumerate(choice.parameters):
                if parameter.limit != limit or not parameter.is_free or share.sum() < _COUNTS:
                    continue
                low, high = _ends(choice.nodes[:, index], share)
                found = f"with 90 % interval {low:.3g} to {high:.3g}"
                if low < 1.1 * _LOWEST and high > 0.9 * _HIGHEST:
                    doubt[limit] = "has no influence on the fit"
                elif low < _LOWEST or high > _HIGHEST:
                    doubt[limit] = f"{found} touches the bounds {BOUNDS[0]:g} and {BOUNDS[1]:g}"
                elif high > WIDEST * low:
                    doubt[limit] = f"{found} is uncertain by more than a factor {WIDEST:g}"
    return doubt


def _ends(values: Reals, share: Reals) -> tuple[float, float]:
    """Return the ends of the 90 % interval of weighed values."""
    order = np.argsort(values)
    below = np.cumsum(share[order]) / share.sum()
    # in the middle of each value's share, so that few values do not end at the outermost
    low, high = np.interp([0.05, 0.95], below - share[order] / share.sum() / 2.0, values[order])
    return float(low), float(high)


def pressed(choices: Sequence[Choice], shares: Sequence[Reals]) -> dict[str, str]:
    """Return the limits whose exponent the data press against the low end of its range, and a line for each.

    Where another law is at least as likely, the error has the scatter between the two.
    """
    lines = {}
    for choice, share in zip(choices, shares, strict=True):
        for index, parameter in enumerate(choice.parameters):
            if parameter.logarithmic or parameter.low == parameter.high or share.sum() <= 0.5:
                continue
            low, high = parameter.low, parameter.high
            values = choice.nodes[:, index]
            mean, least = share @ values / share.sum(), _ends(values, share)[0]
            # a small exponent that the data know well is not pressed
            if mean < low + _PRESSED * (high - low) and least < low + _AT_THE_END * (high - low):
                lines[parameter.limit] = (
                    f"exponent of {parameter.limit} lies at the low end of its range, {low:g}, and the true limit may "
                    "be further away: the error has the whole distance from the finest level; allow smaller exponents"
                )
    return lines


def logarithmic(group: Group, choices: Sequence[Choice]) -> list[str]:
    """Return a line for a power of eps_f where octaves add nearly as much slope each: exponents go as 2 - 2 H."""
    steep = "eps_f" in group.levels and group.parameters.get("hurst", 0.0) > STEEPEST
    if not steep or any(choice.laws["eps_f"].whole for choice in choices):
        return []
    return [
        f"near H = 1 {group.variable} may go as 1 / log(1 / eps_f), as kappa does: a power of eps_f may fit, but its "
        f"limit is then not that of {group.variable}"
    ]


def additivity(group: Group, error: Reals) -> list[str]:
    """Return a line where no cross level tells by how much corrections together differ from their sum, if it counts."""
    unknown = Estimates(error).interaction
    off = {name: abs(group.log_ratio(name)) > 1e-9 for name in group.levels}
    pairs = [(number, pair) for number, pair in enumerate(PAIRS) if set(pair) <= set(off)]
    open_ones = [number for number, (first, second) in pairs if not (off[first] & off[second]).any()]
    open_part = float(np.hypot.reduce(unknown[open_ones])) if open_ones else 0.0
    if open_part <= _WORTH_A_CROSS_LEVEL * Estimates(error).tfc:
        return []
    which = "; ".join(" and ".join(PAIRS[number]) for number in open_ones)
    difference = group.shown(open_part)
    return [
        f"no cross level tells whether the corrections of {which} add up, so the error allows for a difference of "
        f"{difference}: add `cross` to the limits, cases in which two eps differ from the reference"
    ]


def realisations(group: Group) -> str:
    """Return how many realisations a group has, in words."""
    return f"{group.n_realisations} realisation{'s' if group.n_realisations != 1 else ''}"


def evidence(group: Group, name: str) -> str:
    """Return what a group knows of a limit: its levels and realisations."""
    if name not in group.levels:
        return f"shared with other groups; {name} is not varied in this one"
    return f"levels {fractions(group.levels[name])}, {realisations(group)}"


def advice(names: Collection[str], variable: str, dimension: int) -> str:
    """Return how to fix exponents where the user stands: at the command line, in the campaign file, in Python."""
    ranges = {name: exponent_ranges(variable, dimension)[name] for name in names}
    options = " ".join(f"--fixed {name}={low:g}:{high:g}" for name, (low, high) in ranges.items())
    block = ", ".join(f"{name}: [{low:g}, {high:g}]" for name, (low, high) in ranges.items())
    return (
        f"give the ranges that exponents of {variable} lie in: `gfmd fit {options}`; `fit: {{fixed: {{{block}}}}}` in "
        f"the campaign file; fixed={ranges} in Python; or add levels or realisations"
    )
