"""What a campaign file says of each limit: its levels, its surfaces and its exponent.

Each record has a field for each discretisation in the table of axes.
"""

from math import inf
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, BeforeValidator, Field, WithJsonSchema, create_model

from gfmd_numba.campaign.axes import AXES, DISCRETISATIONS
from gfmd_numba.campaign.grid import Values
from gfmd_numba.scene.quantities import RECORD

MOST = 1_000_000  # surfaces
EXPONENT = "a finite number above 0, or the range it lies in, [low, high]"
COUNT = f"a whole number from 1 to {MOST}, or a mapping of such with the key reference and any of " + ", ".join(
    DISCRETISATIONS
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


class _OfTheReference(BaseModel):
    model_config = RECORD
    reference: Count = Field(description="Random surfaces of each case at the reference")

    def of(self, limit: str, level: int) -> int:
        """Number for the cases at a level of a limit, counted as the campaign lists them."""
        given: int | tuple[int, ...] | None = getattr(self, limit)
        return given[level] if isinstance(given, tuple) else given or self.reference


def _of_each(words: str, kind: Any = None) -> dict[str, Any]:
    """Return a field for each limit: of a `kind`, or for None of values of the discretisation."""
    of_any: Any = Values
    fields = {}
    for axis in (axis for axis in AXES if axis.name in DISCRETISATIONS):
        described = words.format(name=axis.name, limit=axis.limit)
        described = described[0].upper() + described[1:]
        fields[axis.name] = (kind or of_any[axis.type]) | None, Field(None, description=described)
    return fields


if TYPE_CHECKING:  # the fields are those of the table
    Limits = BaseModel
    FixedExponents = BaseModel
    Realisations = _OfTheReference
else:
    Limits = create_model(
        "Limits",
        __config__=RECORD,
        __doc__="Discretisations (dimensionless) taken one at a time around the reference.",
        **_of_each("{limit} limit (dimensionless)"),
    )
    FixedExponents = create_model(
        "FixedExponents",
        __config__=RECORD,
        __doc__="Exponents (dimensionless) that the fit does not search: a value, or the range it lies in.",
        **_of_each("Exponent of {name} or its range (dimensionless)", Exponent),
    )
    Realisations = create_model(
        "Realisations",
        __base__=_OfTheReference,
        __doc__="Random surfaces of each case, by its limit or level; a limit left out has as many as the reference.",
        **_of_each("Random surfaces of each case of the {limit} limit", Counts),
    )


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
