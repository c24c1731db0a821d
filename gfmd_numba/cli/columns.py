"""Tables on the terminal, within 80 columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from textwrap import wrap

import click

from gfmd_numba.cli.sentences import COLUMNS, say
from gfmd_numba.text.printable import printable

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
    """Lines of a heading and cells, all of one width and aligned to the right."""
    lines = [*wrap(heading, _WIDEST_HEADING, break_long_words=False), *cells]
    width = max(map(len, lines))
    return [f"{line:>{width}}" for line in lines]


def _blocks(keys: list[Column], columns: list[Column]) -> Iterator[list[Column]]:
    """Columns that fit side by side, each time after the keys."""
    block = list(keys)
    for column in columns:
        if len(block) > len(keys) and _length([*block, column]) > COLUMNS:
            yield block
            block = list(keys)
        block.append(column)
    yield block


def _length(block: list[Column]) -> int:
    return sum(len(column[0]) for column in block) + len(_GAP) * (len(block) - 1)
