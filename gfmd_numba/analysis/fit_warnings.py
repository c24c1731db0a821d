"""What may be wrong with a fit of (4.3): data that cannot tell its parameters, exponents at an end, another law."""

from collections.abc import Collection, Sequence

import numpy as np

from gfmd_numba.analysis.estimates import Estimates
from gfmd_numba.analysis.exponents import Given, Ranges
from gfmd_numba.analysis.least_squares import BOUNDS, WhitenedGroup, project
from gfmd_numba.analysis.selection import LIMITS, Group, fractions
from gfmd_numba.arrays import Reals

_PRESSED = 0.05  # of a range: the median of an exponent that the data do not know lies in its middle
_STEEPEST = 0.9  # Hurst exponent whose exponent of eps_f, 0.2, can be told from 0
WIDEST = 8.0  # ratio of the ends of an exponent's 90 % interval beyond which it is not identified


def inseparable(group: Group) -> str:
    """Return why the group's cases cannot determine its coefficients at any exponent, or nothing."""
    if np.isnan(list(group.reference.values())).all():
        return "surfaces have grids and lengths of their own: no discretisation is varied, so there is no limit to fit"
    if not group.levels:
        return "no discretisation is varied over two or more good levels: add levels to the campaign"
    if not group.complete.any():
        return f"no realisation is good in all {group.n_cases} cases: run more, or repeat the failed ones"
    columns = [np.exp(0.7 * group.log_ratio(name)) for name in group.levels]
    if np.linalg.matrix_rank(np.column_stack([np.ones(group.n_cases), *columns])) <= len(columns):
        varied = ", ".join(group.levels)
        return f"{group.n_cases} cases cannot tell {varied} apart: add cases in which only one of them differs"
    return ""


def shortage(groups: Sequence[Group], given: Given) -> str:
    """Return which free exponent has fewer than three levels in every group, or nothing."""
    for name in LIMITS:
        levels = max((np.unique(group.levels[name]) for group in groups if name in group.levels), key=len, default=None)
        if levels is not None and len(levels) < 3 and name not in given:
            return f"exponent of {name} needs three levels, has two ({fractions(levels)})\n{advice([name])}"
    return ""


def doubtful(
    groups: Sequence[Group],
    blocks: Sequence[WhitenedGroup],
    ranges: Ranges,
    alpha: Reals,
    low: Estimates,
    high: Estimates,
) -> dict[str, str]:
    """Return the free exponents that the data do not identify, by the ends (group) of their 90 % intervals, and why."""
    names, free = ranges.names, ranges.free
    if not free.size:
        return {}
    jacobian = project(blocks, alpha)[1][:, free]
    scale = np.sqrt(sum(float(np.sum((block.whitener @ block.means) ** 2)) for block in blocks))
    _, singular, vectors = np.linalg.svd(jacobian)
    if singular[-1] <= 1e-9 * scale:
        return {names[free[abs(vectors[-1]).argmax()]]: "has no influence on the fit"}
    doubt = {}
    for index in free:
        column = LIMITS.index(names[index])
        owner = next(i for i, group in enumerate(groups) if names[index] in group.levels)
        ends = np.array([low.exponent[owner, column], high.exponent[owner, column]])
        if np.isnan(ends).any():
            ends[:] = alpha[index]
            found = f"of {alpha[index]:.3g}"
        else:
            found = f"with 90 % interval {ends[0]:.3g} to {ends[1]:.3g}"
        if ends[0] < 1.02 * BOUNDS[0] or ends[1] > 0.98 * BOUNDS[1]:
            doubt[names[index]] = f"{found} touches the bounds {BOUNDS[0]:g} and {BOUNDS[1]:g}"
        elif ends[1] > WIDEST * ends[0]:
            doubt[names[index]] = f"{found} is uncertain by more than a factor {WIDEST:g}"
    return doubt


def pressed(ranges: Ranges, alpha: Reals) -> list[str]:
    """Return a line for each exponent (replicate, limit) that the data press against the low end of its range."""
    lines = []
    for name, low, high in zip(ranges.names, ranges.low, ranges.high, strict=True):
        found = np.median(alpha[:, LIMITS.index(name)])
        if low < high and found < low + _PRESSED * (high - low):
            lines.append(
                f"exponent of {name} is pressed to the low end of its range, {low:g}: allow less, or "
                "do not trust this limit"
            )
    return lines


def logarithmic(group: Group) -> list[str]:
    """Return a line for a spectrum whose octaves add nearly as much slope each: exponents of eps_f go as 2 - 2 H."""
    if "eps_f" not in group.levels or not group.parameters.get("hurst", 0.0) > _STEEPEST:
        return []
    return ["near H = 1 kappa goes as 1 / log(1 / eps_f): a power of eps_f may fit, but its limit is not that of kappa"]


def realisations(group: Group) -> str:
    """Return how many realisations a group has, in words."""
    return f"{group.n_realisations} realisation{'s' if group.n_realisations != 1 else ''}"


def evidence(group: Group, name: str) -> str:
    """Return what a group knows of a limit: its levels and realisations."""
    if name not in group.levels:
        return f"shared with other groups; {name} is not varied in this one"
    return f"levels {fractions(group.levels[name])}, {realisations(group)}"


def advice(names: Collection[str]) -> str:
    """Return how to fix exponents where the user stands: at the command line, in the campaign file, in Python."""
    options = " ".join(f"--fixed {name}=1" for name in names)
    block = ", ".join(f"{name}: [1/2, 1]" for name in names)
    argument = ", ".join(f"'{name}': (0.5, 1.0)" for name in names)
    return (
        f"fix exponents, or give the ranges they lie in: `gfmd fit {options}` or a range, as in {next(iter(names))}"
        f"=0.5:1; `fit: {{fixed: {{{block}}}}}` in the campaign file; fixed={{{argument}}} in Python; "
        "or add levels or realisations"
    )
