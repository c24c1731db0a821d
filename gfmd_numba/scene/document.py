"""YAML documents whose every error names file, line, column, what was given and what is allowed."""

import os
import re
import reprlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from gfmd_numba.scene.records import Discretisation, Measured, Scene, SceneFile

Location = tuple[str | int, ...]
Record = TypeVar("Record", bound=BaseModel)

DEEPEST = 20
ARRAYS_PER_REALISATION = 16
PROFILE_SUFFIXES = (".npy", ".csv", ".nc")
ABSENT = object()

# YAML 1.2 core schema, plus fractions; bounded digits keep every int and fraction within a float's range.
SCALARS: tuple[tuple[re.Pattern[str], Callable[[str], object]], ...] = (
    (re.compile(r"~|null|Null|NULL|"), lambda text: None),
    (re.compile(r"true|True|TRUE"), lambda text: True),
    (re.compile(r"false|False|FALSE"), lambda text: False),
    (re.compile(r"[-+]?[0-9]{1,300}"), int),
    (re.compile(r"0o[0-7]{1,64}|0x[0-9a-fA-F]{1,64}"), lambda text: int(text, 0)),
    (re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"), float),
    (re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)"), lambda text: float(text.replace(".", ""))),
    (
        re.compile(r"[-+]?[0-9]{1,300}/0*[1-9][0-9]{0,299}"),
        lambda text: int(text.partition("/")[0]) / int(text.partition("/")[2]),
    ),
)

_short = reprlib.Repr()
_short.maxstring = _short.maxother = _short.maxlong = 60
_short.maxlevel = 2


class InputError(ValueError):
    """What is wrong with the input, one `FILE:LINE:COLUMN: key: given ...; allowed: ...` per line."""


@dataclass(frozen=True)
class Document:
    """Text and data of one input, with the line and column of each value and key (counted from 1)."""

    path: Path | None
    text: str
    data: object
    positions: Mapping[Location, tuple[int, int]] = field(default_factory=dict)
    key_positions: Mapping[Location, tuple[int, int]] = field(default_factory=dict)
    flat: bool = False

    def value(self, location: Location) -> object:
        """Value at a location, or ABSENT."""
        value: Any = self.data
        for part in location:
            try:
                value = value[part]
            except (KeyError, IndexError, TypeError):
                return ABSENT
        return value

    def error(self, location: Location, given: object, allowed: str, suggestion: str = "") -> InputError:
        """InputError that says where a value stands, what it is, and what is allowed."""
        return InputError(self.line(location, _brief(given), allowed, suggestion))

    def line(self, location: Location, given: str, allowed: str, suggestion: str = "") -> str:
        """One line of an InputError; an absent value stands where the mapping that lacks it does."""
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
        raw = path.read_bytes()
    except OSError as error:
        given = f"a path that cannot be read ({error.strerror})"
        raise InputError(_line(path, None, (), given, "a YAML file")) from None
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
            return _plain(node.value) if node.style is None else node.value
        if isinstance(node, yaml.SequenceNode):
            return [self.build(item, (*location, i)) for i, item in enumerate(node.value)]
        mapping: dict[str, object] = {}
        for key_node, value_node in node.value:
            scalar = isinstance(key_node, yaml.ScalarNode)
            key = _plain(key_node.value) if scalar and key_node.style is None else key_node.value
            if not isinstance(key, str) or key == "<<":
                given = f"the key {_brief(key)}" if scalar else "a list or mapping as a key"
                raise self.fault(key_node.start_mark, location, given, "keys that are text, no merge keys")
            inner = (*location, key)
            if key in mapping:
                given = f"a second time (first on line {self.key_positions[inner][0]})"
                raise self.fault(key_node.start_mark, inner, given, "each key once")
            self.key_positions[inner] = _position(key_node.start_mark)
            mapping[key] = self.build(value_node, inner)
        return mapping

    def fault(self, mark: yaml.Mark, location: Location, given: str, allowed: str) -> InputError:
        """InputError at a mark."""
        return InputError(_line(self.name, _position(mark), location, given, allowed))


def _plain(text: str) -> object:
    """Value of an unquoted YAML scalar: null, a boolean, a number or the text itself."""
    return next((convert(text) for pattern, convert in SCALARS if pattern.fullmatch(text)), text)


def _position(mark: yaml.Mark) -> tuple[int, int]:
    return mark.line + 1, mark.column + 1


def _position_after(text: str) -> tuple[int, int]:
    return text.count("\n") + 1, len(text) - text.rfind("\n")


def _dotted(location: Location) -> str:
    """Location as text, `grid.hurst[1]`; keys that are no short word stand in brackets."""
    words = (isinstance(part, str) and re.fullmatch(r"[\w-]{1,60}", part) for part in location)
    parts = (f".{part}" if word else f"[{_brief(part)}]" for part, word in zip(location, words, strict=True))
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
    key = _dotted(location) + ": " if location else ""
    return f"{file}{key}given {given}; allowed: {allowed}" + (f"; {suggestion}" if suggestion else "")


def _brief(value: object) -> str:
    if value is ABSENT:
        return "nothing"
    if value is None:
        return "an empty value"
    return str(value).lower() if isinstance(value, bool) else _short.repr(value)


def validate(document: Document, model: type[Record]) -> Record:
    """Record of a document's data; raises InputError with one line per fault."""
    try:
        return model.model_validate(document.data)
    except ValidationError as error:
        schema = model.model_json_schema()
        faults = error.errors(include_url=False)
        raise InputError("\n".join(_fault(document, schema, fault) for fault in faults)) from None


def _fault(document: Document, schema: dict[str, Any], fault: ErrorDetails) -> str:
    location, node = _at(schema, fault["loc"])
    match fault["type"]:
        case "rule":
            location += fault["ctx"]["location"]
            return document.line(location, _brief(document.value(location)), fault["ctx"]["allowed"])
        case "extra_forbidden" | "invalid_key":
            siblings = list(_at(schema, fault["loc"][:-1])[1]["properties"])
            if document.flat and len(location) == 2:
                siblings += [key for key in schema["properties"] if key != "scene"]
            hint = _belongs(schema, str(location[-1])) or _nearest(location[-1], siblings)
            return document.key_line(location, "an unknown key", _listed(siblings), hint)
        case "union_tag_invalid" | "union_tag_not_found":
            location += (node["discriminator"]["propertyName"],)
            node = {"enum": list(node["discriminator"]["mapping"])}
    value = document.value(location)
    hint = _nearest(value, node.get("enum", ()))
    if isinstance(value, str) and isinstance(_plain(value), int | float) and "enum" not in node:
        hint = f"did you mean {value} without quotes?"
    return document.line(location, _brief(value), _allowed(schema, node), hint)


def _at(schema: dict[str, Any], loc: Iterable[str | int]) -> tuple[Location, dict[str, Any]]:
    """Location in the document, free of union tags, and JSON Schema node of an error's location."""
    location: Location = ()
    node = schema
    for part in loc:
        tagged = node.get("discriminator", {}).get("mapping", {})
        if part in tagged:
            node = _resolved(schema, {"$ref": tagged[part]})
        else:
            location += (part,)
            inner = (
                node.get("items", {}) if isinstance(part, int) else node.get("properties", {}).get(part, {})
            )
            node = _resolved(schema, inner)
    return location, node


def _resolved(schema: dict[str, Any], node: dict[str, Any]) -> dict[str, Any]:
    choices = node.get("anyOf") or node.get("allOf") or [node]
    node = next(choice for choice in choices if choice.get("type") != "null")
    if "$ref" in node:
        resolved: dict[str, Any] = schema["$defs"][node["$ref"].rpartition("/")[2]]
        return resolved
    return node


def _allowed(schema: dict[str, Any], node: dict[str, Any]) -> str:
    """Plain words for what a JSON Schema node admits."""
    if "allowed" in node:
        return str(node["allowed"])
    if "enum" in node or "const" in node:
        return _listed(node.get("enum", [node.get("const")]))
    if "discriminator" in node:
        union = node["discriminator"]
        return f"a mapping with {union['propertyName']} {_listed(union['mapping'])}"
    match node.get("type"):
        case "array":
            item = _allowed(schema, _resolved(schema, node["items"]))
            return "a list of one or more " + item.removeprefix("a ").replace("number", "numbers", 1)
        case "object":
            return "a mapping of " + ", ".join(map(repr, node["properties"])) if node["properties"] else "{}"
        case "integer":
            return "a whole number" + _range(node)
        case "number":
            return ("a number" if "maximum" in node else "a finite number") + _range(node)
    return "text"


def _range(node: dict[str, Any]) -> str:
    if "minimum" in node and "maximum" in node:
        return f" from {node['minimum']} to {node['maximum']}"
    words = {
        "exclusiveMinimum": "above",
        "minimum": "at least",
        "maximum": "at most",
        "exclusiveMaximum": "below",
    }
    bounds = [f"{word} {node[bound]}" for bound, word in words.items() if bound in node]
    return " " + " and ".join(bounds) if bounds else ""


def _listed(names: Iterable[str]) -> str:
    quoted = [repr(name) for name in names]
    return quoted[0] if len(quoted) == 1 else "one of " + ", ".join(quoted)


def _nearest(given: object, names: Iterable[str]) -> str:
    matches = get_close_matches(given, names, 1) if isinstance(given, str) else []
    return f"did you mean {matches[0]!r}?" if matches else ""


def _belongs(schema: dict[str, Any], key: str) -> str:
    homes = [home for home, name in _keys(schema, schema, "") if name == key]
    return f"'{key}' belongs to {' or '.join(home or 'the top level' for home in homes)}" if homes else ""


def _keys(schema: dict[str, Any], node: dict[str, Any], home: str) -> Iterator[tuple[str, str]]:
    """Every key the model knows, with the dotted name of the mapping that holds it."""
    for tag, reference in node.get("discriminator", {}).get("mapping", {}).items():
        inside = f"{home} with {node['discriminator']['propertyName']} {tag}"
        yield from _keys(schema, _resolved(schema, {"$ref": reference}), inside)
    for name, inner in node.get("properties", {}).items():
        yield home, name
        yield from _keys(schema, _resolved(schema, inner), f"{home}.{name}".removeprefix("."))


def check_discretisation(
    document: Document,
    discretisation: Discretisation,
    locations: Mapping[str, Location],
    varied: str | None = None,
) -> None:
    """Raise InputError, at the varied value if any, unless waves are whole and the grid fits in memory."""
    import psutil

    eps = discretisation.model_dump()
    nx = discretisation.waves["eps_c"]
    needed, available = 8 * nx * ARRAYS_PER_REALISATION / 1e9, psutil.virtual_memory().total / 1e9
    if needed > available:
        axis = varied or min(eps, key=eps.__getitem__)
        raise document.error(
            locations[axis],
            document.value(locations[axis]),
            f"a grid that fits in {available:.3g} GB of memory, where nx = {nx:.6g} needs {needed:.3g} GB",
        )
    misfit = discretisation.misfit
    if misfit is not None:
        axis = varied or misfit
        others = " and ".join(f"{name} = {value:.6g}" for name, value in eps.items() if name != axis)
        fit = discretisation.nearest_fit(axis)
        raise document.error(
            locations[axis],
            document.value(locations[axis]),
            "a value that makes 1/eps_t, 1/(eps_t eps_f) and nx = 2/(eps_t eps_f eps_c) whole numbers, "
            f"nx at least 4, with {others}",
            "" if fit is None else f"did you mean {fit}?",
        )


def load_scene(source: str | Path | Mapping[str, Any] | SceneFile) -> SceneFile:
    """Checked scene of a YAML file, nested or flat, a mapping or a record; raises InputError."""
    if isinstance(source, SceneFile):
        document, scene_file = Document(None, "", source.model_dump()), source
    else:
        document = Document(None, "", dict(source)) if isinstance(source, Mapping) else read_document(source)
        document = _nested(document)
        scene_file = validate(document, SceneFile)
    if scene_file.discretisation is not None:
        axes = Discretisation.model_fields
        check_discretisation(
            document, scene_file.discretisation, {axis: ("discretisation", axis) for axis in axes}
        )
    if isinstance(scene_file.scene.roughness, Measured):
        profile = _profile(document, scene_file.scene.roughness)
        scene = scene_file.scene.model_copy(update={"roughness": profile})
        scene_file = scene_file.model_copy(update={"scene": scene})
    return scene_file


def _nested(document: Document) -> Document:
    """Document with a flat file's scene gathered under `scene`, its positions with it."""
    data = document.data
    if not isinstance(data, dict) or "scene" in data or not any(key in Scene.model_fields for key in data):
        return document

    def home(location: Location) -> Location:
        return location if not location or location[0] in SceneFile.model_fields else ("scene", *location)

    nested: dict[str, Any] = {"scene": {}}
    for key, value in data.items():
        (nested if key in SceneFile.model_fields else nested["scene"])[key] = value
    return replace(
        document,
        data=nested,
        positions={home(location): at for location, at in document.positions.items()},
        key_positions={home(location): at for location, at in document.key_positions.items()},
        flat=True,
    )


def _profile(document: Document, roughness: Measured) -> Measured:
    """Measured roughness with an absolute path to an existing profile of a known kind."""
    location = ("scene", "roughness", "file")
    folder = Path() if document.path is None else document.path.parent
    file = folder / roughness.file
    if file.suffix not in PROFILE_SUFFIXES:
        raise document.error(location, roughness.file, "a file ending in " + ", ".join(PROFILE_SUFFIXES))
    if not os.path.isfile(file):
        present = [p.name for p in folder.iterdir() if p.suffix in PROFILE_SUFFIXES]
        raise document.error(
            location, roughness.file, f"an existing file, unlike {file}", _nearest(roughness.file, present)
        )
    return roughness.model_copy(update={"file": str(file.resolve())})
