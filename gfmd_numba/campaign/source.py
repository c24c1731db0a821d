"""What a campaign is read from: a file, or a mapping, which is then written as a file would be."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel

from gfmd_numba.scene.document import Document, InputError, brief, plain_scalar, read_document

Source = str | Path | Mapping[str, Any]


def campaign_document(source: Source) -> Document:
    """Document of a file or a mapping, that of a mapping without text; raises InputError."""
    if isinstance(source, Mapping):
        return Document(None, "", dict(source))
    if isinstance(source, str | os.PathLike):
        return read_document(source)
    allowed = "the path of a campaign file, or a mapping of its keys"
    raise InputError(f"campaign: given {brief(source)}; allowed: {allowed}")


def written(record: BaseModel) -> str:
    """YAML text of a record, from which an equal one is read."""
    return yaml.dump(record.model_dump(exclude_unset=True), Dumper=_PlainDumper, sort_keys=False)


class _PlainDumper(yaml.SafeDumper):
    """PyYAML's safe dumper without aliases, for the loader of documents."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.Node:
    """Text, quoted if it would be read as a number or the like."""
    style = None if plain_scalar(text) == text else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style)


_PlainDumper.add_representer(str, _text)
_PlainDumper.add_multi_representer(float, lambda dumper, number: dumper.represent_float(float(number)))
