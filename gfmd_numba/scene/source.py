"""From what a user hands over to a document, and from the names in a document to files."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gfmd_numba.scene.document import Document, Location, read_document
from gfmd_numba.scene.validation import nearest
from gfmd_numba.text.input_error import InputError, brief

Source = str | Path | Mapping[str, Any] | Document  # of a description: a YAML file, a mapping of its content


def document_of(source: object, name: str) -> Document:
    """Document of a YAML file or a mapping, or one that was read before.

    Raises InputError, by the argument's name, for anything else.
    """
    if isinstance(source, Document):
        return source
    if isinstance(source, Mapping):
        return Document(None, "", dict(source))
    if isinstance(source, str | os.PathLike):
        return read_document(Path(source))
    raise InputError(
        f"{name}: you gave {brief(source)}; gfmd allows the path of a YAML file, or a mapping of its content"
    )


def existing_file(document: Document, location: Location, name: str, suffixes: tuple[str, ...]) -> str:
    """Absolute path of an existing file of a known kind (any, if none is named), relative to the document's folder."""
    folder = document.folder
    file = folder / name
    if suffixes and file.suffix not in suffixes:
        raise document.error(location, name, "a file ending in " + ", ".join(suffixes))
    if not os.path.isfile(file):
        kind = "the folder " if os.path.isdir(file) else "no regular file " if os.path.exists(file) else ""
        hint = nearest(name, _files(folder, suffixes))
        raise document.error(location, name, f"an existing file, unlike {kind}{file}", hint)
    return os.path.abspath(file)  # a link keeps its name, which tells the kind


def _files(folder: Path, suffixes: tuple[str, ...]) -> list[str]:
    """Names of the files of a kind in a folder, none if it may not be looked into."""
    try:
        return [each.name for each in folder.iterdir() if (not suffixes or each.suffix in suffixes) and each.is_file()]
    except OSError:
        return []
