"""Surface files: one rough surface, random or measured, its period and its realisation."""

from typing import Self

from pydantic import BaseModel, Field, model_validator

from gfmd_numba.scene.checks import ARRAYS_OF_A_SURFACE, check_nodes
from gfmd_numba.scene.document import Document, Source, document_of, validate
from gfmd_numba.scene.measured_record import Measured
from gfmd_numba.scene.quantities import RECORD, Dimension, Length, Seed, broken_rule, check_scales, check_seed
from gfmd_numba.scene.scene_file import located
from gfmd_numba.scene.surfaces import Surface
from gfmd_numba.scene.units import in_unit_of
from gfmd_numba.text.input_error import ABSENT, InputError


class HurstRange(BaseModel):
    """Wavelengths between which the Hurst exponent is fitted."""

    model_config = RECORD
    shortest: Length
    longest: Length

    @model_validator(mode="after")
    def _order(self) -> Self:
        if self.shortest >= self.longest:
            raise broken_rule(("shortest",), f"a wavelength below longest = {in_unit_of(self.shortest, self.longest)}")
        return self


class SurfaceFile(BaseModel):
    """One rough surface: how it is made, its period L_x and its realisation."""

    model_config = RECORD
    surface: Surface
    length: Length | None = Field(
        None,
        description="Period L_x in m; None: that of a measured file with positions, and otherwise lengths are in L_x",
    )
    dimension: Dimension | None = Field(None, description="1: a profile, 2: a map; a measured field has its own")
    seed: Seed = 0
    realisation: int = Field(0, ge=0, lt=2**63, description="Which realisation of the random surface")
    hurst_range: HurstRange | None = Field(None, description="Where the Hurst exponent is fitted; None: nowhere")

    @model_validator(mode="after")
    def _parts_agree(self) -> Self:
        surface = self.surface
        if isinstance(surface, Measured):
            if self.dimension is not None:
                raise broken_rule(("dimension",), "nothing, as a measured field has its own")
            check_seed(self.seed, self.realisation, is_random=False)
            return self  # its file may tell the period, which units need
        check_scales(self, self.length, has_moduli=False)
        if surface.points is None:
            raise broken_rule(("surface", "points"), "a whole number at least 4, with cut_on and roll_off")
        of_maps = [f"{surface.named_by} {getattr(surface, surface.named_by)}"] if surface.of_maps else []
        of_maps += ["an anisotropy"] if getattr(surface, "anisotropy", None) is not None else []
        if self.dimension != 2 and of_maps:
            raise broken_rule(("dimension",), f"2, which {of_maps[0]} needs")
        wrong = surface.misfit(self.length or 1.0)
        if wrong is not None:
            raise broken_rule(("surface", wrong[0]), wrong[1])
        return self


def load_surface(source: Source | SurfaceFile) -> tuple[SurfaceFile, Document]:
    """Checked surface of a YAML file, a mapping or a record, and the document itself; raises InputError."""
    if isinstance(source, SurfaceFile):
        document, file = Document(None, "", source.model_dump()), source
    else:
        document = document_of(source, "surface")
        if document.value(("surface",)) is ABSENT and document.value(("scene",)) is not ABSENT:
            allowed = "a file of a surface: write the scene's roughness under `surface`, and its length below that"
            raise InputError(document.line(("scene",), "a scene", allowed, of_key=True))
        file = validate(document, SurfaceFile)
    if file.surface.points is not None:
        nodes = float(file.surface.points) ** (file.dimension or 1)
        check_nodes(document, ("surface", "points"), nodes, ARRAYS_OF_A_SURFACE)
    return file.model_copy(update={"surface": located(document, file.surface, ("surface",))}), document
