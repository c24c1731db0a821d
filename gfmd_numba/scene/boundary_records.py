"""Records of prescribed tractions and displacements, on a surface with or without a punch."""

from collections.abc import Callable
from typing import Annotated, Any, NamedTuple, Self

from pydantic import BaseModel, Field, PlainSerializer, PlainValidator, WithJsonSchema, model_validator

from gfmd_numba.scene.quantities import LARGEST, RECORD, broken_rule
from gfmd_numba.scene.units import LENGTH, PRESSURE, Quantity, WithUnit


class Component(NamedTuple):
    """A component of displacements and tractions: how its keys begin and end, and which way it is positive."""

    name: str
    end: str
    way: str

    def key(self, quantity: str) -> str:
        """Key of the traction or the displacement of this component."""
        return f"{self.name}_{quantity}{self.end}"


_ALONG_X, _ALONG_Y = Component("tangential", "", "along x"), Component("tangential", "_y", "along y")
_NORMAL = Component("normal", "", "out of it")
COMPONENTS = {1: (_ALONG_X, _NORMAL), 2: (_ALONG_X, _ALONG_Y, _NORMAL)}  # by the dimension of the surface
FILES = (".npy", ".csv")


def _allowed(quantity: Quantity) -> str:
    return (
        f"a number up to 1e30 in size or {quantity.allowed}, for every node, "
        "or the name of a .npy or .csv file with one value for each node"
    )


def _number_or_file(quantity: Quantity) -> Callable[[Any], float | str]:
    """Check of a value: one for the whole union of types, which would tell every fault twice."""

    def check(given: Any) -> float | str:
        if isinstance(given, str) and given.endswith(FILES):
            return given
        value = quantity.read(given)
        if type(value) in (int, float, WithUnit) and -LARGEST <= value <= LARGEST:
            return value if isinstance(value, WithUnit) else float(value)
        raise ValueError(_allowed(quantity))

    return check


def _schema(quantity: Quantity) -> WithJsonSchema:
    return WithJsonSchema({"allowed": _allowed(quantity), "unit": quantity.si})


_PLAIN = PlainSerializer(lambda value: value if isinstance(value, str) else float(value), when_used="json")
Traction = Annotated[float | str, PlainValidator(_number_or_file(PRESSURE)), _schema(PRESSURE), _PLAIN]
Displacement = Annotated[float | str, PlainValidator(_number_or_file(LENGTH)), _schema(LENGTH), _PLAIN]


class Boundary(BaseModel):
    """What is prescribed on the surface of the body, positive out of it, along x and y; nothing is a traction of 0.

    A value, or a file with not-a-number for each node where that is not prescribed.
    """

    model_config = RECORD
    normal_traction: Traction | None = Field(None, description="Pull out of the body in Pa (E* without moduli)")
    tangential_traction: Traction | None = Field(None, description="Pull along x in Pa (E* without moduli)")
    normal_displacement: Displacement | None = Field(None, description="Out of the body, in m (L_x without a length)")
    tangential_displacement: Displacement | None = Field(None, description="Along x, in m (L_x without a length)")
    tangential_traction_y: Traction | None = Field(None, description="Pull along y, on maps")
    tangential_displacement_y: Displacement | None = Field(None, description="Along y, on maps")

    @model_validator(mode="after")
    def _prescribes(self) -> Self:
        if all(value is None for _, value in self):
            raise broken_rule((), "at least one of " + ", ".join(type(self).model_fields))
        return self
