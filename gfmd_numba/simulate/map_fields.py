"""Fields inside the body below a map, as datasets: on a vertical section, or on horizontal planes."""

from dataclasses import dataclass

import numpy as np
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import fields, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.fields import DISPLACEMENTS, STRAINS, STRESSES, Axis, Largest, LoadedSurface
from gfmd_numba.scene import Body, InputError
from gfmd_numba.scene.memory import beyond_memory
from gfmd_numba.simulate.fields_dataset import OF_MAPS, Scales, add_fields, add_formed, add_von_mises, begun
from gfmd_numba.simulate.solved_contact import tractions_on
from gfmd_numba.text.input_error import brief

_NAMES = DISPLACEMENTS + STRAINS + STRESSES
_ARRAYS = 40  # of the size of the map that fields of one plane take
_ARRAYS_OF_TOPOGRAPHY, _ARRAYS_OF_ORDER = 30, 40  # more of them above order 0 in the slope, and for each order
_ARRAYS_OF_A_PLANE = 2 * 20  # that stay in memory, and are joined


@dataclass(frozen=True)
class Wanted:
    """Heights z in the unit of x, and the section x = ... or y = ... through them, or whole planes."""

    z: Reals
    x: float | None
    y: float | None
    planes: bool


def of_steps(
    contact: xr.Dataset, body: Body, name: str, elastic: ElasticBody, length: float, order: int, wanted: Wanted
) -> list[xr.Dataset]:
    """Fields of each step of a map's contact; raises InputError for what is wanted of it that cannot be had."""
    height = f"{name}_height"
    is_followed = order > 0 and height in contact and bool(contact[height].values.any())
    _check(contact, length, wanted, _ARRAYS + is_followed * (_ARRAYS_OF_TOPOGRAPHY + order * _ARRAYS_OF_ORDER))
    z, every = wanted.z / length, [contact.isel(step=i) for i in range(contact.sizes["step"])]
    scales = Scales.of(contact, body, length)

    def surface(step: xr.Dataset) -> LoadedSurface:
        tractions = tractions_on(name, step, ("y", "x")) / scales.worth["stress"]
        if not is_followed:
            return fields.surface_under_tractions(tractions, elastic)
        return topography.rough_surface(tractions, step[height].values / length, elastic, order)

    largest = [fields.largest_von_mises(surface(step), z, elastic) for step in every]
    if wanted.planes:
        found = [_planes(step, surface(step), wanted.z, elastic, scales, name) for step in every]
    else:
        place = _place(every, largest, length, wanted)
        found = [_section(step, surface(step), wanted.z, elastic, scales, order, place, name) for step in every]
    for step, dataset, peaks in zip(every, found, largest, strict=True):
        _add_peaks(dataset, peaks, scales, int(step["status"]) != 0)
    return found


def _check(contact: xr.Dataset, length: float, wanted: Wanted, arrays: int) -> None:
    for name, given in (("x", wanted.x), ("y", wanted.y)):
        if given is None:
            continue
        if wanted.planes or (name == "y" and wanted.x is not None):
            other = "planes" if wanted.planes else "x"
            raise InputError(
                f"{name}: you gave {brief(given)} in addition to {other}; gfmd allows one section x, y, or planes"
            )
        number = isinstance(given, (int, float, np.floating, np.integer)) and not isinstance(given, bool)
        if not number or not 0.0 <= given <= length:
            unit = "m" if contact["x"].attrs["units"] == "m" else "L_x"
            raise InputError(f"{name}: you gave {brief(given)}; gfmd allows a number from 0 to {length:g}, in {unit}")
    ny, nx, levels = contact.sizes["y"], contact.sizes["x"], wanted.z.size
    if allowed := beyond_memory(ny * nx, arrays, "a section below it"):
        raise InputError(f"contact: you gave {ny} x {nx} nodes; gfmd allows {allowed}")
    kept = arrays + _ARRAYS_OF_A_PLANE * levels * contact.sizes["step"]
    if wanted.planes and (allowed := beyond_memory(ny * nx, kept, "this stack of planes")):
        raise InputError(f"planes: you gave {levels} heights; gfmd allows fewer, or {allowed}")


def _place(steps: list[xr.Dataset], largest: list[Largest], length: float, wanted: Wanted) -> tuple[Axis, int]:
    """Axis across a section and the nearest of its nodes; without either, the section has the largest stress of all."""
    across: Axis = "y" if wanted.x is None else "x"
    nodes = steps[0].sizes[across]
    given = wanted.y if wanted.x is None else wanted.x
    if given is None:
        found = [(peak.von_mises.max(), peak.y[peak.von_mises.argmax()]) for peak in largest]
        ok = [each for each, step in zip(found, steps, strict=True) if int(step["status"]) == 0]
        place = max(ok, default=(0.0, 0.0))[1]
    else:
        place = given / length
    return across, round(place * nodes) % nodes


def _section(
    step: xr.Dataset,
    surface: LoadedSurface,
    z: Reals,
    elastic: ElasticBody,
    scales: Scales,
    order: int,
    place: tuple[Axis, int],
    name: str,
) -> xr.Dataset:
    across, node = place
    cut, at = step.isel({across: node}), node / step.sizes[across]
    length = scales.worth["length"]
    values = fields.section(surface, z / length, elastic, _NAMES, across, at)
    along = "x" if across == "y" else "y"
    dataset = begun(cut, z, scales)
    dataset.coords[across] = cut[across]
    failed = int(step["status"]) != 0
    add_fields(dataset, ("z", along), dict(zip(_NAMES, values, strict=True)), OF_MAPS, scales, failed)
    add_von_mises(dataset, ("z", along), scales)
    if f"{name}_height" in step:
        heights = step[f"{name}_height"].values / length
        formed = topography.formed_at(heights, z / length, elastic, order, DISPLACEMENTS, across, at)
        add_formed(dataset, ("z", along), {f"formed_{i}": moved for i, moved in enumerate(formed, 1)}, scales)
    _add_pressure(dataset, step, name, scales, {across: node})
    return dataset


def _planes(
    step: xr.Dataset, surface: LoadedSurface, z: Reals, elastic: ElasticBody, scales: Scales, name: str
) -> xr.Dataset:
    dims, dataset = ("z", "y", "x"), begun(step, z, scales)
    heights = z / scales.worth["length"]
    values = np.stack([fields.plane(surface, float(height), elastic, _NAMES) for height in heights], axis=1)
    failed = int(step["status"]) != 0
    add_fields(dataset, dims, dict(zip(_NAMES, values, strict=True)), OF_MAPS, scales, failed)
    add_von_mises(dataset, dims, scales)
    _add_pressure(dataset, step, name, scales, {})
    return dataset


def _add_pressure(dataset: xr.Dataset, step: xr.Dataset, name: str, scales: Scales, cut: dict[str, int]) -> None:
    """Add what presses on the surface of a body, the punch and what is prescribed, at the nodes of a cut."""
    pressure = xr.DataArray(-tractions_on(name, step, ("y", "x"))[2], dims=("y", "x")).isel(cut)
    dataset["pressure"] = (pressure.dims, pressure.values, scales.attributes("stress", "pressure on the surface"))


def _add_peaks(dataset: xr.Dataset, largest: Largest, scales: Scales, failed: bool) -> None:
    """Add the largest von Mises stress of each whole plane and where it is."""
    for variable, kind, values, long_name in (
        ("peak_von_mises", "stress", largest.von_mises, "largest von Mises stress of the whole plane"),
        ("peak_x", "length", largest.x, "position along x of the largest von Mises stress of the plane"),
        ("peak_y", "length", largest.y, "position along y of the largest von Mises stress of the plane"),
    ):
        scaled = np.full_like(values, np.nan) if failed else values * scales.worth[kind]
        dataset[variable] = ("z", scaled, scales.attributes(kind, long_name))
