"""YAML documents whose every error names file, line, column, what was given and what is allowed."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import isinf
from pathlib import Path
from typing import Any

import yaml

from gfmd_numba.scene.regular_file import MOST_TEXT, read_regular
from gfmd_numba.text.input_error import ABSENT, InputError, brief

Location = tuple[str | int, ...]

DEEPEST = 20


def _finite(text: str) -> object:
    """Number of a text, or the text of one too large for a float, which is not meant to be infinite."""
    return text if isinf(float(text)) else float(text)


# YAML 1.2 core schema, plus fractions; bounded digits keep every int and fraction within a float's range.
SCALARS: tuple[tuple[re.Pattern[str], Callable[[str], object]], ...] = (
    (re.compile(r"~|null|Null|NULL|"), lambda text: None),
    (re.compile(r"true|True|TRUE"), lambda text: True),
    (re.compile(r"false|False|FALSE"), lambda text: False),
    (re.compile(r"[-+]?[0-9]{1,300}"), int),
    (re.compile(r"0o[0-7]{1,64}|0x[0-9a-fA-F]{1,64}"), lambda text: int(text, 0)),
    (re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"), _finite),
    (re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)"), lambda text: float(text.replace(".", ""))),
    (
        re.compile(r"[-+]?[0-9]{1,300}/0*[1-9][0-9]{0,299}"),
        lambda text: int(text.partition("/")[0]) / int(text.partition("/")[2]),
    ),
)


@dataclass(frozen=True)
class Document:
    """Text and data of one input, with the line and column of each value and key (counted from 1).

    Names of files in it are relative to its `folder`: that of its file, or for a mapping the current one. Values of
    some locations may stand `elsewhere`, as those of a scene in the grid of its campaign.
    """

    path: Path | None
    text: str
    data: object
    positions: Mapping[Location, tuple[int, int]] = field(default_factory=dict)
    key_positions: Mapping[Location, tuple[int, int]] = field(default_factory=dict)
    flat: bool = False
    home: Path | None = None
    elsewhere: Mapping[Location, Location] = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        """Folder that names of files are relative to: `home`, if that is another than the folder of its own file."""
        own = Path() if self.path is None else self.path.parent
        return own if self.home is None else self.home

    def value(self, location: Location) -> object:
        """Value at a location, or ABSENT."""
        value: Any = self.data
        for part in self.elsewhere.get(location, location):
            try:
                value = value[part]
            except (KeyError, IndexError, TypeError, ValueError):
                return ABSENT
        return value

    def error(self, location: Location, given: object, allowed: str, suggestion: str = "") -> InputError:
        """InputError that says where a value stands, what it is, and what is allowed."""
        return InputError(self.line(location, brief(given), allowed, suggestion))

    def line(self, location: Location, given: str, allowed: str, suggestion: str = "") -> str:
        """One line of an InputError; an absent value stands where the mapping that lacks it does."""
        location = self.elsewhere.get(location, location)
        position, owner = self.positions.get(location), location
        while position is None and owner:
            position, owner = self.key_positions.get(owner), owner[:-1]
        return self._written(position, location, given, allowed, suggestion)

    def key_line(self, location: Location, given: str, allowed: str, suggestion: str = "") -> str:
        """One line of an InputError about a key, not its value."""
        return self._written(self.key_positions.get(location), location, given, allowed, suggestion)

    def _written(
        self, position: tuple[int, int] | None, location: Location, given: str, allowed: str, suggestion: str
    ) -> str:
        position = position or self.positions.get(())
        shown = location[1:] if self.flat and location[:1] == ("scene",) else location
        return _line(self.path, position, shown, given, allowed, suggestion)


def read_document(path: str | Path) -> Document:
    """Document of one YAML file; raises InputError if it is unreadable or not plain YAML 1.2."""
    path = Path(path)
    try:
        raw = read_regular(path, MOST_TEXT)
    except ValueError as error:
        raise InputError(_line(path, None, (), str(error), "a YAML file")) from None
    try:
        text = raw.decode("utf-8").removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        position = _position_after(raw[: error.start].decode("utf-8"))
        byte = f"the byte 0x{raw[error.start]:02x}"
        raise InputError(_line(path, position, (), byte, "text in UTF-8")) from None
    try:
        loader = _PlainLoader(text)
        loader.name = str(path)
        root = loader.get_single_node()
        data = ABSENT if root is None else loader.build(root, ())
    except yaml.reader.ReaderError as error:
        position = _position_after(text[: error.position])
        character = f"the character U+{ord(text[error.position]):04X}"
        raise InputError(_line(path, position, (), character, "printable text")) from None
    except yaml.MarkedYAMLError as error:
        problem = f"{error.problem or error.context}"
        if "\\t" in problem:
            given, allowed = "a tab", "spaces"
        elif error.context == "expected a single document in the stream":
            given, allowed = "a second document", "one document per file"
        else:
            given, allowed = f"text that is not YAML ({problem})", "YAML 1.2"
        mark = error.problem_mark or error.context_mark
        raise InputError(_line(path, _position(mark) if mark else None, (), given, allowed)) from None
    if data is ABSENT:
        raise InputError(_line(path, (1, 1), (), "an empty file", "a mapping of keys to values"))
    return Document(path, text, data, loader.positions, loader.key_positions)


class _PlainLoader(yaml.SafeLoader):
    """PyYAML's safe loader without aliases, anchors, tags and deep nesting, which records positions."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.depth = 0
        self.positions: dict[Location, tuple[int, int]] = {}
        self.key_positions: dict[Location, tuple[int, int]] = {}

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event: Any = self.peek_event()  # type: ignore[no-untyped-call]
        if event.anchor is not None:
            raise self.fault(event.start_mark, (), "an anchor or alias", "the value itself")
        if getattr(event, "tag", None) is not None:
            raise self.fault(event.start_mark, (), f"the tag {event.tag}", "a value without a tag")
        if self.depth == DEEPEST:
            raise self.fault(event.start_mark, (), "deeper nesting", f"at most {DEEPEST} levels")
        self.depth += 1
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def build(self, node: yaml.Node, location: Location) -> object:
        """Plain Python data of a node."""
        self.positions[location] = _position(node.start_mark)
        if isinstance(node, yaml.ScalarNode):
            return plain_scalar(node.value) if node.style is None else node.value
        if isinstance(node, yaml.SequenceNode):
            return [self.build(item, (*location, i)) for i, item in enumerate(node.value)]
        mapping: dict[str, object] = {}
        for key_node, value_node in node.value:
            scalar = isinstance(key_node, yaml.ScalarNode)
            key = plain_scalar(key_node.value) if scalar and key_node.style is None else key_node.value
            if not isinstance(key, str) or key == "<<":
                given = f"the key {brief(key)}" if scalar else "a list or mapping as a key"
                raise self.fault(key_node.start_mark, location, given, "keys that are text, no merge keys")
            inner = (*location, key)
            if key in mapping:
                given = f"the key a second time (first on line {self.key_positions[inner][0]})"
                raise self.fault(key_node.start_mark, inner, given, "each key once")
            self.key_positions[inner] = _position(key_node.start_mark)
            mapping[key] = self.build(value_node, inner)
        return mapping

    def fault(self, mark: yaml.Mark, location: Location, given: str, allowed: str) -> InputError:
        """InputError at a mark."""
        return InputError(_line(self.name, _position(mark), location, given, allowed))


def plain_scalar(text: str) -> object:
    """Value of an unquoted YAML scalar: null, a boolean, a number or the text itself."""
    return next((convert(text) for pattern, convert in SCALARS if pattern.fullmatch(text)), text)


def _position(mark: yaml.Mark) -> tuple[int, int]:
    return mark.line + 1, mark.column + 1


def _position_after(text: str) -> tuple[int, int]:
    return text.count("\n") + 1, len(text) - text.rfind("\n")


def dotted(location: Location) -> str:
    """Location as text, `grid.hurst[1]`; keys that are no short word stand in brackets."""
    words = (isinstance(part, str) and re.fullmatch(r"[\w-]{1,60}", part) for part in location)
    parts = (f".{part}" if word else f"[{brief(part)}]" for part, word in zip(location, words, strict=True))
    return "".join(parts).removeprefix(".")


def _line(
    path: str | Path | None,
    position: tuple[int, int] | None,
    location: Location,
    given: str,
    allowed: str,
    suggestion: str = "",
) -> str:
    file = "" if path is None else ":".join(map(str, (path, *(position or ())))) + ": "
    key = dotted(location) + ": " if location else ""
    may = "needs" if given == brief(ABSENT) else "allows"
    return f"{file}{key}you gave {given}; gfmd {may} {allowed}" + (f"; {suggestion}" if suggestion else "")
