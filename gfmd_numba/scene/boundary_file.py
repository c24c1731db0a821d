"""Files of boundary-value problems: a body without a punch, and what is prescribed on its surface."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from pydantic import BaseModel, Field, model_validator

from gfmd_numba.scene.body_record import Body
from gfmd_numba.scene.boundary_records import Boundary
from gfmd_numba.scene.document import Document
from gfmd_numba.scene.layer_records import check_layers
from gfmd_numba.scene.quantities import RECORD, Size, broken_rule
from gfmd_numba.scene.records import Numerics, Scene
from gfmd_numba.scene.scene_file import load_scene, located_boundary, scene_document
from gfmd_numba.scene.surfaces import Measured
from gfmd_numba.scene.validation import validate

_OF_A_PUNCH = {"roughness", "interface", "loading"}


class LoadedBody(BaseModel):
    """A body, what is prescribed on its surface, and the period L_x in m."""

    model_config = RECORD
    body: Body = Field(description="Elastic body")
    boundary: Boundary = Field(description="Prescribed tractions and displacements")
    length: Size | None = Field(None, description="Period L_x in m; None: lengths are in units of L_x")

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
    points: int | None = Field(None, ge=4, le=2**22, description="Nodes over the period; None: as many as in the files")

    @model_validator(mode="after")
    def _parts_agree(self) -> Self:
        if self.points is None and not any(isinstance(values, str) for _, values in self.scene.boundary):
            raise broken_rule(("points",), "the number of nodes, which no file of the boundary tells")
        return self


def has_no_punch(source: str | Path | Mapping[str, Any]) -> bool:
    """Whether a file or mapping describes a boundary-value problem; raises InputError if it is unreadable."""
    data = scene_document(source).value(("scene",))
    return isinstance(data, dict) and "boundary" in data and not _OF_A_PUNCH & data.keys()


def load_boundary(source: str | Path | Mapping[str, Any] | BoundaryFile) -> tuple[BoundaryFile, Document]:
    """Checked boundary-value problem and the document behind it; raises InputError."""
    if isinstance(source, BoundaryFile):
        document, file = Document(None, "", source.model_dump()), source
    else:
        document = scene_document(source)
        file = validate(document, BoundaryFile)
    boundary = located_boundary(document, file.scene.boundary)
    return file.model_copy(update={"scene": file.scene.model_copy(update={"boundary": boundary})}), document


def input_files(source: str | Path) -> list[Path]:
    """Files that a scene file, with a punch or without, reads besides itself; raises InputError."""
    scene = load_boundary(source)[0].scene if has_no_punch(source) else load_scene(source).scene
    named = [value for _, value in scene.boundary or () if isinstance(value, str)]
    if isinstance(scene, Scene):
        rough = (scene.roughness, *(body.roughness for body in scene.deformable))
        named += [roughness.file for roughness in rough if isinstance(roughness, Measured)]
    return [Path(name) for name in named]
