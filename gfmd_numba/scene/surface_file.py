"""Surface files and the checks that need more than their records."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gfmd_numba.scene.document import Document
from gfmd_numba.scene.scene_file import document_of, existing_file
from gfmd_numba.scene.surface_records import MeasuredField, SurfaceFile
from gfmd_numba.scene.validation import validate

_ARRAYS = 16  # of the surface's size, that making it and its statistics may take


def load_surface(source: str | Path | Mapping[str, Any]) -> tuple[SurfaceFile, Document]:
    """Checked surface of a YAML file or mapping, and the document itself; raises InputError."""
    document = document_of(source, "source")
    file = validate(document, SurfaceFile)
    if file.points is not None:
        _check_memory(document, file.points ** (file.dimension or 1))
    if isinstance(file.surface, MeasuredField):
        measured = existing_file(document, ("surface", "file"), file.surface.file, ())
        file = file.model_copy(update={"surface": file.surface.model_copy(update={"file": measured})})
    return file, document


def _check_memory(document: Document, samples: int) -> None:
    import psutil

    needed, available = 8 * samples * _ARRAYS / 1e9, psutil.virtual_memory().total / 1e9
    if needed > available:
        allowed = f"a grid that fits in {available:.3g} GB of memory, where this needs {needed:.3g} GB"
        raise document.error(("points",), document.value(("points",)), allowed)
