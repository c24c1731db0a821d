"""The discretisations that a run chooses by itself: those it begins with, and the finer ones that its results ask for.

The levels of a group of cases are a reference, which comes first, levels that differ from it in one discretisation, and
cross levels. A finer reference keeps the old levels: they become cross levels, which tell how corrections go together.
"""

from collections.abc import Iterable, Sequence
from math import inf, prod

from gfmd_numba.campaign.axes import DISCRETISATIONS
from gfmd_numba.campaign.limits import CROSS, Limits
from gfmd_numba.scene import Discretisation

FEWEST = 20  # realisations of the finest level: fewer do not tell how it goes with the others
_MOST = 400  # of a coarse one
Level = tuple[float, ...]  # eps_c, eps_f and eps_t
_F, _T = DISCRETISATIONS.index("eps_f"), DISCRETISATIONS.index("eps_t")

_FIRST = {1: (1 / 1024, 1 / 2, 1 / 4), 2: (1 / 32, 1 / 2, 1 / 2)}  # eps_f, eps_c and eps_t, by the dimension
_FINEST_OF_LAYERS = 1 / 64  # eps_t of profiles that a run begins with on thin layers
STEP = {1: 4.0, 2: 2.0}  # from one level of eps_f to the next, by the dimension of the surfaces


def first_levels(dimension: int, anisotropy: float = 1.0, thinnest_layer: float = inf) -> list[Level]:
    """Return the levels that a run begins with, the reference first: cheap ones, from which others follow.

    The longest waves along y of maps with an anisotropy above 1 fit the period at each of them. On profiles no layer
    is lower than the longest wave of the power law, as far as eps_t is not below 1/64.
    """
    (finest, c, t), step = _FIRST[dimension], STEP[dimension]
    while 2.0 * t * anisotropy > 1.0:
        t /= 2.0
    while dimension == 1 and t > max(thinnest_layer, _FINEST_OF_LAYERS):
        t /= 2.0
    coarse, coarser = step * finest, step**2 * finest
    return [
        (c, finest, t),
        (c / 2, finest, t),
        (c, coarse, t),
        (c, coarser, t),
        (c, finest, 2 * t),
        (c, coarse, t / 2),
        (c / 2, coarse, t),
        (c / 4, coarse, t),
        (c / 2, finest, 2 * t),
        (c, coarse, 2 * t),
        (c, coarser, t / 2),
    ]


def finer_levels(levels: Sequence[Level], limit: str, step: float) -> list[Level]:
    """Return the levels of a group with finer ones in the direction of a limit, the new reference first.

    A finer eps_f is `step` times finer than the reference. A correction in eps_t follows those in eps_f, because it
    wanes with eps_f.
    """
    reference = levels[0]
    if limit != "eps_f":
        axis = DISCRETISATIONS.index(limit)
        finest = min(level[axis] for level in levels)
        coarse = min((level[_F] for level in levels if level[_F] > reference[_F]), default=reference[_F])
        new = [_at(reference, axis, finest / 2), _at(_at(reference, _F, coarse), axis, finest / 2)]
        return list(dict.fromkeys([*levels, *new]))
    fine = _at(reference, _F, reference[_F] / step)
    periods = {level[_T] for level in levels}
    longer = reference[_T] / 2
    other = 2 * reference[_T] if 2 * reference[_T] <= max(periods) else longer  # no period is shorter than before
    of_eps_t = [_at(fine, _T, other), _at(reference, _T, longer)]
    return list(dict.fromkeys([fine, *levels, *(of_eps_t if len(periods) > 1 else ())]))


def limits_around(reference: Level, levels: Iterable[Level]) -> Limits:
    """Return levels as a campaign file has them, around a reference."""
    found: dict[str, list[float | dict[str, float]]] = {}
    for level in levels:
        differing = {name: level[i] for i, name in enumerate(DISCRETISATIONS) if level[i] != reference[i]}
        if len(differing) == 1:
            ((name, value),) = differing.items()
            found.setdefault(name, []).append(value)
        else:
            found.setdefault(CROSS, []).append(differing)
    return Limits.model_validate(found)


def _at(level: Level, axis: int, value: float) -> Level:
    return (*level[:axis], value, *level[axis + 1 :])


def discretisation_of(level: Level) -> Discretisation:
    """Return a level as a record."""
    return Discretisation(**dict(zip(DISCRETISATIONS, level, strict=True)))


def limit_of(reference: Level, level: Level) -> str:
    """Return the limit in which a level differs from the reference, "cross" for several, or "reference"."""
    differing = [name for i, name in enumerate(DISCRETISATIONS) if level[i] != reference[i]]
    return CROSS if len(differing) > 1 else next(iter(differing), "reference")


def nodes_of(level: Level, dimension: int) -> float:
    """Return the number of nodes of a level's grid, thesis (3.29)."""
    return float((2.0 / prod(level)) ** dimension)


def first_realisations(levels: Sequence[Level], dimension: int, fewest: int = FEWEST) -> list[int]:
    """Return how many realisations of each level (level) a run begins with: more of those that cost less.

    Multilevel Monte Carlo takes numbers in proportion to the root of variance over cost (Giles 2008), and variances of
    differences fall about as slowly as the cube root of the cost.
    """
    nodes = [nodes_of(level, dimension) for level in levels]
    return [min(max(_MOST, fewest), round(fewest * (max(nodes) / each) ** (2 / 3))) for each in nodes]
