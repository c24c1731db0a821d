"""Heights that a record holds themselves: an array in Python, or a list of numbers in a file."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy.typing as npt

AXES = ("y", "x")  # of a map; of a profile the last
_SAID = re.compile(r"array of [0-9 x]+, sha256 ([0-9a-f]{64})")


@dataclass(frozen=True)
class Heights:
    """Heights `[nx]` or `[ny, nx]`, with the positions along x and y and the units that an xarray array has.

    Two of them are equal if their digests are. As text they are their shape and digest, from which the numbers do not
    come back: `values` is then None.
    """

    said: str
    values: npt.NDArray[Any] | None = field(repr=False, compare=False, default=None)
    positions: Mapping[str, npt.NDArray[Any]] = field(repr=False, compare=False, default_factory=dict)
    units: Mapping[str, str] = field(repr=False, compare=False, default_factory=dict)

    def __str__(self) -> str:
        """Return the shape and the digest."""
        return self.said


def heights(given: Any) -> Heights:
    """Heights of an array, an xarray array, nested lists, or their own text; raises ValueError for anything else."""
    import numpy as np

    if isinstance(given, Heights):
        return given
    if isinstance(given, str):
        if _SAID.fullmatch(given) is None:
            raise ValueError("no numbers")
        return Heights(given)
    if hasattr(given, "dims") and set(given.dims) == set(AXES):
        given = given.transpose(*AXES)
    if np.ma.isMaskedArray(given):  # masked heights are missing ones
        given = np.ma.filled(given.astype(np.float64), np.nan)
    values = np.array(given.values if hasattr(given, "dims") else given)  # a copy, which nobody changes
    if values.ndim not in (1, 2) or values.dtype.kind not in "fiu" or values.size == 0:
        raise ValueError("no row or table of numbers")
    positions, units = _described(given) if hasattr(given, "dims") else ({}, {})
    content = hashlib.sha256(repr((values.shape, sorted(units.items()))).encode())
    for array in (values, *(positions[axis] for axis in sorted(positions))):
        content.update(np.ascontiguousarray(array, dtype=np.float64).tobytes())
    shape = " x ".join(map(str, values.shape))
    return Heights(f"array of {shape}, sha256 {content.hexdigest()}", values, positions, units)


def _described(given: Any) -> tuple[dict[str, npt.NDArray[Any]], dict[str, str]]:
    """Positions and units of an xarray array, by axis."""
    import numpy as np

    positions, units = {}, {}
    for axis, dim in zip(AXES[-given.ndim :], given.dims, strict=True):
        if dim in given.coords:
            positions[axis] = np.array(given.coords[dim].values)
            units[axis] = given.coords[dim].attrs.get("units")
    units["z"] = given.attrs.get("units")
    return positions, {axis: str(unit) for axis, unit in units.items() if unit is not None}
