"""The record of a measured surface: where its heights are, in which units, and how they are treated."""

from pathlib import PurePath
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, Field, InstanceOf, PlainSerializer, WithJsonSchema, model_validator

from gfmd_numba.scene.heights import Heights, heights
from gfmd_numba.scene.length_units import ALLOWED, length_unit
from gfmd_numba.scene.quantities import RECORD, Length, Points, broken_rule


def _unit(given: Any) -> Any:
    name = length_unit(given) if isinstance(given, str) else None
    if name is None:
        raise ValueError(ALLOWED)
    return name


Unit = Annotated[str, BeforeValidator(_unit), WithJsonSchema({"allowed": ALLOWED})]


class FileUnits(BaseModel):
    """Units of what stands in a file that does not state them itself."""

    model_config = RECORD
    x: Unit | None = Field(None, description="Unit of positions or sizes along x; None: the file states it")
    y: Unit | None = Field(None, description="Unit of positions or sizes along y; None: the file states it")
    z: Unit | None = Field(None, description="Unit of heights; None: the file states it")


_HEIGHTS = "a list of at least 4 numbers, or of as many such lists"


def _heights(given: Any) -> Any:
    try:
        return heights(given)
    except ValueError:
        raise ValueError(_HEIGHTS) from None


GivenHeights = Annotated[
    InstanceOf[Heights],
    BeforeValidator(_heights),
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
    crop: Literal["none", "square"] = Field(
        "none", description="What is cut out of a map before all else: the largest square about its centre"
    )
    fill: Literal["refuse", "interpolate"] = Field("refuse", description="Treatment of missing heights")
    despike: bool = Field(False, description="Whether medians of the heights around take the place of spikes")
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
