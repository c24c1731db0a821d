"""Records of prescribed tractions and displacements, on a surface without a punch or beside one."""

from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import BaseModel, BeforeValidator, Field, WithJsonSchema, model_validator

from gfmd_numba.scene.quantities import LARGEST, RECORD, broken_rule
from gfmd_numba.scene.units import LENGTH, PRESSURE, Quantity, WithUnit

COMPONENTS = ("normal", "tangential")
FILES = (".npy", ".csv")


def _values(quantity: Quantity) -> Any:
    """Type of a number of a quantity, or the name of a file: checked before the union, which tells every fault twice."""
    allowed = (
        f"a number up to 1e30 in size or {quantity.allowed}, for every node, "
        "or the name of a .npy or .csv file with one value for each node"
    )

    def checked(given: Any) -> float | str:
        if isinstance(given, str) and given.endswith(FILES):
            return given
        if isinstance(given, WithUnit):
            return given
        value = quantity.si_value(given) if isinstance(given, str) else given
        if type(value) in (int, float) and -LARGEST <= value <= LARGEST:
            return WithUnit(value, quantity) if isinstance(given, str) else float(value)
        raise ValueError(allowed)

    return Annotated[float | str, BeforeValidator(checked), WithJsonSchema({"allowed": allowed})]


if TYPE_CHECKING:
    Traction = Displacement = float | str
else:
    Traction, Displacement = _values(PRESSURE), _values(LENGTH)


class Boundary(BaseModel):
    """What is prescribed on the surface of the body, positive out of it and along x; nothing is a traction of 0.

    A value, or a file with not-a-number for each node where that is not prescribed.
    """

    model_config = RECORD
    normal_traction: Traction | None = Field(None, description="Pull out of the body in Pa (E* without moduli)")
    tangential_traction: Traction | None = Field(None, description="Pull along x in Pa (E* without moduli)")
    normal_displacement: Displacement | None = Field(None, description="Out of the body, in m (L_x without a length)")
    tangential_displacement: Displacement | None = Field(None, description="Along x, in m (L_x without a length)")

    @model_validator(mode="after")
    def _prescribes(self) -> Self:
        if all(value is None for _, value in self):
            raise broken_rule((), "at least one of " + ", ".join(type(self).model_fields))
        return self
