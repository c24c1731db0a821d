"""The record of a measured surface: where its heights are, in which units, and how they are treated.

Heights that a record holds itself are an array in Python, or a list of numbers in a file.
"""

from __future__ import annotations

import hashlib
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    InstanceOf,
    PlainSerializer,
    WithJsonSchema,
    model_validator,
)

from gfmd_numba.scene.quantities import RECORD, Length, Points, broken_rule
from gfmd_numba.scene.units import LENGTHS_ALLOWED, file_unit

if TYPE_CHECKING:
    import numpy.typing as npt


AXES = ("y", "x")  # of a map; of a profile the last
_SAID = re.compile(r"array of [0-9 x]+, sha256 ([0-9a-f]{64})")
_HEIGHTS = "a list of at least 4 numbers, or of as many such lists"


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


def is_table(values: npt.NDArray[Any]) -> bool:
    """Whether values are a row or a table of real numbers, of at least one."""
    return values.ndim in (1, 2) and values.dtype.kind in "fiu" and values.size > 0


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
    for mark in {"_FillValue", "missing_value"} & getattr(given, "attrs", {}).keys():
        given = given.where(given != given.attrs[mark])
    inner = given.data if hasattr(given, "dims") else given
    unit = getattr(inner, "units", None) if hasattr(inner, "magnitude") else getattr(inner, "unit", None)
    if np.ma.isMaskedArray(given):  # masked heights are missing ones
        given = np.ma.filled(given.astype(np.float64), np.nan)
    bare = inner if unit is None else getattr(inner, "magnitude", getattr(inner, "value", None))
    with warnings.catch_warnings(action="error", category=UserWarning):  # of units that are stripped
        try:
            values = np.array(bare if unit is not None else given)  # a copy, which nobody changes
        except (TypeError, Warning):
            raise ValueError("no numbers") from None
    if not is_table(values):
        raise ValueError("no row or table of numbers")
    if grow_downwards(getattr(given, "attrs", {})):
        values = 0.0 - values
    positions, units = _described(given) if hasattr(given, "dims") else ({}, {})
    units = units if unit is None else {**units, "z": str(unit)}
    content = hashlib.sha256(repr((values.shape, sorted(units.items()))).encode())
    for array in (values, *(positions[axis] for axis in sorted(positions))):
        content.update(np.ascontiguousarray(array, dtype=np.float64).tobytes())
    shape = " x ".join(map(str, values.shape))
    return Heights(f"array of {shape}, sha256 {content.hexdigest()}", values, positions, units)


def grow_downwards(attributes: Mapping[str, Any]) -> bool:
    """Whether numbers are depths, as `positive: down` of the CF conventions says."""
    return str(attributes.get("positive", "")).lower() == "down"


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


def _unit(given: Any) -> Any:
    name = file_unit(given) if isinstance(given, str) else None
    if name is None:
        raise ValueError(LENGTHS_ALLOWED)
    return name


Unit = Annotated[str, BeforeValidator(_unit), WithJsonSchema({"allowed": LENGTHS_ALLOWED})]


class FileUnits(BaseModel):
    """Units of what stands in a file that does not state them itself."""

    model_config = ConfigDict(**RECORD, json_schema_extra={"allowed": "a mapping like {z: um} or {x: mm, z: um}"})
    x: Unit | None = Field(None, description="Unit of positions or sizes along x; None: the file states it")
    y: Unit | None = Field(None, description="Unit of positions or sizes along y; None: the file states it")
    z: Unit | None = Field(None, description="Unit of heights; None: the file states it")


GivenHeights = Annotated[
    InstanceOf[Heights],
    BeforeValidator(heights),
    PlainSerializer(lambda given: given.said),
    WithJsonSchema({"allowed": _HEIGHTS}),
]

FileName = Annotated[str, Field(min_length=1, json_schema_extra={"allowed": "a file name"})]


class Measured(BaseModel):
    """Measured profile or map, read from a file of the user's or given as it is."""

    model_config = RECORD
    method: Literal["measured"] = Field(description="How the surface is made")
    file: FileName | None = Field(None, description="Profile or map, relative to the folder of the file that names it")
    heights: GivenHeights | None = Field(
        None, description="Heights in place of a file: a list of numbers, or of such lists; in Python an array"
    )
    units: FileUnits | None = Field(
        None, description="Units that the file does not state; None: the file states them all"
    )
    spacing: Length | None = Field(
        None, description="Distance of neighbouring points in m, where the file has no positions; None: length tells it"
    )
    crop: Literal["none", "square"] = Field(
        "none", description="What is cut out of a map before all else: the largest square about its centre"
    )
    fill: Literal["refuse", "interpolate"] = Field("refuse", description="Treatment of missing heights")
    despike: bool = Field(False, description="Whether heights in spikes are interpolated from those around")
    detrend: Literal["none", "mean", "tilt", "curvature"] = Field("none", description="What is subtracted")
    periodic: Literal["none", "mirror", "window"] = Field(
        "none", description="Treatment of the ends, so that they meet"
    )
    points: Points | None = Field(None, description="Grid points over L_x after resampling; None: as many as measured")
    cutoff: Length | None = Field(
        None, description="Shortest wavelength kept, in m, or in L_x if neither the file nor a length gives one in m"
    )

    @property
    def needs_discretisation(self) -> bool:
        """Never: a measured surface has its own grid."""
        return False

    @property
    def key(self) -> str:
        """Key of the heights in the record."""
        return "heights" if self.file is None else "file"

    @property
    def shown(self) -> str:
        """Name of the file without its folders, or the shape of the array."""
        return PurePath(self.file).name if self.file is not None else f"an {str(self.heights).partition(',')[0]}"

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.file is None) == (self.heights is None):
            raise broken_rule(("file",), "a file or heights, one of the two")
        return self

    def misfit(self, period: float) -> None:
        """None: whatever was measured fits its own grid."""
