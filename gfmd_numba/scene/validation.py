"""Checks of a document against a record, every fault told in the words of the document."""

import re
from collections.abc import Iterable, Iterator
from difflib import get_close_matches
from functools import cache
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from gfmd_numba.scene.document import Document, Location, plain_scalar
from gfmd_numba.scene.units import has_unit, respelt
from gfmd_numba.text.input_error import MOST_LINES, InputError, brief

Record = TypeVar("Record", bound=BaseModel)

_LONGEST = 100  # of a text that may be a number, and
_MOST_HOMES = 6  # of a key, that a message names


def validate(document: Document, model: type[Record]) -> Record:
    """Record of a document's data; raises InputError with one line per fault."""
    try:
        return model.model_validate(document.data)
    except ValidationError as error:
        schema = _schema(model)
        faults = error.errors(include_url=False)
        said = (_fault(document, schema, fault) for fault in faults[:MOST_LINES])
        raise InputError(*said, more=len(faults[MOST_LINES:])) from None


@cache
def _schema(model: type[BaseModel]) -> dict[str, Any]:
    """Return the JSON Schema of a record, which takes longer to make than all else that refuses a document."""
    return model.model_json_schema()


def _fault(document: Document, schema: dict[str, Any], fault: ErrorDetails) -> str:
    location, node = _at(schema, fault["loc"])
    match fault["type"]:
        case "rule":
            location += fault["ctx"]["location"]
            return document.line(location, brief(document.value(location)), fault["ctx"]["allowed"])
        case "unit":
            context = fault["ctx"]
            return document.line(location, brief(document.value(location)), context["allowed"], context["suggestion"])
        case "extra_forbidden" | "invalid_key":
            siblings = list(_at(schema, fault["loc"][:-1])[1]["properties"])
            if document.flat and len(location) == 2:
                siblings += [key for key in schema["properties"] if key != "scene"]
            hint = _belongs(schema, location) or nearest(location[-1], siblings)
            return document.key_line(location, "an unknown key", _listed(siblings), hint)
        case "union_tag_invalid" | "union_tag_not_found":
            location += (node["discriminator"]["propertyName"],)
            node = {"enum": list(node["discriminator"]["mapping"])}
    value = document.value(location)
    hint = nearest(value, node.get("enum", ()))
    number = plain_scalar(value) if isinstance(value, str) else None
    if isinstance(number, int | float) and number in node.get("enum", (number,)):
        hint = f"did you mean {value} without quotes?"
    if isinstance(value, str) and not hint and node.get("type") in ("number", "integer") and has_unit(value):
        hint = "this number has no unit"
    if isinstance(value, str) and node.get("type") in ("number", "integer", ["number", "string"]):
        hint = respelt(value[:_LONGEST]) or hint
    return document.line(location, brief(value), _allowed(schema, node), hint)


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
    return next((kind for kind in node.get("oneOf", ()) if part in (_name(kind), kind.get("const"))), None)


def _name(node: dict[str, Any]) -> str:
    return str(node.get("$ref", "")).rpartition("/")[2]


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
            return f"a list of one or more {plural}" if plural != item else f"a list, each item {item}"
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


def nearest(given: object, names: Iterable[object]) -> str:
    """Question whether the most similar name was meant, or nothing."""
    words = [name for name in names if isinstance(name, str)]
    matches = get_close_matches(given, words, 1) if isinstance(given, str) and len(given) < 200 else []
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
