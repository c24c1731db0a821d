"""Records in reduced units: lengths in L_x, stresses in E*, and what both make up, rounded alike."""

from functools import lru_cache
from typing import Any, TypeVar, get_args

from pydantic import BaseModel

from gfmd_numba.scene.units import Quantity

Record = TypeVar("Record", bound=BaseModel)


def rounded(value: float) -> float:
    """Number to 12 significant digits.

    A division by L_x or E* leaves errors in the last of some 16 digits. The identity of a problem is a hash of exact
    numbers: rounded, a problem is the same in engineering units and in reduced ones.
    """
    return float(f"{value:.11e}")


@lru_cache(maxsize=4096)
def in_reduced_units(record: Record, length: float, modulus: float) -> Record:
    """Record whose lengths, stresses and so on are in units of a period and of a contact modulus, to 12 digits."""
    values = {name: (getattr(record, name), quantity) for name, quantity in quantities(type(record)).items()}
    return record.model_copy(
        update={
            name: rounded(value / quantity.scale(length, modulus))
            for name, (value, quantity) in values.items()
            if value is not None
        }
    )


@lru_cache
def quantities(record: type[BaseModel]) -> dict[str, Quantity]:
    """Fields of a record that are quantities, and which."""
    found = {name: _quantity((field.annotation, *field.metadata)) for name, field in record.model_fields.items()}
    return {name: quantity for name, quantity in found.items() if quantity is not None}


def _quantity(parts: Any) -> Quantity | None:
    for part in parts:
        found = part if isinstance(part, Quantity) else _quantity(get_args(part))
        if found is not None:
            return found
    return None
