"""Numbers in text: one or two columns or a map, however they are separated, and the units their header states."""

import io
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness.header_units import axis_units, heights_first, stated_units
from gfmd_numba.roughness.text_layout import Layout, is_row, layout_of
from gfmd_numba.scene.regular_file import most_numbers, read_regular

_COMMENTS = "#%"
_FORTRAN = re.compile(r"(?<=[\d.,])[dD](?=[-+]?\d)")  # the letter of an exponent
_MISSING = ["-", "--", "---", "*", "Bad", "BAD", "bad"]  # in addition to what pandas knows
_LONGEST = 2**22  # characters of a line, and
_WIDEST = 2**16  # columns of a map that are read: a table of more columns than rows takes memory without end


@dataclass(frozen=True)
class Table:
    """Rows and columns of numbers `[rows, columns]`, not-a-number where a cell is empty.

    `units` are those that the header states for each column, or the one of a map; None where it states none. It may
    name units of positions along a map, `axis_units`. `line` is that of the first row, counted from 1.
    """

    values: Reals
    units: tuple[str | None, ...]
    done: tuple[str, ...] = ()
    axis_units: Mapping[str, str] = field(default_factory=dict)
    line: int = 1


def read_table(path: Path) -> Table:
    """Numbers of a text file; raises ValueError, with the line, for anything else.

    Columns are separated by commas, semicolons, tabs or blanks, decimals by points or commas; lines that begin with
    `#` or `%` are comments, and those before the first row of numbers the header. Empty cells, and words such as nan,
    are not-a-number.
    """
    lines = _text(path).split("\n")
    long = next((i for i, line in enumerate(lines) if len(line) > _LONGEST), None)
    if long is not None:
        raise ValueError(f"a line {long + 1} of {len(lines[long])} characters, more than {_LONGEST}")
    first = next((i for i, line in enumerate(lines) if not _is_comment(line) and is_row(line)), None)
    if first is None:
        begin = next((line for line in lines if line.strip()), "")
        raise ValueError(f"no row of numbers, but {_short(begin)}" if begin else "no number")
    header = [line.lstrip(_COMMENTS + "/ ").strip() for line in lines[:first]]
    rows = [_FORTRAN.sub("e", line) for line in lines[first:] if not _is_comment(line)]
    while not rows[-1].strip():
        rows.pop()
    layout = layout_of(rows, header[-1] if header else "")
    columns = layout.columns(rows[0])
    if columns > _WIDEST:
        raise ValueError(f"{columns} columns, more than {_WIDEST}")
    values = _parsed(rows, layout)
    if values is None:
        raise _bad_row(lines, first, layout, columns)
    while values.shape[1] > 1 and (values[:, -1] != values[:, -1]).all():  # a separator at the end of each row
        values = values[:, :-1]
    done: tuple[str, ...] = ("read commas as decimal commas",) if layout.decimal == "," else ()
    units = stated_units(header, values.shape[1])
    if values.shape[1] == 2 and heights_first(header):
        values, units = values[:, ::-1], units[::-1]
        done += ("took the first of two columns for heights and the second for positions, as their labels say",)
    return Table(values, units, done, axis_units(header), first + 1)


def _text(path: Path) -> str:
    content = read_regular(path, most_numbers())
    wide = content[:2] in (b"\xff\xfe", b"\xfe\xff")  # byte order marks
    if b"\0" in content and not wide:
        raise ValueError(f"a zero byte at byte {content.index(0)}: no text")
    try:
        text = content.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")  # of instruments that write µ in one byte
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(tuple(_COMMENTS))


def _parsed(rows: list[str], layout: Layout) -> Reals | None:
    """Values `[rows, columns]`, None if a cell is no number or a row has too many."""
    import pandas as pd

    try:
        with warnings.catch_warnings(action="ignore"):
            table = pd.read_csv(
                io.StringIO("\n".join(rows)),
                sep=layout.separator or "\x1f",  # which text does not contain: one column
                decimal=layout.decimal,
                header=None,
                dtype="float64",
                comment="#",
                na_values=_MISSING,
                skipinitialspace=True,
                skip_blank_lines=False,  # an empty line of one column is an empty cell
                engine="c",
                float_precision="round_trip",  # the default of older versions is off by the last digit
            )
    except (ValueError, pd.errors.ParserError, OverflowError):
        return None
    return np.asarray(table, dtype=np.float64)


def _bad_row(lines: list[str], first: int, layout: Layout, columns: int) -> ValueError:
    """What is wrong with the first row that cannot be read."""
    for i, line in enumerate(lines[first:], first + 1):
        if _is_comment(line) or not line.strip():
            continue
        if layout.columns(line) > columns:
            return ValueError(f"{layout.columns(line)} columns in line {i}, where line {first + 1} has {columns}")
        for cell in layout.cells(line.partition("#")[0]):
            if _parsed([cell], Layout("", layout.decimal)) is None:
                return ValueError(f"{_short(cell)} in line {i}, not a number")
    return ValueError("rows of numbers that do not make a table")


def _short(cell: str) -> str:
    cell = re.sub(r"\s+", " ", cell.strip())
    return repr(cell if len(cell) <= 30 else cell[:27] + "...")
