"""Values with units as people write them: 50 MPa, not 5e+07 Pa."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from gfmd_numba.text.si_prefix import si_prefix

if TYPE_CHECKING:
    from gfmd_numba.campaign.grid import Grid
    from gfmd_numba.scene import Scene


def readable(value: float, unit: str) -> tuple[str, str]:
    """Number and unit of a value, with a prefix where the unit may have one and the number is far from 1."""
    if not isfinite(value):
        return f"{value:.6g}", unit
    factor, name = si_prefix(abs(float(f"{value:.5e}")), unit)
    return f"{value * factor:.6g}", name


def dimensions(scene: Scene, varied: Grid | None = None) -> str:
    """What a scene is in metres, pascals and newtons, but for what a grid varies; nothing of one in L_x and E*."""
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
