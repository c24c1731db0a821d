"""A campaign file with other values of some keys, and everything else as its author wrote it."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import yaml

_COMMENT = r"#[^\r\n\x85\u2028\u2029]*"


def with_values(text: str, values: Mapping[str, str]) -> str:
    """Text of a YAML mapping in which some keys have other values (YAML on one line); new keys come last.

    A key with dots leads into mappings. Comments and line ends stay; those within an old value stand before the new
    one.
    """
    for key, value in values.items():
        text = _with_value(text, key.split("."), value)
    return text


def _node(text: str, place: Sequence[str | int]) -> Any:
    node: Any = yaml.compose(text, yaml.SafeLoader)
    for key in place:
        node = next(value_node for key_node, value_node in node.value if key_node.value == key)
    return node


def _with_value(text: str, place: Sequence[str], value: str) -> str:
    *outer, key = place
    root = _node(text, outer)
    indent = ("\r\n" if "\r\n" in text else "\n") + " " * root.start_mark.column
    for key_node, node in root.value:
        if key_node.value == key:
            start, stop = node.start_mark.index, _stop(text, node)
            glued = text[start - 1] == ":" or node.start_mark.column <= root.start_mark.column
            comments = "".join(f"{comment}{indent}  " for comment in _comments(text, node))
            return f"{text[:start]}{' ' if glued else ''}{comments}{value}{text[stop:]}"
    stop = _stop(text, root.value[-1][1])
    if root.flow_style:
        return f"{text[:stop]}, {key}: {value}{text[stop:]}"
    comment = re.match(rf"[ \t]*({_COMMENT})?", text[stop:])
    stop += comment.end() if comment else 0
    return f"{text[:stop]}{indent}{key}: {value}{text[stop:]}"


def _stop(text: str, node: Any) -> int:
    """Index behind the last character of a node; PyYAML's own lies behind the comments that follow a block."""
    if isinstance(node, yaml.CollectionNode) and not node.flow_style:
        return max(_stop(text, child) for child in _children(node))
    start: int = node.start_mark.index
    return start + len(text[start : node.end_mark.index].rstrip())


def _comments(text: str, node: Any) -> list[str]:
    """Comments within a node: those between its scalars."""
    found, behind, stop = [], node.start_mark.index, _stop(text, node)
    for scalar in _scalars(node):
        found += re.findall(_COMMENT, text[behind : scalar.start_mark.index])
        behind = _stop(text, scalar)
    return found + re.findall(_COMMENT, text[behind:stop])


def _scalars(node: Any) -> Iterator[Any]:
    if isinstance(node, yaml.ScalarNode):
        yield node
    else:
        for child in _children(node):
            yield from _scalars(child)


def _children(node: Any) -> list[Any]:
    return [child for pair in node.value for child in pair] if isinstance(node, yaml.MappingNode) else node.value
