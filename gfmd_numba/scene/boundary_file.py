"""Files of boundary-value problems: a body without a punch, and what is prescribed on its surface."""

from typing import Self

from pydantic import BaseModel, Field, model_validator

from gfmd_numba.scene.body_record import Body
from gfmd_numba.scene.boundary_records import Boundary
from gfmd_numba.scene.layer_records import check_layers
from gfmd_numba.scene.quantities import RECORD, Dimension, Length, broken_rule, check_scales
from gfmd_numba.scene.records import Numerics


class LoadedBody(BaseModel):
    """A body, what is prescribed on its surface, and the period L_x in m."""

    model_config = RECORD
    body: Body = Field(description="Elastic body")
    boundary: Boundary = Field(description="Prescribed tractions and displacements")
    length: Length | None = Field(None, description="Period L_x in m; None: lengths are in units of L_x")
    dimension: Dimension = Field(1, description="1: a surface over x, in plane strain; 2: over x and y, of period L_x")

    @model_validator(mode="after")
    def _units_have_scales(self) -> Self:
        check_scales(self, self.length, self.body.surface_modulus is not None)
        return self

    @model_validator(mode="after")
    def _layers_fit(self) -> Self:
        if self.body.layers is not None:
            check_layers(("body",), self.body.layers, self.body.base or "rigid", self.length)
        return self


class BoundaryFile(BaseModel):
    """A loaded body with its numerics and number of nodes."""

    model_config = RECORD
    scene: LoadedBody = Field(description="What is loaded")
    numerics: Numerics = Field(Numerics(), description="How it is solved")
    points: int | None = Field(
        None, ge=4, le=2**22, description="Nodes over the period, of maps both ways; None: as many as in the files"
    )

    @model_validator(mode="after")
    def _parts_agree(self) -> Self:
        if self.points is None and not any(isinstance(values, str) for _, values in self.scene.boundary):
            raise broken_rule(("points",), "the number of nodes, as no file of the boundary gives it")
        return self
