"""Quantities of a contact as an engineer reads them: their names, and numbers in the unit that suits them."""

from __future__ import annotations

from math import isfinite, nan, sqrt
from typing import TYPE_CHECKING

from gfmd_numba.text.si_prefix import si_prefix
from gfmd_numba.text.uncertain import with_error

if TYPE_CHECKING:
    import xarray as xr

    from gfmd_numba.campaign.grid import Grid
    from gfmd_numba.scene import Scene


WORDS = {
    "reduced_pressure": "p*",
    "prescribed_pressure": "pressure",
    "line_load": "line load",
    "force": "force",
    "punch_displacement": "punch displacement",
    "sliding": "sliding",
    "sliding_y": "sliding along y",
    "mean_pressure": "mean pressure",
    "contact_area_fraction": "contact area fraction",
    "contact_area": "contact area",
    "contact_length": "contact length",
    "approach": "approach",
    "mean_gap": "mean gap",
    "contact_stiffness": "stiffness",
    "peak_pressure": "peak pressure",
    "n_segments": "contacts",
    "elastic_energy": "elastic energy",
    "kappa": "kappa",
    "kappa_r": "kappa_r",
    "plastic_area_fraction": "plastic area fraction",
    "mean_plastic_depth": "mean plastic depth",
    "mean_tangential_traction": "mean tangential traction",
    "mean_tangential_traction_y": "mean tangential traction along y",
    "stick_fraction": "sticking share",
    "energy_lost": "energy lost",
    "hysteresis": "hysteresis",
    "pull_off_pressure": "pull-off pressure",
    "residual": "residual",
}
_PRESSURES = {"mean_pressure", "peak_pressure", "pull_off_pressure"} | {
    "mean_tangential_traction",
    "mean_tangential_traction_y",
}
_LENGTHS = {"punch_displacement", "sliding", "sliding_y", "approach", "mean_gap", "mean_plastic_depth"}
_ENERGIES = {"elastic_energy", "energy_lost", "hysteresis"}


def unit(dataset: xr.Dataset, name: str) -> str:
    """Return the unit of a variable in its file, in which E* and L_x stand for what the scene leaves open."""
    pressure = _units(dataset, "mean_pressure", "E*")
    length = _units(dataset, "mean_gap", "L_x")
    if name == "contact_stiffness":
        return "Pa m-1" if (pressure, length) == ("Pa", "m") else f"{pressure}/{length}"
    if name in _ENERGIES:
        return "J m-2" if (pressure, length) == ("Pa", "m") else f"{pressure} {length}"
    if name in _PRESSURES | _LENGTHS:
        return pressure if name in _PRESSURES else length
    return _units(dataset, name, "")


def _units(dataset: xr.Dataset, name: str, free: str) -> str:
    """Return the unit of a variable; `free` stands for 1."""
    found = dataset[name].attrs.get("units", "1") if name in dataset.variables else "1"
    return free if found == "1" else str(found)


def column(dataset: xr.Dataset, name: str, digits: int = 4) -> tuple[str, list[str]]:
    """Return heading, with the unit, and cells of a variable: numbers, with their standard error where it is known."""
    factor, shown = _suited(dataset, name)
    errors = dataset.get(f"{name}_standard_error")
    values = dataset[name].values.ravel().tolist()
    deviations = [nan] * len(values) if errors is None else errors.values.ravel().tolist()
    cells = [with_error(factor * v, factor * e, digits) for v, e in zip(values, deviations, strict=True)]
    return f"{WORDS[name]} ({shown})" if shown else WORDS[name], cells


def line(dataset: xr.Dataset, name: str) -> tuple[str, str, str]:
    """Return words, number and unit of a variable that is one number."""
    factor, shown = _suited(dataset, name)
    return WORDS[name], with_error(factor * float(dataset[name]), nan, 6), shown


def _suited(dataset: xr.Dataset, name: str) -> tuple[float, str]:
    sizes = [abs(value) for value in dataset[name].values.ravel().tolist() if isfinite(value) and value != 0.0]
    middle = sqrt(min(sizes)) * sqrt(max(sizes)) if sizes else 0.0
    return si_prefix(middle, unit(dataset, name))


def readable(value: float, unit: str) -> tuple[str, str]:
    """Return number and unit of a value, with a prefix if the unit may have one and the number is far from 1."""
    if not isfinite(value):
        return f"{value:.6g}", unit
    factor, name = si_prefix(abs(float(f"{value:.5e}")), unit)
    return f"{value * factor:.6g}", name


def dimensions(scene: Scene, varied: Grid | None = None) -> str:
    """Return the lengths, moduli and loads of a scene with units, except those that a grid varies."""
    from gfmd_numba.scene.units import quantities

    told = []
    for record, names in ((scene, ("length",)), (scene.body, ("youngs_modulus",)), (scene.loading, None)):
        for name, quantity in quantities(type(record)).items():
            value = getattr(record, name)
            in_si = scene.length is not None or not quantity.length
            replaced = getattr(varied, name, None) is not None
            if value is not None and in_si and not replaced and (names is None or name in names):
                told.append(f"{name} {' '.join(readable(value, quantity.si))}")
    return ", ".join(told)
