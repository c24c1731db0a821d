"""Records of prescribed tractions and displacements, on a surface without a punch or beside one."""

from typing import Annotated, Any, Self

from pydantic import BaseModel, BeforeValidator, Field, WithJsonSchema, model_validator

from gfmd_numba.scene.quantities import LARGEST, RECORD, broken_rule

COMPONENTS = ("normal", "tangential")
VALUES = "a number up to 1e30 in size, for every node, or the name of a .npy or .csv file with one value for each node"


def _values(given: Any) -> float | str:
    if type(given) in (int, float) and -LARGEST <= given <= LARGEST:
        return float(given)
    if isinstance(given, str) and given.endswith((".npy", ".csv")):
        return given
    raise ValueError(VALUES)


# checked before the union of types, which would tell every fault twice
Values = Annotated[float | str, BeforeValidator(_values), WithJsonSchema({"allowed": VALUES})]


class Boundary(BaseModel):
    """What is prescribed on the surface of the body, positive out of it and along x; nothing is a traction of 0.

    A value, or a file with not-a-number for each node where that is not prescribed.
    """

    model_config = RECORD
    normal_traction: Values | None = Field(None, description="Pull out of the body in Pa (E* without moduli)")
    tangential_traction: Values | None = Field(None, description="Pull along x in Pa (E* without moduli)")
    normal_displacement: Values | None = Field(None, description="Out of the body, in m (L_x without a length)")
    tangential_displacement: Values | None = Field(None, description="Along x, in m (L_x without a length)")

    @model_validator(mode="after")
    def _prescribes(self) -> Self:
        if all(value is None for _, value in self):
            raise broken_rule((), "at least one of " + ", ".join(type(self).model_fields))
        return self
