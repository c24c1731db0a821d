"""Text and tables on the terminal, within 80 columns."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from textwrap import wrap
from typing import TYPE_CHECKING

import click

from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    import xarray as xr

COLUMNS = 80
_SPACE = "\0"  # within a command, where no line may end: printable text has none


def say(label: str, text: str, *, width: int = 9, err: bool = False) -> None:
    """Print a text next to its label, made harmless. Only paths and commands, which are not folded, may be longer."""
    whole = re.sub(r"`[^`]*`", lambda command: command[0].replace(" ", _SPACE), printable(text))
    folded = wrap(whole, COLUMNS - width, break_long_words=False, break_on_hyphens=False)
    lines = [line.replace(_SPACE, " ") for line in folded] or [""]
    click.echo(f"{label:<{width}}{lines[0]}".rstrip(), err=err)
    for line in lines[1:]:
        click.echo(f"{'':{width}}{line}", err=err)


def warn(text: str) -> None:
    """Print a sentence of gfmd to standard error."""
    say("gfmd:", text, width=6, err=True)


def warn_of_doubts(dataset: xr.Dataset) -> None:
    """Print the reasons to doubt a result, as its attribute `validity` gives them."""
    for doubt in dataset.attrs.get("validity", "").splitlines():
        warn(doubt)


def say_command(command: str, *, width: int) -> None:
    """Print a command of the shell, folded so that it can be copied."""
    words = re.findall(r"""(?:\$'(?:\\.|[^'\\])*'|'[^']*'|"[^"]*"|\S)+""", printable(command))
    whole = " ".join(each.replace(" ", _SPACE) for each in words)
    lines = wrap(whole, COLUMNS - width - 2, break_long_words=False, break_on_hyphens=False)
    click.echo(" \\\n".join(" " * width + line.replace(_SPACE, " ") for line in lines))


_GAP = "  "
_WIDEST_HEADING = 10

Column = list[str]


def print_table(title: str, parameters: Mapping[str, list[str]], values: Mapping[str, list[str]]) -> None:
    """Print parameters and values of cases, cells by heading, no line longer than 80 columns.

    Parameters that all cases share stand above the table once. Values for which there is no room go below the others,
    next to the parameters again; where those fill the line themselves, next to the number of the case.
    """
    shared = {heading: cells[0] for heading, cells in parameters.items() if len(set(cells)) == 1}
    keys = [_column(heading, cells) for heading, cells in parameters.items() if heading not in shared]
    columns = [_column(heading, cells) for heading, cells in values.items()]
    if max(_length([*keys, column]) for column in columns) > COLUMNS:
        numbers = [str(i + 1) for i in range(len(next(iter(values.values()))))]
        keys, columns = [_column("case", numbers)], keys + columns
    say("", title, width=0)
    if told := ", ".join(f"{heading} = {cell}" for heading, cell in shared.items() if cell != "-"):
        say("", told, width=0)
    for block in _blocks(keys, columns):
        height = max(map(len, block))
        click.echo()
        for line in zip(*([" " * len(column[0])] * (height - len(column)) + column for column in block), strict=True):
            click.echo(printable(_GAP.join(line).rstrip()))
    click.echo()


def _column(heading: str, cells: list[str]) -> Column:
    """Return the lines of a heading and cells, all of one width and aligned to the right."""
    lines = [*wrap(heading, _WIDEST_HEADING, break_long_words=False), *cells]
    width = max(map(len, lines))
    return [f"{line:>{width}}" for line in lines]


def _blocks(keys: list[Column], columns: list[Column]) -> Iterator[list[Column]]:
    """Yield blocks of columns that fit side by side, each after the keys."""
    block = list(keys)
    for column in columns:
        if len(block) > len(keys) and _length([*block, column]) > COLUMNS:
            yield block
            block = list(keys)
        block.append(column)
    yield block


def _length(block: list[Column]) -> int:
    return sum(len(column[0]) for column in block) + len(_GAP) * (len(block) - 1)
