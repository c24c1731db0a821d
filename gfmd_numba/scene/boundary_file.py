"""Files of boundary-value problems: a body without a punch, and what is prescribed on its surface."""

from typing import Self

from pydantic import BaseModel, Field, model_validator

from gfmd_numba.scene.body_record import Body
from gfmd_numba.scene.boundary_records import Boundary
from gfmd_numba.scene.layer_records import check_layers
from gfmd_numba.scene.measured_record import Measured
from gfmd_numba.scene.quantities import RECORD, Dimension, Length, Seed, broken_rule, check_scales
from gfmd_numba.scene.records import Discretisation, Numerics, check_drawing, check_waves
from gfmd_numba.scene.surfaces import Surface


class LoadedBody(BaseModel):
    """A body, what is prescribed on its surface, and the period L_x in m."""

    model_config = RECORD
    body: Body = Field(description="Elastic body")
    boundary: Boundary = Field(description="Prescribed tractions and displacements")
    length: Length | None = Field(
        None,
        description="Period L_x in m; None: that of a measured topography with positions, and otherwise lengths are "
        "in units of L_x",
    )
    dimension: Dimension = Field(1, description="1: a surface over x, in plane strain; 2: over x and y, of period L_x")

    @property
    def deformable(self) -> tuple[Body, ...]:
        """The elastic body."""
        return (self.body,)

    @property
    def has_moduli(self) -> bool:
        """Whether the body has a Young's modulus, so that stresses are in Pa."""
        return self.body.has_modulus

    @property
    def surfaces(self) -> dict[tuple[str, ...], Surface]:
        """The topography of the body by its place in the scene; none of a flat one."""
        return {} if self.body.roughness is None else {("body", "roughness"): self.body.roughness}

    @property
    def follows_topography(self) -> bool:
        """Whether the body is rough."""
        return self.body.roughness is not None

    @property
    def knows_lowest_order_only(self) -> bool:
        """Whether the topography is followed at order 0 in its slope unless a higher order is asked for."""
        return self.dimension == 2 or self.body.layers is not None

    @property
    def awaits_period(self) -> bool:
        """Whether the file of a measured topography may tell the period: what depends on it is checked by then."""
        return self.length is None and isinstance(self.body.roughness, Measured)

    @model_validator(mode="after")
    def _parts_fit(self) -> Self:
        if not self.awaits_period:
            self.check_period()
        return self

    def check_period(self) -> None:
        """Raise a located PydanticCustomError for layers that do not fit the period, and units that need one."""
        if self.body.layers is not None:
            check_layers(("body",), self.body.layers, self.body.base or "rigid", self.length)
        check_scales(self, self.length, self.has_moduli)


class BoundaryFile(BaseModel):
    """A loaded body with its numerics, and its number of nodes or what gives its topography one."""

    model_config = RECORD
    scene: LoadedBody = Field(description="What is loaded")
    numerics: Numerics = Field(Numerics(), description="How it is solved")
    points: int | None = Field(
        None,
        ge=4,
        le=2**22,
        description="Nodes over the period, of maps both ways; None: as many as in the files, or in the topography",
    )
    discretisation: Discretisation | None = Field(
        None, description="Grid and wavelengths of a random topography without points of its own"
    )
    seed: Seed = 0
    realisation: int = Field(0, ge=0, lt=2**63, description="Which realisation of a random topography")

    @property
    def slope_order(self) -> int | None:
        """Order in the slope to which the topography of the body is followed, None for a flat one."""
        return self.numerics.slope_order(self.scene) if self.scene.follows_topography else None

    @model_validator(mode="after")
    def _parts_agree(self) -> Self:
        check_drawing(self.scene.surfaces, self.discretisation, self.seed, self.realisation)
        if self.scene.follows_topography:
            if self.points is not None:
                raise broken_rule(("points",), "nothing, as the topography of the body has its own grid")
        elif self.points is None and not any(isinstance(values, str) for _, values in self.scene.boundary):
            raise broken_rule(("points",), "the number of nodes, as no file of the boundary gives it")
        if not self.scene.awaits_period:
            self.check_period()
        return self

    def check_period(self) -> None:
        """Raise a located PydanticCustomError for waves that do not fit the period."""
        check_waves(self.scene.surfaces, self.scene.length)
