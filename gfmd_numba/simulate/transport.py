"""What crosses a solved contact: current or heat where its nodes touch, and a flow of a fluid that is known."""

from collections.abc import Sequence
from contextlib import suppress
from math import inf
from typing import Annotated

import numpy as np
import xarray as xr
from pydantic import BaseModel, Field
from pydantic_core import PydanticCustomError
from scipy.sparse.linalg import LinearOperator, cg

from gfmd_numba.analysis import channels
from gfmd_numba.analysis.forms import SOLVED, check_fields, goes_around
from gfmd_numba.arrays import Flags, Reals
from gfmd_numba.arrays.regions import closed
from gfmd_numba.contact.contact_dataset import CONVENTIONS, cf_attributes
from gfmd_numba.elasticity import free_body
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.scene import Document, InputError, validate
from gfmd_numba.scene.quantities import RECORD, Length, Pressure, Size
from gfmd_numba.scene.units import ELECTRICAL_CONDUCTIVITY, THERMAL_CONDUCTIVITY, VISCOSITY, WithUnit
from gfmd_numba.text.input_error import brief
from gfmd_numba.text.recorded_scene import asked, fields_in_period

_RESIDUAL = 1e-10
_OF_RIDGES = (
    "The contact is that of a profile: its spots are ridges without end along y, and conduct as those do. For the "
    "spots of a rough surface, solve a scene with `dimension: 2`"
)
_OF_NOTHING = "Nothing touches, so that the bodies conduct nothing to each other"
_RESISTANCES = {ELECTRICAL_CONDUCTIVITY: "ohm", THERMAL_CONDUCTIVITY: "K W-1"}
_TIMES_AREA = {"ohm": "ohm m2", "K W-1": "K m2 W-1"}


def contact_conductance(contact: xr.Dataset, conductivity: object = None) -> xr.Dataset:
    """Conductance of what `gfmd solve` leaves of contacts, for the current or the heat that crosses touching nodes.

    Two half-spaces of conductivities s_1 and s_2 meet in the touching nodes, which are at one potential. With s = 2 s_1
    s_2 / (s_1 + s_2), `conductance` times s is the current per nominal area over what the contact adds to the potential
    difference of the two bodies, per m (L_x without a length). A single round spot of radius a has 2 a s (Holm,
    Electric Contacts, 1967); one of n nodes across has about 0.2 / n of that less, as its nodes are counted. Without a
    period the difference is between points far away, and at a distance of L_x where the contact goes on along one axis.
    Frictionless half-spaces with the contact held have the stiffness dp/d(mean gap) = `conductance` times E*, or
    dp/d(approach) without a period (Barber, Proc. R. Soc. Lond. A 459:53, 2003). It is 0 without contact and infinite
    in full contact with a period. `current_density` is the current through a node over the mean of all nodes. Dims
    other than `y` and `x` stay. Contacts of a profile are ridges without end along y, which the attribute `validity`
    says after the warnings about the contact.

    With a `conductivity` there is the `resistance_times_area` 1 / (G s) too, and of maps the `resistance` of their
    nominal area. Raises InputError for other conductivities, a contact whose length they need, or a run that is not ok.
    """
    material = None if conductivity is None else _material(contact, conductivity)
    contact = SOLVED.checked(contact, "contact")
    nodes = check_fields(contact, ("gap",), whole=True)
    touching, ends = closed(contact["gap"]), tuple(not around for around in goes_around(contact))
    reduced, density = xr.apply_ufunc(
        _reduced, touching, kwargs={"ends": ends}, input_core_dims=[nodes], output_core_dims=[[], nodes], vectorize=True
    )
    spacing = float(contact["x"][1] - contact["x"][0])
    unit = str(contact["x"].attrs.get("units", "1"))
    long_name = "contact conductance per nominal area over the harmonic mean of the conductivities"
    result = xr.Dataset(attrs={"Conventions": CONVENTIONS, "title": "conductance of a contact", **asked(contact.attrs)})
    result["conductance"] = reduced / (spacing * contact.sizes["x"])
    result["conductance"].attrs = cf_attributes(long_name, "1" if unit == "1" else f"{unit}-1")
    result["current_density"] = density
    result["current_density"].attrs = cf_attributes("current through a node over the mean of all nodes")
    ridges, nothing = _OF_RIDGES * (len(nodes) == 1), _OF_NOTHING * (not touching.any())
    result.attrs["validity"] = "\n".join(filter(None, (contact.attrs.get("validity"), ridges, nothing)))
    if material is None:
        return result
    fields = fields_in_period(contact.attrs.get("scene", "{}"))
    return result.assign(_resistance(result["conductance"], *material, fields))


def _material(contact: xr.Dataset, conductivity: object) -> tuple[list[WithUnit], dict[str, float]]:
    """Return the conductivities of the bodies, and the lengths in m of a contact."""
    each = conductivity if isinstance(conductivity, Sequence) and not isinstance(conductivity, str) else [conductivity]
    known = [_conductivity(one) for one in each]
    if len(known) not in (1, 2) or len({one.quantity for one in known}) > 1:
        raise InputError.of(
            "conductivity", brief(conductivity), "one conductivity, or two of a kind: one for each body"
        )
    return known, _lengths(contact, "conductivity", conductivity)


def _conductivity(given: object) -> WithUnit:
    for quantity in _RESISTANCES:
        with suppress(PydanticCustomError):
            value = quantity.read(given)
            if isinstance(value, WithUnit) and 0.0 < value < inf:
                return value
    raise InputError.of("conductivity", brief(given), " or ".join(each.allowed for each in _RESISTANCES))


def _resistance(
    conductance: xr.DataArray, known: list[WithUnit], lengths: dict[str, float], fields: int
) -> dict[str, xr.DataArray]:
    """Return what the touching spots resist, times the nominal area, and of maps the resistance of that area.

    The nominal area is that of the measured field, of which there may be several `fields` in a period.
    """
    mean, unit = len(known) / sum(1.0 / one for one in known), _RESISTANCES[known[0].quantity]
    specific = 1.0 / (conductance * mean)
    long_name = "resistance of the touching spots, times the nominal area"
    found = {"resistance_times_area": specific.assign_attrs(cf_attributes(long_name, _TIMES_AREA[unit]))}
    if "y" in lengths:
        whole = specific / (lengths["x"] * lengths["y"] / fields)
        area = "measured field" if fields > 1 else "nominal area"
        attributes = cf_attributes(f"resistance of the touching spots of the {area}", unit)
        found["resistance"] = whole.assign_attrs(attributes)
    return found


def _reduced(touching: Flags, ends: tuple[bool, ...]) -> tuple[float, Reals]:
    """Conductance in 1 / L_x, and the current through nodes over its mean.

    The conductance is half the mean current of one half-space at unit potential under the touching nodes.

    Its potential is sum_q j~(q) / q exp(iqx), with zero mean: the mean is that of the uniform flow. In a window that
    `ends` it is half the displacement of an elastic half-space under a pressure j.
    """
    if not touching.any() or (touching.all() and not any(ends)):
        return np.inf if touching.all() else 0.0, touching.astype(np.float64)
    if any(ends):
        potential = 0.5 * free_body.compliance(touching.shape, ends=ends)[0]
    else:
        q = grid.magnitudes(touching.shape)
        potential = np.divide(1.0, q, out=np.zeros_like(q), where=q > 0.0)
    shape = free_body.padded_shape(touching.shape, ends)
    field, on_grid = Transform(1, *shape), np.zeros(shape, dtype=np.bool_)
    on_grid[grid.corner(touching.shape)] = touching
    places = np.flatnonzero(on_grid)
    potential_of = field.symbol(potential)
    current_of = field.symbol(np.divide(1.0, potential, out=np.zeros_like(potential), where=potential > 0.0))

    def on_contact(symbol: Reals, source: Reals) -> Reals:
        row = field.sources[0][0]
        row[:] = 0.0
        row[places] = source
        field.apply(symbol, np.arange(1))
        return np.asarray(field.result[0, places])

    pairs = (len(places), len(places))
    compliance = LinearOperator(pairs, lambda current: on_contact(potential_of, current), dtype=np.float64)
    near_field = LinearOperator(pairs, lambda potential: on_contact(current_of, potential), dtype=np.float64)
    current, failed = cg(compliance, np.ones(len(places)), rtol=_RESIDUAL, maxiter=10_000, M=near_field)
    density: Reals = np.zeros(touching.shape)
    density[touching] = np.nan if failed else current * touching.size / current.sum()
    return float("nan") if failed else 0.5 * float(current.sum()) / touching.size, density


class _Fluid(BaseModel):
    model_config = RECORD
    viscosity: Annotated[Size, VISCOSITY]
    pressure: Pressure
    seal: tuple[Length, ...] | None = Field(None, min_length=2, max_length=2)


def leakage(contact: xr.Dataset, viscosity: object = None, pressure: object = None, seal: object = None) -> xr.Dataset:
    """Leakage of a contact, and of a fluid the `flow` d^3 P / (12 eta) W / L in m^3/s along x and along y.

    The pressure falls by P over the length L of a seal, whose width is W: `seal` gives both, else they are those of the
    map. Numbers are in SI units, texts like `1 mPa s` have units. Raises InputError for others, or a contact without a
    length.
    """
    pair = tuple(seal) if isinstance(seal, list) else seal
    asked = {"viscosity": viscosity, "pressure": pressure, "seal": pair}
    given = {name: each for name, each in asked.items() if each is not None}
    if not given:
        return channels.leakage(contact)
    fluid = validate(Document(None, "", given), _Fluid)
    lengths = _lengths(contact, "viscosity", viscosity)
    if fluid.seal is None and "y" not in lengths:
        raise InputError.of("seal", "nothing", "the length and the width of a seal, as a profile has no width")
    along, width = (lengths["x"], lengths["y"]) if fluid.seal is None else fluid.seal
    shape = xr.DataArray([width / along, along / width if fluid.seal is None else width / along], dims="direction")
    found = channels.leakage(contact)
    flow = found["hydraulic_gap"] ** 3 * fluid.pressure / (12.0 * fluid.viscosity) * shape
    whole = "map" if fluid.seal is None else "seal"
    known = {
        "flow": (flow, f"flow through the {whole}", "m3 s-1"),
        "viscosity": (xr.DataArray(fluid.viscosity), "viscosity of the fluid", "Pa s"),
        "pressure_drop": (xr.DataArray(fluid.pressure), f"fall of the pressure over the {whole}", "Pa"),
        "seal_length": (xr.DataArray(along), f"length of the {whole} along the flow along x", "m"),
        "seal_width": (xr.DataArray(width), f"width of the {whole} across that", "m"),
    }
    return found.assign(
        {name: each.assign_attrs(cf_attributes(long_name, unit)) for name, (each, long_name, unit) in known.items()}
    )


def _lengths(found: xr.Dataset, argument: str, given: object) -> dict[str, float]:
    """Lengths in m of what was solved, along x and of maps along y; raises InputError for those in L_x."""
    if "x" not in found.coords or found["x"].attrs.get("units", "1") == "1":
        raise InputError.of(argument, brief(given), "nothing for a contact without a length: give one in the scene")
    return {dim: float(found[dim][1] - found[dim][0]) * found.sizes[dim] for dim in ("x", "y") if dim in found.dims}
