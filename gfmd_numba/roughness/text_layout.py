"""How numbers stand in a text file: what separates its columns, and what its decimals."""

import re
from dataclasses import dataclass
from itertools import chain, islice
from typing import Literal

import numpy as np

BLANKS = r"\s+"
_LOOKED_AT = 200  # rows that decide the layout
_NUMBER = re.compile(r'"?\s*[-+]?(\d+[.,]?\d*|[.,]\d+)([eEdD][-+]?\d+)?\s*"?')
_WORD = re.compile(r"|\+?-?(nan|inf|infinity|na|n/a|#n/a|null|bad|-{1,3}|\*)", re.IGNORECASE)
_NAME = re.compile(r"\w+\s*([\[(/]\s*\S+\s*[\])]?)?")  # of one column
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?")
_QUOTED = re.compile(r'"[-+]?[1-9]\d{0,2}(?:(?:,\d{3})+\.\d*|(?:,\d{3}){2,})"')
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+([eE][-+]?\d+)?")


@dataclass(frozen=True)
class Layout:
    """Separator of columns (",", ";", tab, `BLANKS`, or "" of one column) and of decimals."""

    separator: str
    decimal: Literal[".", ","]

    def cells(self, line: str) -> list[str]:
        """Cells of a row."""
        if not self.separator:
            return [line]
        return line.split() if self.separator == BLANKS else line.split(self.separator)

    def columns(self, line: str) -> int:
        """Number of cells of a row."""
        return len(self.cells(line))


def is_row(line: str) -> bool:
    """Whether all that stands in a line are numbers or signs for missing ones, and one is a number or a word like nan.

    A line of dashes may be part of a header.
    """
    cells = [cell for cell in re.split(r"[;\t]|,?\s+|,(?=[^\d])|,$", line.partition("#")[0].strip()) if cell]
    found = False
    for cell in cells:
        parts = [cell] if _NUMBER.fullmatch(cell) else cell.split(",")
        for part in parts:
            number = _NUMBER.fullmatch(part) is not None
            if not number and not _WORD.fullmatch(part.strip('" ')):
                return False
            found = found or number or any(map(str.isalpha, part))
    return found


def layout_of(rows: list[str], header: str) -> Layout:
    """Layout of rows of numbers under the last line of a header; raises ValueError where two would do.

    One comma in each row, with digits alone on both sides, may be a decimal one or separate two columns: the header
    tells, or whole equidistant numbers before it, which are positions, or a number before it that follows itself.
    """
    looked_at = [row.partition("#")[0].strip() for row in islice((row for row in rows if row.strip()), _LOOKED_AT)]
    _check_thousands(looked_at, header)
    for separator in (";", "\t"):
        if any(separator in row for row in looked_at):
            return Layout(separator, "," if any("," in row for row in looked_at) else ".")
    if not any("," in row for row in looked_at):
        return Layout(BLANKS if any(len(row.split()) > 1 for row in looked_at) else "", ".")
    tokens = [token for row in looked_at for token in row.split()]
    decimal = all(_DECIMAL_COMMA.fullmatch(token) for token in tokens if "," in token)
    if not decimal or any("." in token for token in tokens) or max(row.count(",") for row in looked_at) > 1:
        if decimal and not any("." in token for token in tokens) and len(tokens) > len(looked_at):
            return Layout(BLANKS, ",")
        return Layout(",", ".")
    if len(tokens) > len(looked_at):
        return Layout(BLANKS, ",")
    return _one_comma(looked_at, header)


def _check_thousands(rows: list[str], header: str) -> None:
    """Raise ValueError for commas between thousands, where they can be neither decimal ones nor between columns."""
    tokens = [re.findall(r"[^;\s]+", row) for row in rows]
    grouped = [token for token in chain(*tokens) if "," in token]
    surely = [token for token in grouped if "." in token or token.count(",") > 1]
    found = [token for row in rows for token in _QUOTED.findall(row)]
    if not found and surely and all(map(_THOUSANDS.fullmatch, grouped)) and not _are_columns(tokens, header):
        found = surely
    if found:
        written = found[0].strip('"')
        raise ValueError(f"numbers like {written} with commas between thousands: write {written.replace(',', '')}")


def _are_columns(tokens: list[list[str]], header: str) -> bool:
    """Whether commas may separate columns: as many in each row, and if it is one, behind positions or a header."""
    commas = {row[0].count(",") for row in tokens if len(row) == 1}
    if any(len(row) > 1 for row in tokens) or len(commas) > 1:
        return False
    steps = np.diff([float(row[0].partition(",")[0]) for row in tokens])
    in_order = bool((steps > 0).all() or (steps < 0).all())
    two_names = len(re.split("[,;\t]", header)) == 2
    return max(commas) > 1 or two_names or (in_order and not _NAME.fullmatch(header))


def _one_comma(rows: list[str], header: str) -> Layout:
    if _NAME.fullmatch(header):
        return Layout("", ",")
    if len(re.split("[,;\t]", header)) == 2:
        return Layout(",", ".")
    before = np.array([float(row.partition(",")[0]) for row in rows])
    steps = np.diff(before)
    if steps.size and steps[0] != 0 and (steps == steps[0]).all():
        return Layout(",", ".")
    if (steps == 0).any() or any(row.startswith("-0") for row in rows):  # no position comes twice, none is -0
        return Layout("", ",")
    raise ValueError(
        f"rows like {rows[0]!r} that are one column with a decimal comma or two columns: begin the file with the line "
        "`z [um]` or `x [mm], z [um]`, in its units"
    )
