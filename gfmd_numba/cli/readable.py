"""Values with units as people write them: 50 MPa, not 5e+07 Pa."""

from __future__ import annotations

from math import floor, isfinite, log10
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gfmd_numba.campaign.grid import Grid
    from gfmd_numba.scene import Scene

_PREFIXES = {-4: "p", -3: "n", -2: "u", -1: "m", 0: "", 1: "k", 2: "M", 3: "G"}
_PREFIXED = ("m", "Pa", "N", "J m-2", "N m-1", "J/m^2", "N/m")  # units that take a prefix, in a file or in a record


def readable(value: float, unit: str) -> tuple[str, str]:
    """Number and unit of a value, with a prefix where the unit may have one and the number is far from 1."""
    if unit not in _PREFIXED or not isfinite(value) or value == 0.0:
        return f"{value:.6g}", unit
    thousands = floor(log10(float(f"{abs(value):.5e}")) / 3.0)
    if thousands not in _PREFIXES:
        return f"{value:.6g}", unit
    return f"{value * 1000.0**-thousands:.6g}", _PREFIXES[thousands] + unit


def dimensions(scene: Scene, varied: Grid | None = None) -> str:
    """What a scene is in metres, pascals and newtons, but for what a grid varies; nothing of one in L_x and E*."""
    from gfmd_numba.scene.reduced_units import quantities

    told = []
    for record, names in ((scene, ("length",)), (scene.body, ("youngs_modulus",)), (scene.loading, None)):
        for name, quantity in quantities(type(record)).items():
            value = getattr(record, name)
            in_si = scene.length is not None or not quantity.length
            replaced = getattr(varied, name, None) is not None
            if value is not None and in_si and not replaced and (names is None or name in names):
                told.append(f"{name} {' '.join(readable(value, quantity.si))}")
    return ", ".join(told)
