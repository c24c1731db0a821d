"""A campaign given as a mapping, written as a file would be."""

from typing import Any

import yaml
from pydantic import BaseModel

from gfmd_numba.scene.document import plain_scalar


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
