"""What a campaign file says of each limit: its levels, its surfaces and its exponent.

Cross levels belong to several limits at once.
"""

from math import inf
from typing import Annotated, Any, Self

from pydantic import BaseModel, BeforeValidator, Field, WithJsonSchema, model_validator

from gfmd_numba.campaign.axes import DISCRETISATIONS
from gfmd_numba.campaign.grid import Values
from gfmd_numba.scene.quantities import RECORD, EpsC, EpsF, EpsT, broken_rule

CROSS = "cross"  # key of levels at which several discretisations differ from the reference, and their name in results
MOST = 1_000_000  # surfaces
EXPONENT = "a finite number above 0, or the range it lies in, [low, high]"
COUNT = f"a whole number from 1 to {MOST}, or a mapping of such with the key reference and any of " + ", ".join(
    (*DISCRETISATIONS, CROSS)
)
COUNTS = f"a whole number from 1 to {MOST}, or a list of such, one for each level of the limit (0: left out)"


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
