"""The record of a smooth form: a ball, a wedge or a flat punch with rounded edges, alone or under a roughness."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Self

from pydantic import BaseModel, Field, model_validator

from gfmd_numba.scene.quantities import RECORD, SMALLEST, Length, Points, broken_rule
from gfmd_numba.scene.units import in_unit_of

if TYPE_CHECKING:
    from gfmd_numba.arrays import Reals

FormSlope = Annotated[float, Field(ge=SMALLEST, le=1, description="Rise of a flank over its run (dimensionless)")]


class Form(BaseModel):
    """Smooth form of the punch about the middle of the period: a ball, a wedge or a flat with rounded edges.

    On profiles it is the section of a cylinder, a wedge or a strip; on maps a ball, a cone or a round stamp. Balls and
    edges are parabolas, as in Hertz's theory: a circular arc differs from them by terms that a half-space leaves out.
    """

    model_config = RECORD
    radius: Length | None = Field(None, description="Radius of a cylinder, of a ball on maps; along x if radius_y is")
    radius_y: Length | None = Field(None, description="Radius along y, on maps; None: the same")
    slope: FormSlope | None = Field(
        None, description="Rise of the flanks of a wedge, of a cone on maps, over their run (dimensionless)"
    )
    width: Length | None = Field(None, description="Width of a flat punch between its rounded edges, on maps across")
    edge_radius: Length | None = Field(None, description="Radius of the edges of a flat punch")
    points: Points | None = Field(None, description="Grid points over L_x; None: those of the roughness on the form")

    def heights(self, x: Reals, y: Reals | float = 0.0) -> Reals:
        """Heights at a way from the middle, in the unit of the lengths: 0 at the summit, and below it elsewhere."""
        if self.radius is not None:
            return -0.5 * (x * x / self.radius + y * y / (self.radius_y or self.radius))
        way = (x * x + y * y) ** 0.5
        if self.slope is not None:
            return -self.slope * way
        assert self.width is not None  # the promise of the record
        assert self.edge_radius is not None
        over = way - 0.5 * self.width
        return -0.125 * (over + abs(over)) ** 2 / self.edge_radius

    def misfit(self, period: float) -> tuple[str, str] | None:
        """Key of the length that does not fit the period, and what is allowed there; None if all fit."""
        for name in ("radius", "radius_y"):
            radius = getattr(self, name)
            if radius is not None and radius <= 0.5 * period:
                half = in_unit_of(radius, 0.5 * period)
                return name, f"more than half the period, {half}: a ball has no surface farther from its middle"
        if self.width is not None and self.width >= period:
            return "width", f"below the period {in_unit_of(self.width, period)}, so that the punch has edges"
        return None

    @model_validator(mode="after")
    def _one_shape(self) -> Self:
        if sum(each is not None for each in (self.radius, self.slope, self.width)) != 1:
            raise broken_rule((), "exactly one of radius, slope and width")
        if self.radius_y is not None and self.radius is None:
            raise broken_rule(("radius_y",), "nothing without radius")
        if (self.width is None) != (self.edge_radius is None):
            raise broken_rule(("edge_radius",), "the radius of the edges with a width, and nothing without")
        return self
