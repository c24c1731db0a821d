"""What conductance and leakage are with the materials and the fluid known: a resistance, and a flow in m^3/s."""

from collections.abc import Sequence
from contextlib import suppress
from math import inf
from typing import Annotated

import xarray as xr
from pydantic import BaseModel, Field
from pydantic_core import PydanticCustomError

from gfmd_numba.contact.contact_dataset import cf_attributes
from gfmd_numba.scene import Document, InputError, validate
from gfmd_numba.scene.quantities import RECORD, Length, Pressure, Size
from gfmd_numba.scene.units import ELECTRICAL_CONDUCTIVITY, THERMAL_CONDUCTIVITY, VISCOSITY, WithUnit
from gfmd_numba.text.input_error import brief

_RESISTANCES = {ELECTRICAL_CONDUCTIVITY: "ohm", THERMAL_CONDUCTIVITY: "K W-1"}


class _Fluid(BaseModel):
    model_config = RECORD
    viscosity: Annotated[Size, VISCOSITY]
    pressure: Pressure
    seal: tuple[Length, ...] | None = Field(None, min_length=2, max_length=2)


def with_resistance(found: xr.Dataset, conductivity: object) -> xr.Dataset:
    """Conductance of a contact with the `resistance` R = 1 / (G s A) of its nominal area A, that of all its nodes.

    s is the harmonic mean of the conductivity of both bodies, or of one for each, as texts like `60 MS/m`. Of a profile
    it is `resistance_times_width`, along y. Raises InputError for other conductivities, or a contact without a length.
    """
    each = conductivity if isinstance(conductivity, Sequence) and not isinstance(conductivity, str) else [conductivity]
    known = [_conductivity(one) for one in each]
    if len(known) not in (1, 2) or len({one.quantity for one in known}) > 1:
        raise InputError.of(
            "conductivity", brief(conductivity), "one conductivity, or two of a kind: one for each body"
        )
    lengths = _lengths(found, "conductivity", conductivity)
    mean = len(known) / sum(1.0 / one for one in known)
    area = lengths["x"] * lengths.get("y", 1.0)
    unit, long_name = _RESISTANCES[known[0].quantity], "resistance of the touching spots of the nominal area"
    name = "resistance"
    if "y" not in lengths:
        name, unit, long_name = f"{name}_times_width", f"{unit} m", f"{long_name}, times its width along y"
    resistance = 1.0 / (found["conductance"] * mean * area)
    return found.assign({name: resistance.assign_attrs(cf_attributes(long_name, unit))})


def _conductivity(given: object) -> WithUnit:
    for quantity in _RESISTANCES:
        with suppress(PydanticCustomError):
            value = quantity.read(given)
            if isinstance(value, WithUnit) and 0.0 < value < inf:
                return value
    raise InputError.of("conductivity", brief(given), " or ".join(each.allowed for each in _RESISTANCES))


def with_flow(found: xr.Dataset, viscosity: object = None, pressure: object = None, seal: object = None) -> xr.Dataset:
    """Leakage of a contact with the `flow` d^3 P / (12 eta) W / L in m^3/s along x and along y.

    The pressure falls by P over the length L of a seal, whose width is W: `seal` gives both, else they are those of the
    map. Numbers are in SI units, texts like `1 mPa s` have units. Raises InputError for others, or a contact without a
    length.
    """
    pair = tuple(seal) if isinstance(seal, list) else seal
    given = {"viscosity": viscosity, "pressure": pressure, "seal": pair}
    fluid = validate(Document(None, "", {name: each for name, each in given.items() if each is not None}), _Fluid)
    lengths = _lengths(found, "viscosity", viscosity)
    if fluid.seal is None and "y" not in lengths:
        raise InputError.of("seal", "nothing", "the length and the width of a seal, as a profile has no width")
    along, width = (lengths["x"], lengths["y"]) if fluid.seal is None else fluid.seal
    shape = xr.DataArray([width / along, along / width if fluid.seal is None else width / along], dims="direction")
    flow = found["hydraulic_gap"] ** 3 * fluid.pressure / (12.0 * fluid.viscosity) * shape
    whole = "map" if fluid.seal is None else "seal"
    return found.assign(flow=flow.assign_attrs(cf_attributes(f"flow through the {whole}", "m3 s-1")))


def _lengths(found: xr.Dataset, argument: str, given: object) -> dict[str, float]:
    """Lengths in m of what was solved, along x and of maps along y; raises InputError for those in L_x."""
    if found["x"].attrs.get("units", "1") == "1":
        raise InputError.of(argument, brief(given), "nothing for a contact without a length: give one in the scene")
    return {dim: float(found[dim][1] - found[dim][0]) * found.sizes[dim] for dim in ("x", "y") if dim in found.dims}
