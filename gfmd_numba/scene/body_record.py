"""The record of one elastic body: of one material, or of layers from its surface downwards and what they rest on."""

from math import inf, isfinite, isinf
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, Discriminator, Field, Tag, WithJsonSchema, model_validator

from gfmd_numba.scene.quantities import (
    RECORD,
    AspectRatio,
    Duration,
    Length,
    NonnegativePressure,
    PoissonsRatio,
    Pressure,
    broken_rule,
)
from gfmd_numba.scene.surfaces import Surface
from gfmd_numba.scene.units import in_unit_of

THINNEST, HIGHEST = 1e-12, 1e30  # heights over the period, as of a slab
LARGEST_CONTRAST = 1e8  # of two moduli of a stack, up to which stiffnesses are right to eleven digits
_RIGID = {
    "const": "rigid",
    "type": "string",
    "allowed": "'rigid', or a mapping of 'youngs_modulus', 'poissons_ratio' for a half-space of that material",
}


class MaterialRecord(BaseModel):
    """Linear elastic isotropic material: modulus in Pa, ratio dimensionless."""

    model_config = RECORD
    youngs_modulus: Pressure = Field(description="Young's modulus in Pa")
    poissons_ratio: PoissonsRatio


class Layer(MaterialRecord):
    """Layer of one material, bonded to what is above and below it."""

    height: Length = Field(description="Height in m, or in L_x without a length")


class Branch(BaseModel):
    """Branch of a generalised Maxwell body: a spring and a dashpot in series, in parallel with all other branches."""

    model_config = RECORD
    modulus: Pressure = Field(description="Young's modulus of the spring in Pa (in that of the body without moduli)")
    time: Duration = Field(description="Relaxation time in s, after which its stress has fallen to 1/e")


class Plasticity(BaseModel):
    """J2 plasticity with isotropic hardening, linear and after Voce, in a layer below the surface."""

    model_config = RECORD
    yield_stress: Pressure = Field(description="Uniaxial yield stress in Pa (E* without moduli)")
    hardening: NonnegativePressure | None = Field(
        None, description="Slope of the yield stress over the equivalent plastic strain, in Pa; None: 0"
    )
    saturation_stress: Pressure | None = Field(
        None, description="Yield stress that Voce's hardening tends to, beside the linear one, in Pa; None: none"
    )
    saturation_strain: float | None = Field(
        None, ge=1e-6, le=1e3, description="Equivalent plastic strain after which 1 - 1/e of Voce's hardening is done"
    )
    depth: Length | None = Field(
        None, description="Depth in m (L_x without a length) down to which the body may flow; None: found by itself"
    )
    sublayers: int = Field(32, ge=4, le=1024, description="Sublayers of that depth, with one plastic strain each")
    increments: int = Field(8, ge=1, le=1000, description="Increments into which each step of the loading is divided")

    @model_validator(mode="after")
    def _saturates(self) -> Self:
        if (self.saturation_stress is None) != (self.saturation_strain is None):
            missing = "saturation_stress" if self.saturation_stress is None else "saturation_strain"
            raise broken_rule((missing,), "a number: Voce's hardening has a saturation_stress and a saturation_strain")
        if self.saturation_stress is not None and self.saturation_stress <= self.yield_stress:
            raise broken_rule(("saturation_stress",), f"a stress above the yield_stress, {self.yield_stress:g}")
        return self


def _kind(given: Any) -> str:
    return "MaterialRecord" if isinstance(given, dict | MaterialRecord) else "rigid"


Base = Annotated[
    Annotated[MaterialRecord, Tag("MaterialRecord")]
    | Annotated[Literal["rigid"], Tag("rigid"), WithJsonSchema(_RIGID)],
    Discriminator(_kind),
]


class Body(BaseModel):
    """Linear elastic body, of one isotropic material or of layers: moduli in Pa, ratios dimensionless."""

    model_config = RECORD
    youngs_modulus: Pressure | None = Field(
        None, description="Young's modulus in Pa; None: stresses are in units of E*"
    )
    poissons_ratio: PoissonsRatio | None = Field(
        None, description="Poisson's ratio (dimensionless); None: the layers have their own"
    )
    aspect_ratio: AspectRatio = inf
    layers: tuple[Layer, ...] | None = Field(
        None,
        strict=False,
        min_length=1,
        description="Layers from the surface downwards, in place of one material; E* in reduced_pressure and kappa, "
        "and wherever stresses count in E*, is then that of the first one, E/(1 - nu^2) in plane strain",
    )
    base: Base | None = Field(None, description="What layers rest on: rigid, or the material of a half-space")
    relaxation: tuple[Branch, ...] | None = Field(
        None,
        strict=False,
        min_length=1,
        description="Branches of a viscoelastic body, whose youngs_modulus is then the relaxed one; its Poisson's "
        "ratio is constant. Layers and their base relax all alike, and moduli of branches are beside the topmost layer",
    )
    plasticity: Plasticity | None = Field(None, description="Plastic flow inside the body; None: it is elastic")
    state: Literal["plane_strain", "plane_stress"] = Field(
        "plane_strain", description="What is zero along the third direction: strain or stress"
    )
    roughness: Surface | None = Field(
        None, description="Topography of the body itself, peaks towards the punch; aspect_ratio is of its mean plane"
    )

    @property
    def surface_modulus(self) -> float | None:
        """Young's modulus at the surface, of layers that of the topmost one; None: stresses stay in E*."""
        return self.youngs_modulus if self.layers is None else self.layers[0].youngs_modulus

    @property
    def surface_poissons_ratio(self) -> float:
        """Poisson's ratio at the surface (dimensionless)."""
        nu = self.poissons_ratio if self.layers is None else self.layers[0].poissons_ratio
        assert nu is not None  # the rule below
        return nu

    @property
    def is_half_space(self) -> bool:
        """Whether it has no end below, so that nothing holds its mean displacement."""
        return isinf(self.aspect_ratio) if self.layers is None else isinstance(self.base, MaterialRecord)

    @property
    def holder(self) -> str:
        """What would hold its mean displacement, as a file says it."""
        return "a finite aspect_ratio" if self.layers is None else "base rigid"

    @property
    def is_incompressible(self) -> bool:
        """Whether nothing in it changes its volume."""
        if self.state == "plane_stress":
            return False
        return all(part.poissons_ratio == 0.5 for part in self.materials.values() or (self,))

    @model_validator(mode="after")
    def _one_material_or_layers(self) -> Self:
        if self.layers is None:
            if self.poissons_ratio is None:
                raise broken_rule(("poissons_ratio",), "a number above -1 and at most 0.5")
            if self.base is not None:
                raise broken_rule(("base",), "nothing without layers: a body of one material has an aspect_ratio")
            return self
        own = {"youngs_modulus": self.youngs_modulus, "poissons_ratio": self.poissons_ratio}
        if isfinite(self.aspect_ratio):
            own["aspect_ratio"] = self.aspect_ratio
        for name, value in own.items():
            if value is not None:
                raise broken_rule((name,), "nothing with layers, which have their own moduli, ratios and heights")
        if self.base is None:
            raise broken_rule(("base",), "'rigid' or a mapping of 'youngs_modulus', 'poissons_ratio' under layers")
        return self

    @property
    def materials(self) -> dict[tuple[str | int, ...], MaterialRecord]:
        """The layers from above, and a base that is no rigid one, by their places in the body."""
        layers = self.layers or ()
        found: dict[tuple[str | int, ...], MaterialRecord] = {("layers", i): each for i, each in enumerate(layers)}
        if isinstance(self.base, MaterialRecord):
            found["base",] = self.base
        return found

    def check_layers(self, place: tuple[str, ...], length: float | None) -> None:
        """Raise a located PydanticCustomError for layers too thin or thick for the period, or of too unequal moduli."""
        if self.layers is None:
            return
        unit = "L_x" if length is None else "m"
        least, most = THINNEST * (length or 1.0), HIGHEST * (length or 1.0)
        for i, layer in enumerate(self.layers):
            if not least <= layer.height <= most:
                lowest, highest = (in_unit_of(layer.height, each, unit) for each in (least, most))
                raise broken_rule((*place, "layers", i, "height"), f"a height from {lowest} to {highest}")
        first = self.layers[0].youngs_modulus
        softest, stiffest = first / LARGEST_CONTRAST, first * LARGEST_CONTRAST
        for where, part in self.materials.items():
            if not softest <= part.youngs_modulus <= stiffest:
                ends = " to ".join(in_unit_of(part.youngs_modulus, each) for each in (softest, stiffest))
                allowed = f"a modulus from {ends}, within {LARGEST_CONTRAST:g} times that of the top layer"
                raise broken_rule((*place, *where, "youngs_modulus"), allowed)

    def thinnest_layer(self, length: float | None) -> float:
        """Return the height of the thinnest layer, or of the body if it is one, over the period; inf without any."""
        if self.layers is None:
            return self.aspect_ratio
        return min(layer.height for layer in self.layers) / (length or 1.0)

    def effective_poissons_ratio(self, nu: float) -> float:
        """Poisson's ratio of the plane strain material that deforms like one of nu (dimensionless)."""
        return nu if self.state == "plane_strain" else nu / (1.0 + nu)
