"""The levels of each limit, its surfaces and its exponent: what a campaign file says of them, and what a run chooses.

The levels of a group of cases are a reference, which comes first, levels that differ from it in one discretisation, and
cross levels, which belong to several limits at once. A finer reference keeps the old levels: they become cross levels,
which tell how corrections go together.
"""

from collections.abc import Collection, Iterable, Sequence
from math import inf, prod
from typing import Annotated, Any, Self

from pydantic import BaseModel, BeforeValidator, Field, WithJsonSchema, model_validator

from gfmd_numba.campaign.axes import DISCRETISATIONS, Values
from gfmd_numba.scene import Discretisation
from gfmd_numba.scene.quantities import RECORD, EpsC, EpsF, EpsT, broken_rule

CROSS = "cross"  # key of levels at which several discretisations differ from the reference, and their name in results
MOST = 1_000_000  # surfaces
EXPONENT = "a finite number above 0, or the range it lies in, [low, high]"
COUNT = f"a whole number from 1 to {MOST}, or a mapping of such with the key reference and any of " + ", ".join(
    (*DISCRETISATIONS, CROSS)
)
COUNTS = f"a whole number from 1 to {MOST}, or a list of such, one for each level of the limit (0: left out)"
FEWEST = 20  # realisations of the finest level: fewer do not tell how it goes with the others
_MOST = 400  # of a coarse one
_FIRST = {1: (1 / 1024, 1 / 2, 1 / 4), 2: (1 / 32, 1 / 2, 1 / 2)}  # eps_f, eps_c and eps_t, by the dimension
_FINEST_OF_LAYERS = {1: 1 / 64, 2: 1 / 2}  # eps_t that a run begins with on thin layers, by the dimension
STEP = {1: 4.0, 2: 2.0}  # from one level of eps_f to the next, by the dimension of the surfaces


def _exponent(given: Any) -> float | tuple[float, float]:
    ends = given if isinstance(given, list | tuple) else (given, given)
    numbers = len(ends) == 2 and all(type(end) in (int, float) for end in ends)
    if not numbers or not 0 < ends[0] <= ends[1] < inf:
        raise ValueError(EXPONENT)
    return (float(ends[0]), float(ends[1])) if isinstance(given, list | tuple) else float(given)


def _counts(given: Any) -> int | tuple[int, ...]:
    listed = isinstance(given, list | tuple)
    numbers = given if listed else [given]
    if not numbers or not all(type(n) is int and (0 if listed else 1) <= n <= MOST for n in numbers):
        raise ValueError(COUNTS)
    return tuple(numbers) if listed else int(given)


# checked before the unions of types, which would tell every fault twice
Exponent = Annotated[float | tuple[float, float], BeforeValidator(_exponent), WithJsonSchema({"allowed": EXPONENT})]
Count = Annotated[int, Field(ge=1, le=MOST, description="Random surfaces per case")]
Counts = Annotated[int | tuple[int, ...], BeforeValidator(_counts), WithJsonSchema({"allowed": COUNTS})]


class CrossLevel(BaseModel):
    """Discretisations (dimensionless) that differ from the reference together."""

    model_config = RECORD
    eps_c: EpsC | None = Field(None, description="Value of eps_c (dimensionless)")
    eps_f: EpsF | None = Field(None, description="Value of eps_f (dimensionless)")
    eps_t: EpsT | None = Field(None, description="Value of eps_t (dimensionless)")

    @property
    def values(self) -> dict[str, float]:
        """The values that are given, by discretisation."""
        return {axis: value for axis, value in self if value is not None}

    @model_validator(mode="after")
    def _differs_in_several(self) -> Self:
        if len(self.values) < 2:
            raise broken_rule((), f"a mapping of two or more of {', '.join(DISCRETISATIONS)} to values")
        return self


class Limits(BaseModel):
    """Discretisations (dimensionless) around the reference, one at a time and together."""

    model_config = RECORD
    eps_c: Values[EpsC] | None = Field(None, description="Continuum limit (dimensionless)")
    eps_f: Values[EpsF] | None = Field(None, description="Fractal limit (dimensionless)")
    eps_t: Values[EpsT] | None = Field(None, description="Thermodynamic limit (dimensionless)")
    cross: Values[CrossLevel] | None = Field(None, description="Levels at which two or more differ at once")

    @property
    def crossed(self) -> tuple[dict[str, float], ...]:
        """The values of each cross level, by discretisation."""
        return tuple(level.values for level in self.cross or ())

    @property
    def varied(self) -> set[str]:
        """Discretisations that are varied, alone or together."""
        return {axis for axis in DISCRETISATIONS if getattr(self, axis) is not None}.union(*self.crossed)


class FixedExponents(BaseModel):
    """Exponents (dimensionless) that the fit does not search: a value, or the range it lies in."""

    model_config = RECORD
    eps_c: Exponent | None = Field(None, description="Exponent of eps_c or its range (dimensionless)")
    eps_f: Exponent | None = Field(None, description="Exponent of eps_f or its range (dimensionless)")
    eps_t: Exponent | None = Field(None, description="Exponent of eps_t or its range (dimensionless)")


class Realisations(BaseModel):
    """Random surfaces of each case, by its limit or level; a limit left out has as many as the reference."""

    model_config = RECORD
    reference: Count = Field(description="Random surfaces of each case at the reference")
    eps_c: Counts | None = Field(None, description="Random surfaces of each case of the continuum limit")
    eps_f: Counts | None = Field(None, description="Random surfaces of each case of the fractal limit")
    eps_t: Counts | None = Field(None, description="Random surfaces of each case of the thermodynamic limit")
    cross: Counts | None = Field(None, description="Random surfaces of each case at a cross level")

    def of(self, limit: str, level: int) -> int:
        """Number for the cases at a level of a limit, counted as the campaign lists them."""
        given: int | tuple[int, ...] | None = getattr(self, limit)
        return given[level] if isinstance(given, tuple) else given or self.reference


def _realisations(given: Any) -> Any:
    if isinstance(given, dict | Realisations):
        return given
    if type(given) is not int or not 1 <= given <= MOST:
        raise ValueError(COUNT)
    return {"reference": given}


NumberOfSurfaces = Annotated[
    Realisations,
    BeforeValidator(_realisations),
    WithJsonSchema(Realisations.model_json_schema() | {"type": ["integer", "object"], "allowed": COUNT}),
]

Level = tuple[float, ...]  # eps_c, eps_f and eps_t
_F, _T = DISCRETISATIONS.index("eps_f"), DISCRETISATIONS.index("eps_t")


def first_levels(dimension: int, anisotropy: float = 1.0, thinnest_layer: float = inf) -> list[Level]:
    """Return the levels that a run begins with, the reference first: cheap ones, from which others follow.

    The longest waves along y of maps with an anisotropy above 1 fit the period at each of them. On profiles no layer
    is lower than the longest wave of the power law, as far as eps_t is not below 1/64.
    """
    (finest, c, t), step = _FIRST[dimension], STEP[dimension]
    while 2.0 * t * anisotropy > 1.0:
        t /= 2.0
    while t > max(thinnest_layer, _FINEST_OF_LAYERS[dimension]):
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
        differing = _differing(reference, level)
        limit = limit_named(differing)
        found.setdefault(limit, []).append(differing if limit == CROSS else differing[limit])
    return Limits.model_validate(found)


def _differing(reference: Level, level: Level) -> dict[str, float]:
    return {name: level[i] for i, name in enumerate(DISCRETISATIONS) if level[i] != reference[i]}


def _at(level: Level, axis: int, value: float) -> Level:
    return (*level[:axis], value, *level[axis + 1 :])


def discretisation_of(level: Level) -> Discretisation:
    """Return a level as a record."""
    return Discretisation(**dict(zip(DISCRETISATIONS, level, strict=True)))


def limit_of(reference: Level, level: Level) -> str:
    """Return the limit in which a level differs from the reference, "cross" for several, or "reference"."""
    return limit_named(_differing(reference, level))


def limit_named(differing: Collection[str]) -> str:
    """Return the name of the discretisation that differs from the reference, "cross" of several, or "reference"."""
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
