"""Pages of the reference that are printed from the code: keys of the files, commands, variables of the results."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

_FILES = {
    "campaign": ("Campaign files", "For `gfmd run`, `plan`, `check` and `accuracy`, and for `gfmd_numba.run`."),
    "scene": ("Scene files", "For `gfmd solve`, `curve` and `check`, and for `gfmd_numba.solve` and `load_curve`."),
    "boundary": ("Files of a loaded body", "For a body that is loaded without a punch: `gfmd solve` and `check`."),
    "surface": ("Surface files", "For `gfmd surface` and `check`, and for `gfmd_numba.make_surface`."),
    "cluster": ("Cluster files", "For `gfmd run --cluster` and `check`, and for the `workers` of `gfmd_numba.run`."),
}
_KEYS = """\
# Keys of the YAML files

This page is for those who write a file: it lists every key, with its unit, the values that are allowed, and the value
that it has if you leave it out. Wherever the table names a unit, you may also write a number with a unit of your own,
like `50 MPa`. Plain numbers are in the unit of the table. In a scene without a `length`, lengths are in L_x. In a scene
without moduli, stresses are in E\\*. [Units and loads](../campaigns.md#units-and-loads) explains this.

`gfmd schema KIND` prints the same as JSON Schema, which many editors use to complete and check YAML.
"""


def keys_page(schemas: dict[str, dict[str, Any]]) -> str:
    """Return the page of all keys, from the JSON Schemas of all kinds of files."""
    records = {name: record for schema in schemas.values() for name, record in schema.get("$defs", {}).items()}
    for schema in schemas.values():  # a record that is also a number has no name in the schema
        records |= {key.title(): value for key, value in schema["properties"].items() if "properties" in value}
    parts = [_KEYS]
    for kind, schema in schemas.items():
        title, sentence = _FILES[kind]
        parts += [f"## {title}\n", f"{sentence}\n", _table(schema)]
    parts.append("## Records inside the files\n")
    for name, record in sorted(records.items()):
        parts += [f"(key-{name.lower()})=\n### {name}\n", _text(record.get("description", "")) + "\n", _table(record)]
    return "\n".join(parts)


def _table(record: dict[str, Any]) -> str:
    required = set(record.get("required", ()))
    rows = ["| Key | Unit | Allowed | Default | Meaning |", "|---|---|---|---|---|"]
    for key, value in record.get("properties", {}).items():
        default = "required" if key in required else _default(value)
        cells = (f"`{key}`", unit(value), allowed(value), default, _text(value.get("description", "")))
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows) + "\n" if len(rows) > 2 else "No keys: write `{}`.\n"


def _choices(value: dict[str, Any]) -> list[dict[str, Any]]:
    """What a value may be, without null."""
    choices = value.get("anyOf") or value.get("oneOf") or [value]
    return [choice for choice in choices if choice.get("type") != "null"]


def unit(value: dict[str, Any]) -> str:
    """Return the unit of a value, 1 for a number without dimension, and a dash for what is no number."""
    if "unit" in value:
        return str(value["unit"])
    if "items" in value:
        return unit(value["items"])
    if value.get("type") in ("number", "integer") or "minimum" in value:
        return "1"
    choices = _choices(value)
    if choices != [value]:
        return next((found for found in map(unit, choices) if found != "-"), "-")
    return "1" if "number" in value.get("allowed", "") else "-"


def allowed(value: dict[str, Any]) -> str:
    """Return the values that are allowed, in words, with links to records."""
    return " or ".join(dict.fromkeys(map(_allowed, _choices(value))))


def _allowed(value: dict[str, Any]) -> str:
    if "$ref" in value:
        name = value["$ref"].rpartition("/")[2]
        return f"[{name}](#key-{name.lower()})"
    if "allowed" in value:
        return _text(value["allowed"]) + (" (see below)" if "properties" in value else "")
    if "const" in value or "enum" in value:
        return ", ".join(f"`{choice}`" for choice in value.get("enum", [value.get("const")]))
    if "anyOf" in value or "oneOf" in value:
        return allowed(value)
    kind = value.get("type")
    if kind == "array":
        return f"a list, each entry {allowed(value['items'])}" if "items" in value else "a list"
    if kind == "object":
        return "a mapping"
    if kind == "boolean":
        return "`true`, `false`"
    if kind == "string" or (isinstance(kind, list) and not _bounds(value)):
        return "text"
    number = "a whole number" if kind == "integer" else "a number"
    return " ".join((number, *_bounds(value)))


def _bounds(value: dict[str, Any]) -> Iterator[str]:
    words = {"exclusiveMinimum": "above", "minimum": "from", "exclusiveMaximum": "below", "maximum": "up to"}
    return (f"{word} {value[bound]:g}" for bound, word in words.items() if bound in value)


def _default(value: dict[str, Any]) -> str:
    default = value.get("default")
    if default is None:
        return "-"
    if isinstance(default, dict):
        return "see there"
    return f"`{str(default).lower() if isinstance(default, bool) else default}`".replace("`inf`", "`.inf`")


def _text(text: str) -> str:
    text = text.replace("None:", "left out:").replace("\n", " ")
    return text.replace("|", "\\|").replace("*", "\\*").replace("<", "&lt;")


_NARROW = {"terminal_width": 64, "max_content_width": 64}  # columns that a phone shows, too


def commands_page(group: click.Group) -> str:
    """Return the page of all commands, as `gfmd COMMAND --help` prints them."""
    parts = [
        "# Commands\n",
        "This page is for those who type commands. Exit codes: 0 all is well, 2 bad input, 3 some cases failed, "
        "130 interrupted.\n",
    ]
    for name, command in sorted(group.commands.items()):
        with click.Context(command, info_name=f"gfmd {name}", **group.context_settings | _NARROW) as context:
            parts.append(f"## gfmd {name}\n\n```text\n{command.get_help(context)}\n```\n")
    return "\n".join(parts)


def files_page() -> str:
    """Return the page of what results hold, from the tables of observables and axes."""
    from gfmd_numba.campaign.axes import AXES
    from gfmd_numba.contact.observables import OBSERVABLES, PATH_OBSERVABLES

    symbols = {"gradient": "1", "length": "m", "height": "m", "pressure": "Pa", "energy": "J m-2"}

    def described(table: dict[str, Any]) -> str:
        units = {name: symbols.get(row.unit, row.unit) for name, row in table.items()}
        return "\n".join(f"| `{name}` | {units[name]} | {_text(row.long_name)} |" for name, row in table.items())

    rows, of_paths = described(OBSERVABLES), described(PATH_OBSERVABLES)
    axes = "\n".join(f"| `{axis.name}` | {_text(axis.symbol)} | {_text(axis.long_name)} |" for axis in AXES)
    return f"""\
# Variables of the results

This page is for those who read results. Every file is netCDF-4 and follows the CF conventions. Read it with
`xarray.open_dataset`. Every variable has `units` and a `long_name`. The attributes hold the text of your file, the
versions of the packages, and the machine.

## Numbers of each contact

Campaigns hold these over `case` and `realisation`, load curves over `prescribed_load`, and paths over `step` too.
In a single contact they have no dimension. The units are those of a scene with a `length` and moduli. In a
scene without moduli, stress is in E\\*; in a scene without a `length`, lengths are in L_x. The files then say
so.

| Variable | Unit | Meaning |
|---|---|---|
{rows}

## Numbers of a loading path

Contacts and campaigns with a `path` hold these, if the scene has the effect: the first three over `step`, the others
once for each realisation.

| Variable | Unit | Meaning |
|---|---|---|
{of_paths}

## Coordinates of a campaign

A campaign has a coordinate for each parameter that its `grid` may vary, if its scene has this parameter.

| Key | Symbol | Meaning |
|---|---|---|
{axes}
"""


_GALLERY = """\
# Gallery

This page is for those who look for an example: each runs in a few seconds, and draws its picture. The tests run them
all.

````{container} thumbnails
"""


def gallery_page(folder: Path) -> str:
    """Return the page of the gallery: small pictures that lead to the examples, each with its sentences and code."""
    small, examples = [], []
    for path in sorted(folder.glob("*.py")):
        first, _, sentences = (ast.get_docstring(ast.parse(path.read_text())) or "").partition("\n")
        title, _, more = first.rstrip(".").partition(": ")
        sentences = f"{more[:1].upper()}{more[1:]}.\n{sentences}" if more else sentences
        code = path.read_text().split('"""', 2)[2].strip()
        small.append(f"[![{title}]({path.stem}.png) {title}](#example-{path.stem})\n")
        examples.append(f"(example-{path.stem})=\n## {title}\n\n{sentences.strip()}\n")
        examples.append(f"![{title}]({path.stem}.png)\n\n```python\n{code}\n```\n")
    return "\n".join([_GALLERY, *small, "````\n", *examples])


PYTHON_PAGE = """\
# Python

This page is for those who call gfmd-numba from Python.

```{eval-rst}
.. automodule:: gfmd_numba
   :members:
   :imported-members: InputError
```

## Analysis

```{eval-rst}
.. automodule:: gfmd_numba.analysis
   :members:
   :imported-members:
```

## Theory

"""


def python_page(theory: list[str]) -> str:
    """Return the page of the Python functions, whose signatures and docstrings Sphinx fills in."""
    modules = (
        f"### {name}\n\n```{{eval-rst}}\n.. automodule:: gfmd_numba.theory.{name}\n   :members:\n```\n"
        for name in theory
    )
    return PYTHON_PAGE + "\n".join(modules)
