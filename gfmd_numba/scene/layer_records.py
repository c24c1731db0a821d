"""Layers of a body, from its surface downwards, and what they rest on."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Discriminator, Field, Tag, WithJsonSchema

from gfmd_numba.scene.quantities import RECORD, Length, PoissonsRatio, Pressure, broken_rule
from gfmd_numba.scene.units import in_unit_of

THINNEST, HIGHEST = 1e-12, 1e30  # heights over the period, as of a slab
LARGEST_CONTRAST = 1e8  # of two moduli of a stack, up to which stiffnesses are right to eleven digits


class Material(BaseModel):
    """Linear elastic isotropic material: modulus in Pa, ratio dimensionless."""

    model_config = RECORD
    youngs_modulus: Pressure = Field(description="Young's modulus in Pa")
    poissons_ratio: PoissonsRatio


class Layer(Material):
    """Layer of one material, bonded to what is above and below it."""

    height: Length = Field(description="Height in m, or in L_x without a length")


def _kind(given: Any) -> str:
    return "Material" if isinstance(given, dict | Material) else "rigid"


_RIGID = {
    "const": "rigid",
    "type": "string",
    "allowed": "'rigid', or a mapping of 'youngs_modulus', 'poissons_ratio' for a half-space of that material",
}
Base = Annotated[
    Annotated[Material, Tag("Material")] | Annotated[Literal["rigid"], Tag("rigid"), WithJsonSchema(_RIGID)],
    Discriminator(_kind),
]


def check_layers(place: tuple[str, ...], layers: tuple[Layer, ...], base: Base, length: float | None) -> None:
    """Raise a located PydanticCustomError for layers too thin or thick for the period, or of too unequal moduli."""
    unit = "L_x" if length is None else "m"
    least, most = THINNEST * (length or 1.0), HIGHEST * (length or 1.0)
    for i, layer in enumerate(layers):
        if not least <= layer.height <= most:
            lowest, highest = (in_unit_of(layer.height, each, unit) for each in (least, most))
            raise broken_rule((*place, "layers", i, "height"), f"a height from {lowest} to {highest}")
    first = layers[0].youngs_modulus
    parts: list[tuple[tuple[str | int, ...], Material]] = [(("layers", i), layer) for i, layer in enumerate(layers)]
    if isinstance(base, Material):
        parts.append((("base",), base))
    for where, part in parts:
        softest, stiffest = first / LARGEST_CONTRAST, first * LARGEST_CONTRAST
        if not softest <= part.youngs_modulus <= stiffest:
            ends = " to ".join(in_unit_of(part.youngs_modulus, each) for each in (softest, stiffest))
            allowed = f"a modulus from {ends}, within {LARGEST_CONTRAST:g} times that of the top layer"
            raise broken_rule((*place, *where, "youngs_modulus"), allowed)
