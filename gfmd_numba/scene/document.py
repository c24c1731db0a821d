"""YAML documents and their check against records: every error names file, line, column, what was given, what may be."""

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cache
from math import isfinite, isinf
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from gfmd_numba.scene.regular_file import MOST_TEXT, read_regular
from gfmd_numba.scene.units import has_unit, respelt
from gfmd_numba.text.input_error import ABSENT, MOST_LINES, InputError, brief

Location = tuple[str | int, ...]

DEEPEST = 20
_LONGEST = 100  # of a text that may be a number, and
_MOST_HOMES = 6  # of a key, that a message names
_POINT = "decimals have a point, like 1.5"
_ELSEWHERE = {  # names of other programs and of standards: ours
    **{"e": "youngs_modulus", "modulus": "youngs_modulus", "nu": "poissons_ratio", "mu": "coefficient"},
    **dict.fromkeys(("lambda_s", "stylus_radius", "tip_radius", "filter", "lowpass"), "cutoff"),
    **dict.fromkeys(("lambda_c", "lambda_f", "highpass", "level", "leveling"), "detrend"),
    **dict.fromkeys(("plane", "linear", "line"), "tilt"),
    **dict.fromkeys(("parabola", "quadratic", "polynomial", "bow", "form"), "curvature"),
    **dict.fromkeys(("adhesion", "jkr", "dmt"), "exponential"),
}
_LOADS = "one load: several are those of `gfmd curve --loads`, of a `path`, or of the grid of a campaign"
_MEASURED = "'measured' for the heights of a file: add `method: measured`"


# YAML 1.2 core schema, plus fractions; bounded digits keep every int and fraction within a float's range.
SCALARS: tuple[tuple[re.Pattern[str], Callable[[str], object]], ...] = (
    (re.compile(r"~|null|Null|NULL|"), lambda text: None),
    (re.compile(r"true|True|TRUE"), lambda text: True),
    (re.compile(r"false|False|FALSE"), lambda text: False),
    (re.compile(r"[-+]?[0-9]{1,300}"), int),
    (re.compile(r"0o[0-7]{1,64}|0x[0-9a-fA-F]{1,64}"), lambda text: int(text, 0)),
    (  # one too large for a float stays a text: it is not meant to be infinite
        re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"),
        lambda text: text if isinf(float(text)) else float(text),
    ),
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

    @property
    def written(self) -> str:
        """What was written: the text of the file, or a mapping as YAML, with an array as `...`."""
        own: dict[str, Any] = {"sort_keys": False, "allow_unicode": True, "width": 100, "default_flow_style": None}
        return self.text or yaml.dump(_plain(self.data), Dumper=_PlainDumper, **own)

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
        return self.fault(location, brief(given), allowed, suggestion)

    def fault(self, location: Location, given: str, allowed: str, suggestion: str = "") -> InputError:
        """InputError that says where something stands, in words what is wrong with it, and what is allowed."""
        return InputError(self.line(location, given, allowed, suggestion))

    def refused(self, location: Location, allowed: str, suggestion: str = "") -> InputError:
        """InputError about the value that stands at a location."""
        return InputError(self.told(location, allowed, suggestion))

    def unknown(self, location: Location, names: Iterable[str]) -> InputError:
        """InputError about a value at a location that is none of some names."""
        given, names = self.value(location), list(names)
        return self.error(location, given, _listed(names), nearest(given, names))

    def told(self, location: Location, allowed: str, suggestion: str = "") -> str:
        """One line of an InputError about the value that stands at a location."""
        given = self.value(location)
        return self.line(location, brief(given), allowed, suggestion)

    def line(self, location: Location, given: str, allowed: str, suggestion: str = "", *, of_key: bool = False) -> str:
        """One line of an InputError about a value or a key; an absent one stands where what lacks it does."""
        location = self.elsewhere.get(location, location)
        position, owner = None if of_key else self.positions.get(location), location
        while position is None and owner:
            position, owner = self.key_positions.get(owner), owner[:-1]
        shown = location[1:] if self.flat and location[:1] == ("scene",) else location
        return _line(self.path, position or self.positions.get(()), shown, given, allowed, suggestion)


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
        raise InputError(_line(path, position, (), byte, f"text in UTF-8{_unlike_yaml(path)}")) from None
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
            given = f"text that is not YAML ({problem})"
            allowed = f"YAML 1.2, with a colon and a space after each key{_unlike_yaml(path)}"
        mark = error.problem_mark or error.context_mark
        raise InputError(_line(path, _position(mark) if mark else None, (), given, allowed)) from None
    if data is ABSENT:
        raise InputError(_line(path, (1, 1), (), "an empty file", "a mapping of keys to values"))
    if not isinstance(data, dict) and _unlike_yaml(path):
        raise InputError(_line(path, (1, 1), (), "text without keys", f"a mapping of keys{_unlike_yaml(path)}"))
    return Document(path, text, data, loader.positions, loader.key_positions)


def _unlike_yaml(path: Path) -> str:
    """What to do with a file that does not look like one of YAML."""
    if path.suffix.lower() in ("", ".yaml", ".yml", ".json"):
        return ""
    return f"; a table of heights is named by a YAML file, `roughness: {{method: measured, file: {path.name}}}`"


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
                allowed = "keys that are text, no merge keys"
                if isinstance(key, int | float):
                    allowed = f"keys that are text; {_POINT}"
                raise self.fault(key_node.start_mark, location, given, allowed)
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


class _PlainDumper(yaml.SafeDumper):
    """PyYAML's safe dumper with floats as people write them, 7.0e+10, and `...` for what is no plain value."""


def _shortest(dumper: yaml.SafeDumper, value: float) -> yaml.Node:
    mantissa, e, exponent = f"{value:g}".partition("e")
    short = mantissa + ".0" * ("." not in mantissa) + e + exponent
    if not isfinite(value) or float(short) != value:
        return dumper.represent_float(value)
    return dumper.represent_scalar("tag:yaml.org,2002:float", short)


_PlainDumper.add_representer(float, _shortest)
_PlainDumper.add_multi_representer(object, lambda dumper, _: dumper.represent_str("..."))


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


Record = TypeVar("Record", bound=BaseModel)


def validate(document: Document, model: type[Record]) -> Record:
    """Record of a document's data; raises InputError with one line per fault."""
    try:
        return model.model_validate(_plain(document.data))
    except ValidationError as error:
        schema = _schema(model)
        faults = error.errors(include_url=False)
        within = {fault["loc"][:-1] for fault in faults}  # a list of nothing but wrong items is not too short
        faults = [fault for fault in faults if not (fault["type"] == "too_short" and fault["loc"] in within)]
        said = (_fault(document, schema, fault) for fault in faults[:MOST_LINES])
        raise InputError(*said, more=len(faults[MOST_LINES:])) from None


def _plain(data: Any) -> Any:
    """Data with Python's numbers in place of NumPy's."""
    if isinstance(data, Mapping):
        return {key: _plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return type(data)(map(_plain, data)) if type(data) in (list, tuple) else data
    return data.item() if hasattr(data, "dtype") and getattr(data, "shape", None) == () else data


@contextmanager
def located(document: Document, place: Location = ()) -> Iterator[None]:
    """Raise InputError, as the document has it, for a broken rule of a record that stands at a place of it."""
    try:
        yield
    except PydanticCustomError as error:
        context = error.context or {}
        raise document.refused((*place, *context["location"]), context["allowed"]) from None


@cache
def _schema(model: type[BaseModel]) -> dict[str, Any]:
    """Return the JSON Schema of a record, which takes longer to make than all else that refuses a document."""
    return model.model_json_schema()


def _fault(document: Document, schema: dict[str, Any], fault: ErrorDetails) -> str:
    location, node = _at(schema, fault["loc"])
    match fault["type"]:
        case "rule":
            location += fault["ctx"]["location"]
            return document.told(location, fault["ctx"]["allowed"])
        case "unit":
            return document.told(location, fault["ctx"]["allowed"], fault["ctx"]["suggestion"])
        case "extra_forbidden" | "invalid_key":
            siblings = list(_at(schema, fault["loc"][:-1])[1]["properties"])
            if document.flat and len(location) == 2:
                siblings += [key for key in schema["properties"] if key != "scene"]
            comma = _POINT if str(location[-1])[:1].isdigit() else ""
            key = str(location[-1])  # of which an axis of a grid may have the name behind that of its record
            prefixed = [each for each in siblings if each.partition("_")[2] == key]
            belongs = "; ".join(filter(None, (_belongs(schema, location), nearest(key, prefixed))))
            hint = comma or belongs or nearest(location[-1], siblings)
            return document.line(location, "an unknown key", _listed(siblings), hint, of_key=True)
        case "union_tag_invalid" | "union_tag_not_found":
            given = document.value(location)
            location += (node["discriminator"]["propertyName"],)
            node = {"enum": list(node["discriminator"]["mapping"])}
            if isinstance(given, dict) and "file" in given and "measured" in node["enum"]:
                return document.told(location, _MEASURED)
    value = document.value(location)
    hint = nearest(value, node.get("enum", ())) or (_LOADS if isinstance(value, list) and "loading" in location else "")
    number = plain_scalar(value) if isinstance(value, str) else None
    if isinstance(number, int | float) and number in node.get("enum", (number,)):
        hint = f"did you mean {value} without quotes?"
    if isinstance(value, str) and not hint and node.get("type") in ("number", "integer") and has_unit(value):
        hint = "this number has no unit"
    if isinstance(value, str) and node.get("type") in ("number", "integer", ["number", "string"]):
        hint = respelt(value[:_LONGEST]) or hint
    return document.told(location, _allowed(schema, node), hint)


def _at(schema: dict[str, Any], loc: Iterable[str | int]) -> tuple[Location, dict[str, Any]]:
    """Location in the document, free of union tags, and JSON Schema node of an error's location."""
    location: Location = ()
    node = schema
    for part in loc:
        tagged = node.get("discriminator", {}).get("mapping", {})
        if part in tagged:
            node = _tagged(schema, tagged[part])
        elif (kind := _of_kind(node, part)) is not None:
            node = _resolved(schema, kind)
        else:
            location += (part,)
            inner = node.get("items", {}) if isinstance(part, int) else node.get("properties", {}).get(part, {})
            node = _resolved(schema, inner)
    return location, node


def _of_kind(node: dict[str, Any], part: str | int) -> dict[str, Any] | None:
    """Member of a union without a tag of its own in the document, by the name of its record or by its text."""
    members = ((kind, str(kind.get("$ref", "")).rpartition("/")[2]) for kind in node.get("oneOf", ()))
    return next((kind for kind, name in members if part in (name, kind.get("const"))), None)


def _resolved(schema: dict[str, Any], node: dict[str, Any]) -> dict[str, Any]:
    choices = node.get("anyOf") or node.get("allOf") or [node]
    node = next(choice for choice in choices if choice.get("type") != "null")
    if "$ref" in node:
        resolved: dict[str, Any] = schema["$defs"][node["$ref"].rpartition("/")[2]]
        return resolved
    return node


def _tagged(schema: dict[str, Any], reference: str | dict[str, Any]) -> dict[str, Any]:
    """Node that a tag of a union stands for: a record, or a union of records with another tag."""
    return _resolved(schema, {"$ref": reference} if isinstance(reference, str) else reference)


def allowed_at(model: type[BaseModel], location: Iterable[str | int]) -> str:
    """Plain words for what a record admits at the location of an error of its validation."""
    schema = _schema(model)
    return _allowed(schema, _at(schema, location)[1])


def _allowed(schema: dict[str, Any], node: dict[str, Any]) -> str:
    """Plain words for what a JSON Schema node admits."""
    if "allowed" in node:
        return str(node["allowed"])
    if "enum" in node or "const" in node:
        return _listed(node.get("enum", [node.get("const")]))
    if "discriminator" in node:
        union = node["discriminator"]
        return f"a mapping with {union['propertyName']} {_listed(union['mapping'])}"
    if "quantity" in node:
        return f"a number{_range(node)}, or {node['in_units']}"
    match node.get("type"):
        case "array":
            item = _allowed(schema, _resolved(schema, node["items"])).removeprefix("a ")
            plural = re.sub("number|mapping|file name", r"\g<0>s", item, count=1)
            many = node.get("minItems") if node.get("minItems") == node.get("maxItems") else None
            return f"a list of {many or 'one or more'} {plural}" if plural != item else f"a list, each item {item}"
        case "object":
            return "a mapping of " + ", ".join(map(repr, node["properties"])) if node["properties"] else "{}"
        case "integer":
            return "a whole number" + _range(node)
        case "number":
            return ("a number" if "maximum" in node else "a finite number") + _range(node)
        case "boolean":
            return "true or false"
    return "text"


def _range(node: dict[str, Any]) -> str:
    if "minimum" in node and "maximum" in node:
        return f" from {node['minimum']} to {node['maximum']}"
    words = {"exclusiveMinimum": "above", "minimum": "at least", "maximum": "at most", "exclusiveMaximum": "below"}
    bounds = [f"{word} {node[bound]}" for bound, word in words.items() if bound in node]
    return " " + " and ".join(bounds) if bounds else ""


def _listed(names: Iterable[str]) -> str:
    quoted = [repr(name) for name in names]
    return quoted[0] if len(quoted) == 1 else "one of " + ", ".join(quoted)


def nearest(given: object, names: Iterable[object]) -> str:
    """Question whether the most similar name was meant, or the first of which it is a part; or nothing."""
    words = [name for name in names if isinstance(name, str)]
    if given is False and "none" in words:
        return "did you mean 'none'?"
    if not isinstance(given, str) or len(given) >= 200:
        return ""
    known = _ELSEWHERE.get(given.lower())
    matches = [known] if known in words else get_close_matches(given, words, 1)
    matches = matches or [word for word in words if given in word.split("_")]
    return f"did you mean {matches[0]!r}?" if matches else ""


def _belongs(schema: dict[str, Any], location: Location) -> str:
    key, here = str(location[-1]), ".".join(map(str, location[:-1]))
    homes = [home for home, name in _keys(schema, schema, "") if name == key]
    homes = [home for home in homes if home.startswith(f"{here} with ")] or homes  # another kind of the same mapping
    homes = list(dict.fromkeys(home.partition(" with model ")[0] for home in homes))
    named = [home or "the top level" for home in homes[:_MOST_HOMES]] + ["others"] * (len(homes) > _MOST_HOMES)
    return f"'{key}' belongs to {' or '.join(named)}" if homes else ""


def _keys(schema: dict[str, Any], node: dict[str, Any], home: str) -> Iterator[tuple[str, str]]:
    """Every key the model knows, with the dotted name of the mapping that holds it."""
    for tag, reference in node.get("discriminator", {}).get("mapping", {}).items():
        inside = f"{home} with {node['discriminator']['propertyName']} {tag}"
        yield from _keys(schema, _tagged(schema, reference), inside)
    for name, inner in node.get("properties", {}).items():
        yield home, name
        yield from _keys(schema, _resolved(schema, inner), f"{home}.{name}".removeprefix("."))


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
    given = Document(None, "", {name: source})
    raise given.refused((name,), "the path of a YAML file, or a mapping of its content")


def existing_file(document: Document, location: Location, name: str, suffixes: tuple[str, ...]) -> str:
    """Absolute path of an existing file of a known kind (any, if none is named), relative to the document's folder."""
    folder = document.folder
    file = folder / name
    if suffixes and file.suffix not in suffixes:
        raise document.error(location, name, "a file ending in " + ", ".join(suffixes))
    if not os.path.isfile(file):
        kind = "the folder " if os.path.isdir(file) else "no regular file " if os.path.exists(file) else ""
        files = _files(folder, suffixes)
        hint = nearest(name, [each for each in files if Path(name).stem.lower() in each.lower()] or files)
        raise document.error(location, name, f"an existing file, unlike {kind}{file}", hint)
    return os.path.abspath(file)  # a link keeps its name, which tells the kind


def _files(folder: Path, suffixes: tuple[str, ...]) -> list[str]:
    """Names of the files of a kind in a folder, none if it may not be looked into."""
    try:
        return [each.name for each in folder.iterdir() if (not suffixes or each.suffix in suffixes) and each.is_file()]
    except OSError:
        return []
