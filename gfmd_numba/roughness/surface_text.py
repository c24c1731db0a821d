"""Numbers in text: one or two columns or a map, however they are separated, and the units their header states."""

import csv
import io
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import chain, islice
from pathlib import Path
from typing import Literal, NamedTuple
from unicodedata import normalize

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.scene.regular_file import most_numbers, read_regular
from gfmd_numba.scene.units import COUNTS, PERIOD, length_unit

BLANKS = r"\s+"
BYTE_ORDER_MARKS = (b"\xff\xfe", b"\xfe\xff")  # of text of two bytes a letter
_LOOKED_AT = 200  # rows that decide the layout, and characters of a line of a header
_NUMBER = re.compile(r'"?\s*[-+]?(\d+[.,]?\d*|[.,]\d+)([eEdD][-+]?\d+)?\s*"?')
# that stand for missing numbers, in any case; those with # are errors of spreadsheets
_WORDS = "nan +nan -nan na n/a n.a. null none bad <na> 1.#qnan -1.#qnan 1.#ind -1.#ind nan(ind) -nan(ind) nan(snan)"
_WORDS += " over masked"
_NO_DATA = re.compile(r"(?<![^\s,;\"])no[ _]?data(?=\s*(?:[,;\t\"]|$))", re.IGNORECASE | re.MULTILINE)
_ERRORS = "#n/a #na #nv #div/0! #value! #wert! #valeur! #ref! #bezug! #num! #zahl! #nombre! #name? #null!"
_MISSING = {"", *_WORDS.split(), *_ERRORS.split(), *(mark * n for mark in "-*" for n in range(1, 33))}
_NA_VALUES = sorted({spelt for word in _MISSING for spelt in (word, word.upper(), word.title())})
_INFINITE = re.compile(r"[-+]?inf(inity)?", re.IGNORECASE)
_COMMENTS = "#%"
_NO_COMMENT = "|".join(re.escape(each) for each in _ERRORS.split())
_COMMENT = re.compile(rf"(?:^|\s)(?!(?:{_NO_COMMENT})(?:[\s,;]|$))#.*", re.IGNORECASE)
_NAME = re.compile(r"\w+\s*([\[(/]\s*\S+\s*[\])]?)?")  # of one column
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?")
_QUOTED = re.compile(r'"[-+]?[1-9]\d{0,2}(?:(?:,\d{3})+\.\d*|(?:,\d{3}){2,})"')
_QUOTED_CELL = re.compile(r'(?:^|,)"([^"]*)"(?=,|$)')
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+([eE][-+]?\d+)?")
_STATED = re.compile(
    r"\[\s*([^\s\[\]]{1,12})\s*\]|\(\s*([^\s()]{1,12})\s*\)|/\s*([^\s\[\]()/,;\"]{1,12})"
    r"|(?<=\w)(?:\s+in\s+([^\s\[\]()/,;\"]{1,12})|_([pnuµμmc]?m))(?=\s*(?:[\",;\t]|$))"
)
_NAMES = {  # without accents, in English, German, French, Spanish and Italian
    "x": r"x|\w*positions?|distance|lateral|length|\w*(?:weg|abstand|strecke|lae?nge)|abscisse|longueur|abscisa"
    r"|posicion|distancia|longitud|ascissa|posizione|distanza|lunghezza",
    "y": "y",
    "z": r"z|h|heights?|topography|elevation|\w*hoe?hen?|hauteurs?|alturas?|altezz[ae]",
    "depth": r"depths?|\w*tiefen?|profondeurs?|profundidad(?:es)?|profondita",
    "values": r"values?|werte?|valeurs?|valor(?:es?|i)?",
    "unit": r"units?|einheit(?:en)?|unites?|unidad(?:es)?|unita",
    "of": r"of|de[rs]?|du|dell?a?|di",
    "width": "width|breite|largeur|anchura|ancho|larghezza",
    "height": "height|hoe?he|hauteur|altura|alto|altezza",
    "size": r"(?:scan|field|image)?[\s_-]*size|(?:bild|messfeld|scan)groe?(?:ss|ß)e",
    "spacing": r"(?:pixel|point|sampl\w*|cell)[\s_-]*(?:size|width|height|spacing|pitch|distance|step|interval)"
    r"|step[\s_-]*size|(?:lateral[\s_-]*)?(?:spacing|pitch|calibration)|inc(?:rement)?|inkrement"
    r"|d(?=[xy]\b)|(?:delta|[Δ∆])(?=[\s_-]*[xy]\b)"
    r"|(?:mess)?(?:punkt|pixel|abtast|raster)(?:abstand|intervall|schritt|breite|hoe?he|groe?(?:ss|ß)e)|schrittweite"
    r"|(?:pas|paso|passo|intervall[eo]|intervalo)(?:\sd\W?[ei]?\s?(?:echantillonnage|mesure|muestreo|campionamento))?"
    r"|(?:taille|tamano|dimensione)\s(?:d\w+\s)?pixel",
    "count": r"samps?|samples?|points?|pixels?|px|lines?|rows|col(?:umn)?s|profiles|res(?:olution)?|aufloe?sung"
    r"|(?:mess)?punkte|zeilen|spalten|lignes|colonnes|puntos|lineas|filas|columnas|punti|righe|colonne",
    "index": r"nr|no|n|i|num(?:ber|ero)?|index|indice|(?:mess)?punkte?|points?|pixels?|samples?|punt[oi]s?",
}
_KINDS = {name: re.compile(names, re.IGNORECASE) for name, names in _NAMES.items()}
_VALUE = re.compile(r"(^|[\s:=])[\d.,]*\d[\d.,]*\s*$")  # a number, whose unit follows: of something else
_OF_A_PROTOCOL = re.compile(r"\s*[:=]\s*\S|[\s,;]\s*[-+]?[\d.,]+([eE][-+]?\d+)?\W*$")  # behind a unit
_ENTRY = re.compile(r"([^:=,;\t]+)[:=,;\t]\s*\W?([^\s\"',;]+)")
_AMOUNT = r"(?:\d+[.,]?\d*|[.,]\d+)(?:e[-+]?\d+)?"
_SIZE = re.compile(
    rf"(?:(?P<axis>xy|[xy])[\s_-]*)?(?:(?P<points>{_NAMES['spacing']})|{_NAMES['width']}|{_NAMES['height']}"
    rf"|{_NAMES['size']})(?:[\s_-]*(?P<after>xy|[xy]))?\s+(?:in\s+(?=[^\W\d]))?(?:(?P<before>[^\W\d]+)\s+)?"
    rf"(?P<x>{_AMOUNT})(?:\s*(?P<unit>[^\W\dx]\w*))?(?:\s*[x×*]\s*(?P<y>{_AMOUNT})\s*(?P<other>[^\W\d]+))?(?:/p\w+)?(?=\s|$)",
    re.IGNORECASE,
)
_SIDES = re.compile(rf"(?P<x>{_NAMES['width']})|(?P<y>{_NAMES['height']})", re.IGNORECASE)
_LENGTH = re.compile(rf"(?<![\w.]){_AMOUNT}\s*([^\W\d_]+)(?!\w|\s*/\s*(?:s|min)\b)|[:=;,\t]\s*([^\W\d_]+)\W*$")
_COUNT = re.compile(rf"(?<![^\W_])(?:n|num|[xy])?(?:{_NAMES['count']})(?![^\W\d_])", re.IGNORECASE)
_WHOLE = re.compile(r"(?<![\w.,])\d{1,9}(?![\w.,]*\d|\s*(?:[^\W\d_]?m|bits?)\b)")
_COUNTS = r"(?:counts?|digits?|lsb|bits?|increments?)"
_SCALE = re.compile(
    rf"\W*(?:(?:z|heights?|vertical|data)[\s_-]*)?(?:scal(?:e|ing)(?:[\s_-]*factor)?|multiplier)\b"
    rf"(?:\s*[\[(](?P<before>[^\])]*)[\])])?[^\w.+-]+(?P<number>{_AMOUNT})\s*(?P<unit>[^\s,;\"]*)"
    rf"|.*?(?P<of>{_AMOUNT})\s*(?P<one>[^\W\d]+\s*(?:/|\bper\b)\s*{_COUNTS}\b)",
    re.IGNORECASE,
)
_MARK = re.compile(
    r"[\W_]*(?:(?:no[\s_-]*data|missing|fill|invalid|blank|bad|void|undefined|null)[\s_-]*(?:(?:data|height|pixel|point)s?)?"
    r"[\s_-]*(?:values?|markers?|flags?|codes?)|no[\s_-]*data|fehl(?:ender[\s_-]*)?wert|ungu?e?ltiger[\s_-]*wert)"
    rf"[^\w.+-]+(?P<number>[-+]?{_AMOUNT})\s*(?:[^\W\d]+\s*)?\W*$",
    re.IGNORECASE,
)
_SPLIT = re.compile(r'[\s";:=()\[\]]+|,(?!\d)|(?<!\d),')  # what stands between words and numbers of an entry
_FORTRAN = re.compile(r"(?<=[\d.,])[dD](?=[-+]?\d)")  # the letter of an exponent
_SECTION = re.compile(r"\[\s*([^\[\]]+?)\s*\]")  # a line like [DATA], if it names no unit
_OF_DATA = re.compile(
    r"(?:raw|mess|\W)*(?:data|daten|donnees|datos|dati|werte|values?|profile?s?|profils?|perfil|profil[oi]|heights?|points?)+",
    re.IGNORECASE,
)
_LONGEST = 2**22  # characters of a line, and
_WIDEST = 2**16  # columns of a map that are read: a table of more columns than rows takes memory without end


@dataclass(frozen=True)
class Layout:
    """Separator of columns (",", ";", tab, `BLANKS`, or "" of one column) and of decimals."""

    separator: str
    decimal: Literal[".", ","]

    def cells(self, line: str) -> list[str]:
        """Cells of a row."""
        if not self.separator:
            return [line]
        return line.split() if self.separator == BLANKS else next(csv.reader([line], delimiter=self.separator))

    def columns(self, line: str) -> int:
        """Number of cells of a row."""
        return len(self.cells(line))


def is_row(line: str) -> bool:
    """Whether all that stands in a line are numbers or signs for missing ones, and one is a number or a word like nan.

    A line of dashes may be part of a header.
    """
    cells = [cell for cell in re.split(r"[;\t]|,?\s+|,(?=[^\d])|,$", _COMMENT.sub("", line).strip()) if cell]
    found = False
    for cell in cells:
        parts = [cell] if _NUMBER.fullmatch(cell) else cell.split(",")
        for part in parts:
            number = _NUMBER.fullmatch(part) is not None
            word = part.strip('" ')
            if not number and word.lower() not in _MISSING and not _INFINITE.fullmatch(word):
                return False
            found = found or number or any(map(str.isalpha, part))
    return found


def layout_of(rows: list[str], header: str) -> Layout:
    """Layout of rows of numbers under the last line of a header; raises ValueError where two would do.

    One comma in each row, with digits alone on both sides, may be a decimal one or separate two columns: the header
    tells, or whole equidistant numbers before it, which are positions, or a number before it that follows itself.
    """
    looked_at = [row.strip() for row in islice((row for row in rows if row.strip()), _LOOKED_AT)]
    _check_thousands(looked_at, header)
    for separator in (";", "\t"):
        if any(separator in row for row in looked_at):
            return Layout(separator, "," if any("," in row for row in looked_at) else ".")
    if not any("," in row for row in looked_at):
        return Layout(BLANKS if any(len(row.split()) > 1 for row in looked_at) else "", ".")
    if any("," in cell for row in looked_at for cell in _QUOTED_CELL.findall(row)):
        return Layout(",", ",")
    tokens = [token for row in looked_at for token in row.split()]
    decimal = all(_DECIMAL_COMMA.fullmatch(token) for token in tokens if "," in token)
    if not decimal or any("." in token for token in tokens) or max(row.count(",") for row in looked_at) > 1:
        if decimal and not any("." in token for token in tokens) and len(tokens) > len(looked_at):
            return Layout(BLANKS, ",")
        return Layout(",", ".")
    if len(tokens) > len(looked_at):
        return Layout(BLANKS, ",")
    return _one_comma(looked_at, header)


def columns_of(header: list[str], columns: int) -> tuple[list[int], tuple[str | None, ...]]:
    """Columns of positions along x, perhaps y, and of heights, in this order, and their units; all of a map, and one.

    A unit is None where the header states none; one of the last line in brackets that is no unit of length is returned
    as it is. Raises ValueError for labels that name positions, but not which of the others are heights, and for depths.
    """
    chosen, units = _labelled(header, columns) or (list(range(columns)), _stated_units(header, columns))
    _check_direction(header, columns, chosen[-1])
    named = _entries(header)
    axes = ("z", "xz", "xyz")[len(units) - 1]
    return chosen, tuple(unit or named.get(axis, named.get("")) for axis, unit in zip(axes, units, strict=True))


def _check_direction(header: list[str], columns: int, heights: int) -> None:
    """Raise ValueError where the labels, or the last line above a map, call the heights of a column depths."""
    for line in header[-2:]:  # labels, and perhaps their units below
        labels = _cells(_STATED.sub("", line))
        label = labels[heights] if len(labels) == columns else labels[0] if len(labels) == 1 else ""
        if not re.search(r"[\d:=]", label):
            check_upwards(label)


def check_upwards(label: str) -> None:
    """Raise ValueError for heights that a label calls depths."""
    words = re.findall(r"[^\W_]+", _unaccented(label))
    if words and _KINDS["depth"].fullmatch(words[-1]):
        raise ValueError(
            f"heights called {label!r}, which may grow downwards, where peaks have to be positive: change their sign "
            "if they do, and write z in place of that name"
        )


def _stated_units(header: list[str], columns: int) -> tuple[str | None, ...]:
    """Unit of each column as it stands; of a map, the one. The last line that states units decides."""
    wanted = columns if columns <= 3 else 1
    for line in reversed(header):
        bare = [length_unit(cell.strip("[]() ")) for cell in _cells(line)]
        if wanted > 1 and len(bare) == wanted and None not in bare:
            return tuple(bare)
        found = _found(line, line is header[-1])
        heights = [unit for label, unit in found if _axis(label) == "z"]
        if found and len(found) == wanted and (wanted > 1 or _axis(found[0][0]) in (None, "z")):
            return tuple(unit for _, unit in found)
        if len(found) == 1 and wanted == 2:  # for both columns if it stands alone
            ((label, unit),) = found
            if not label.strip():
                return (unit, None if _STATED.sub("", line, 1).strip("\"' ,;") else unit)
            of_heights = _axis(label) == "z" and _STATED.sub("", line, 1).split() == label.split()
            of_second = of_heights or bool(re.search("[,;\t]", label)) or len(label.split()) > 1
            return (None, unit) if of_second else (unit, None)
        if wanted == 1 and len(heights) == 1:
            return (heights[0],)
    return (None,) * wanted


def _labelled(header: list[str], columns: int) -> tuple[list[int], tuple[str | None, ...]] | None:
    """Columns that the last line of labels calls positions and heights, and their units; None where none does.

    Names in other languages are known by their units: positions and heights are then the two columns of a larger table
    that have one of length.
    """
    unclear = None
    for number, line in reversed([*enumerate(header)] if columns > 1 else []):
        labels = _cells(_STATED.sub("", line))
        if len(labels) != columns or labels[0].endswith((":", "=")):  # or an entry of a protocol
            continue
        chosen = _by_names([_axis(label) for label in labels])
        cells = _cells(line)
        of = [_found(cell, True, line) for cell in cells] if len(cells) == columns else [[]] * columns
        below = [
            row for row in map(_cells, header[number + 1 :]) if len(row) == columns and row[0][-1:] not in {":", "="}
        ]
        if chosen is None and columns > 2:
            said = [[*(unit for _, unit in of[i]), *(row[i].strip("[]() ") for row in below)] for i in range(columns)]
            lengths = [i for i, each in enumerate(said) if any(map(length_unit, each))]
            named = {i for i, label in enumerate(labels) if _axis(label) is not None}
            chosen = lengths if len(lengths) == 2 and named <= {*lengths} else None
        if chosen is None:
            unclear = unclear or (labels if columns > 2 and {_axis(label) for label in labels} & {*"xy"} else None)
            continue
        units = [next((unit for _, unit in of[i]), None) for i in chosen]
        for row in below:
            cells = [row[i].strip("[]() ") for i in chosen]
            if any(map(length_unit, cells)):  # a row of units, of which one may be none of length
                units = [unit or length_unit(cell) or cell or None for cell, unit in zip(cells, units, strict=True)]
        if not any(units) and columns <= 3:
            stated = _stated_units(header, columns)
            units = [stated[i] for i in chosen]
        words = re.findall(r"[^\W_]+", _unaccented(labels[chosen[0]]))
        if units[0] is None and words and all(map(_KINDS["index"].fullmatch, words)):
            units[0] = COUNTS[0]
        return chosen, tuple(units)
    if unclear is not None:
        told = ", ".join(repr(label) for label in unclear)
        raise ValueError(f"columns {told[:100]}: name the positions x (and y) and the heights z, each once")
    return None


def _by_names(axes: list[str | None]) -> list[int] | None:
    """Columns x, perhaps y, and z of columns that are called so, or not at all; None where that is not clear."""
    at = {axis: [i for i, each in enumerate(axes) if each == axis] for axis in "xyz"}
    unnamed = [i for i, each in enumerate(axes) if each is None]
    if len(axes) == 2:
        if axes == [None, None]:
            return None
        turned = (axes[1] == "x" != axes[0]) or axes == ["z", "y"]
        return [1, 0] if turned else [0, 1]
    if len(axes) == 3 and len(unnamed) == 1 and len(at["y"]) == 1:  # the one that is left
        missing = next(axis for axis in "xyz" if not at[axis]) if len(at["x"]) + len(at["z"]) == 1 else ""
        at |= {missing: unnamed} if missing else {}
    clear = len(at["x"]) == len(at["z"]) == 1 and len(at["y"]) <= 1
    return [*at["x"], *at["y"], *at["z"]] if clear else None


def axis_units(header: list[str]) -> dict[str, str]:
    """Units of x and y, as far as the last line that names one states them."""
    for line in reversed(header):
        named = {axis: unit for label, unit in _found(line, line is header[-1]) if (axis := _axis(label)) in ("x", "y")}
        if named:
            return named
    return {}


class Size(NamedTuple):
    """What the header says of an axis: a number with its unit of length, of one point or of the whole field."""

    number: float
    unit: str
    of_points: bool

    def of_field(self, n: int) -> float:
        """Size of a field of n points, in the unit."""
        return n * self.number if self.of_points else self.number


def stated_sizes(header: list[str]) -> dict[str, Size]:
    """Sizes of points or of the field along x and y, as the header states them; those of points come first.

    A height alone may be one of anything: it is that of the field next to a width.
    """
    found: dict[str, Size] = {}
    for line in header:
        entry, unit = _size(line)
        if entry is None or unit is None or unit == PERIOD:
            continue
        side = _SIDES.search(entry[0])
        axes = entry["axis"] or entry["after"] or ("xy" if side is None else str(side.lastgroup))
        amounts = (float(each.replace(",", ".")) for each in (entry["x"], entry["y"] or entry["x"]))
        sizes = {axis: Size(amount, unit, bool(entry["points"])) for axis, amount in zip("xy", amounts, strict=True)}
        if not (entry["points"] or entry["y"] or len(axes) == 1):
            axes = "x"  # of a square, or the longer side: the other follows from the numbers of points
        new = {axis: sizes[axis] for axis in axes.lower() if sizes[axis].number > 0.0}
        found = found | new if entry["points"] else new | found
    return found if "x" in found else {}


def _size(line: str) -> tuple[re.Match[str] | None, str | None]:
    """Entry of a size, if a line is one, and its unit of length; no word but the unit stands before its number."""
    entry = _SIZE.match(" ".join(filter(None, _SPLIT.split(_unaccented(line)))))
    if entry is None or (entry["before"] and length_unit(entry["before"]) is None):
        return None, None
    units = (length_unit(each) for each in entry.group("other", "unit", "before") if each)
    return entry, next(filter(None, units), None)


def _speaks_of_a_length(line: str) -> bool:
    """Whether a line states a length or its unit, or a distance of points without one."""
    entry, _ = _size(line)
    told = (unit for pattern in (_LENGTH, _STATED) for found in pattern.finditer(line) for unit in found.groups())
    return bool(entry and entry["points"]) or any(length_unit(unit) for unit in told if unit)


def _line_of_a_map(header: list[str], heights: int) -> str | None:
    """Return the line that makes heights in one column a map: it states its side, or one of two; None if none does."""
    lines = [(re.sub(r"(?<=\d)\s*[x×*]\s*(?=\d)", " x ", line), line) for line in header]
    counts = [(int(n), line) for text, line in lines if _COUNT.search(_unaccented(text)) for n in _WHOLE.findall(text)]
    sides = [(n, line) for n, line in counts if 4 <= n < heights]
    alone = heights not in dict(counts)
    for i, (n, line) in enumerate(sides):
        if (alone and n * n == heights) or any(n * other == heights for other, _ in sides[:i]):
            return line
    return None


def stated_scale(header: list[str]) -> str | None:
    """Scale of heights, other than 1, that the header states, as `0.5 nm/count`."""
    for found in filter(None, map(_SCALE.match, header)):
        number = found["number"] or found["of"]
        if float(number.replace(",", ".")) != 1.0:
            return f"{number} {found['before'] or found['unit'] or found['one'] or ''}".rstrip()
    return None


def stated_mark(header: list[str]) -> float | None:
    """Number that marks missing values, as `NODATA_value -9999` says it; None where the header states none."""
    found = next(filter(None, (_MARK.match(_unaccented(line)) for line in header)), None)
    return None if found is None else float(found["number"].replace(",", "."))


@dataclass(frozen=True)
class TextTable:
    """Rows and columns of numbers `[rows, columns]`, not-a-number where a cell is empty.

    `units` are those that the header states for each column, or the one of a map; None where it states none. It may
    name units of positions along a map, `axis_units`, and `sizes` along x and y. `line` is that of the first row,
    counted from 1. `about_lengths` is a line of the header that speaks of a length, `mark` the number that it says
    stands for missing heights.
    """

    values: Reals
    units: tuple[str | None, ...]
    done: tuple[str, ...] = ()
    axis_units: Mapping[str, str] = field(default_factory=dict)
    line: int = 1
    sizes: Mapping[str, Size] = field(default_factory=dict)
    about_lengths: str | None = None
    mark: float | None = None


class Rows(NamedTuple):
    """Numbers of a text file `[rows, columns]`, not-a-number where a cell is empty, and the lines before the first.

    `lines` are the numbers of the lines that rows stand in, counted from 1.
    """

    header: list[str]
    values: Reals
    layout: Layout
    lines: list[int]


def read_table(path: Path) -> TextTable:
    """Positions and heights, or a map, of a text file; raises ValueError, with the line, for anything else."""
    header, values, layout, lines = read_rows(path)
    header = [line.rstrip() for line in header]
    done: tuple[str, ...] = ("read commas as decimal commas",) if layout.decimal == "," else ()
    if len(values) <= 2 and values.shape[1] > 4:
        values = values.T
        done += ("took rows for columns",)
    columns = values.shape[1]
    chosen, units = columns_of(header, columns)
    begins = [line[:_LOOKED_AT] for line in header]
    mark = stated_mark(begins)
    if scale := stated_scale(begins):
        if units[-1] is None or length_unit(units[-1]) is None:
            units = (*units[:-1], scale)
        else:
            done += (f"did not use the scale {scale} of the header, as it states the unit of heights too",)
    if columns == 1 and (of_map := _line_of_a_map(begins, len(values))) is not None:
        raise ValueError(
            f"{len(values)} heights in one column under a header that says {_short(of_map)}, so that they may be a "
            "map: write it as rows of heights, or delete that line if they are a profile"
        )
    if chosen == list(range(columns)):
        about = next((_short(line) for line in begins if _speaks_of_a_length(line)), None)
        return TextTable(values, units, done, axis_units(header), lines[0], stated_sizes(begins), about, mark)
    if columns == 2:
        done += ("took the first of two columns for heights and the second for positions, as their labels say",)
    elif len(chosen) < columns:
        done += (f"took {len(chosen)} of {columns} columns, those that the header calls positions and heights",)
    return TextTable(values[:, chosen], units, done, line=lines[0], mark=mark)


def read_rows(path: Path) -> Rows:
    """Numbers of a text file, whatever its columns hold; raises ValueError, with the line, for anything else.

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
    header = [line.lstrip(_COMMENTS + "/ ") for line in lines[:first]]
    numbers = [i + 1 for i, line in enumerate(lines[first:], first) if not _is_comment(line)]
    rows = [_FORTRAN.sub("e", _COMMENT.sub("", lines[number - 1])) for number in numbers]
    while not rows[-1].strip():
        rows.pop()
    layout = layout_of(rows, header[-1].rstrip() if header else "")
    positions = layout.cells(rows[0])
    if len(rows) > 1 and layout.columns(rows[1]) == len(positions) + 1 > 3 and _in_order(positions, layout):
        rows[0] = f"nan{' ' if layout.separator == BLANKS else layout.separator}{rows[0]}"  # positions without a corner
    columns = layout.columns(rows[0])
    if columns > _WIDEST:
        raise ValueError(f"{columns} columns, more than {_WIDEST}")
    _check_groups(rows, layout, columns)
    shorter = ((i, row) for i, row in zip(numbers, rows, strict=False) if layout.columns(row) < columns)
    cut = next((i for i, row in shorter if "#" in lines[i - 1] and row.strip() not in ("", lines[i - 1].strip())), None)
    if cut is not None:
        raise ValueError(f"a comment in line {cut} before its last column: what is missing is an empty cell, or nan")
    corner = layout.cells(header[-1].rstrip()) if header and layout.separator else []
    if columns > 3 and len(corner) == columns and _in_order(corner[1:], layout):
        rows.insert(0, (" " if layout.separator == BLANKS else layout.separator).join(["nan", *corner[1:]]))
        numbers.insert(0, first)
        header[-1] = corner[0]
    values = _parsed(rows, layout)
    if values is None:
        raise _bad_row(rows, numbers, layout, columns)
    while values.shape[1] > 1 and (values[:, -1] != values[:, -1]).all():  # a separator at the end of each row
        values = values[:, :-1]
    header = [_without_empty_cells(line, values.shape[1]) for line in header]
    return Rows(header, values, layout, numbers[: len(values)])


def _without_empty_cells(line: str, columns: int) -> str:
    """Line of a header less the empty cells at its end that belong to no column, as spreadsheets write them."""
    cut = line.rstrip(" ")
    while cut[-1:] in (*";\t,",) and cut.count(cut[-1]) >= columns:
        cut = cut[:-1].rstrip(" ")
    return cut


def _in_order(cells: list[str], layout: Layout) -> bool:
    """Whether cells are numbers that rise, or that fall."""
    if not all(map(_NUMBER.fullmatch, cells)):
        return False
    values = _parsed(cells, Layout("", layout.decimal))
    steps = np.diff(values[:, 0]) if values is not None else np.zeros(1)
    return bool((steps > 0).all() or (steps < 0).all())


def _check_groups(rows: list[str], layout: Layout, columns: int) -> None:
    """Raise ValueError for a column whose decimal marks may stand between thousands: three digits follow, or none."""
    grouped, plain = re.compile(rf"[-+]?[1-9]\d{{0,2}}(\{layout.decimal}\d{{3}})+"), re.compile(r"[-+]?[1-9]\d{0,2}")
    found: dict[tuple[int, bool], str] = {}
    doubtful = set(range(columns)) if any(layout.decimal in row for row in rows) else set()
    for row in rows:
        if not doubtful:
            return
        cells = layout.cells(row)
        for i in [i for i in doubtful if i < len(cells)]:
            number = cells[i].strip('" ')
            if grouped.fullmatch(number) or plain.fullmatch(number):
                found.setdefault((i, layout.decimal in number), number)
            elif re.search("[1-9]", number):
                doubtful.discard(i)
    for i in doubtful:
        if {(i, True), (i, False)} <= found.keys():
            number, kind = found[i, True], {",": "commas", ".": "points"}[layout.decimal]
            whole, decimal = number.replace(layout.decimal, ""), number.replace(layout.decimal, ".", 1)
            other = f"{decimal} next to {found[i, False]}.000" if decimal == number else decimal
            raise ValueError(
                f"numbers like {number} next to {found[i, False]}, whose {kind} may be decimal ones or stand between "
                f"thousands: write {other} or {whole}"
            )


def _check_thousands(rows: list[str], header: str) -> None:
    """Raise ValueError for commas between thousands, where they can be neither decimal ones nor between columns."""
    tokens = [re.findall(r"[^;\s]+", row) for row in rows]
    grouped = [token for token in chain(*tokens) if "," in token]
    surely = [token for token in grouped if "." in token or token.count(",") > 1]
    found = [token for row in rows for token in _QUOTED.findall(row)]
    if not found and surely and all(map(_THOUSANDS.fullmatch, grouped)):
        # they may separate columns: as many in each row, and if it is one, behind positions or a header
        commas = {row[0].count(",") for row in tokens if len(row) == 1}
        if any(len(row) > 1 for row in tokens) or len(commas) > 1:
            found = surely
        elif max(commas) == 1 and len(re.split("[,;\t]", header)) != 2:
            steps = np.diff([float(row[0].partition(",")[0]) for row in tokens])
            in_order = (steps > 0).all() or (steps < 0).all()
            found = surely if not in_order or _NAME.fullmatch(header) else found
    if found:
        written = found[0].strip('"')
        raise ValueError(f"numbers like {written} with commas between thousands: write {written.replace(',', '')}")


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


def cells_of(line: str) -> list[str]:
    """Cells of a line of the header: between semicolons, tabs or commas, or else between blanks."""
    separator = next((each for each in ";\t," if each in line), None)
    try:
        parts = next(csv.reader([line], delimiter=separator or " ", skipinitialspace=True))
    except csv.Error:  # a cell beyond all measure
        parts = line.split(separator)
    return parts if separator else line.split()


def _cells(line: str) -> list[str]:
    """Cells of a line of the header, without quotes."""
    return [cell.strip("\"' ") for cell in cells_of(line)]


def _entries(header: list[str]) -> dict[str, str]:
    """Units of axes that entries such as `Z unit: um` of a protocol state; of all others the key is empty.

    Such a general entry counts if no other says another unit, of what is not known, and if it is in no section.
    """
    found: dict[str, str] = {}
    general, of_something, section = set(), set(), ""
    for line in header:
        if (mark := _SECTION.fullmatch(line.strip())) is not None and length_unit(mark[1]) is None:
            section = "" if _OF_DATA.fullmatch(_unaccented(mark[1])) else mark[1]
        entry = _ENTRY.match(line)
        words = re.findall(r"[^\W_]+", re.sub("(?i)einheit", " einheit", _unaccented(entry[1]))) if entry else []
        if entry is None or not any(map(_KINDS["unit"].fullmatch, words)):
            continue
        units = [*filter(None, map(length_unit, re.findall(r"[^\s\"',;:=()\[\]]+", line[entry.start(2) :])))]
        axes = [*map(_axes_of, words)]
        if None in axes or len({*units}) > 1:
            of_something |= {*units}
        elif units and any(axes):
            found |= dict.fromkeys("".join(filter(None, axes)), units[0])
        elif units and not section:
            general |= {*units}
    return found | (dict.fromkeys(("",), *general) if len(general) == 1 and of_something <= general else {})


def _axes_of(word: str) -> str | None:
    """Axes that a word next to `unit` names, perhaps none; None for a word that makes it another unit."""
    axes = {"x": "x", "y": "y", "lateral": "xy", "xy": "xy"}.get(word.lower())
    if axes is None and any(_KINDS[kind].fullmatch(word) for kind in ("z", "values")):
        return "z"
    return axes if axes or not any(_KINDS[kind].fullmatch(word) for kind in ("unit", "of")) else ""


def _unaccented(text: str) -> str:
    """Text without accents but the ring of the angstrom."""
    return normalize("NFC", re.sub(r"[\u0300-\u0309\u030b-\u036f]", "", normalize("NFKD", text)))


def _axis(label: str) -> str | None:
    """Axis that a label names by its last word, or by a letter before it, whatever unit follows."""
    words = re.findall(r"[^\W_]+", _unaccented(re.split("[,;\t]", label)[-1]))
    while words and length_unit(words[-1]):
        words.pop()  # of z_um
    letters = [word.lower() for word in (*words[-1:], *words[:1]) if len(word) == 1 and word.lower() in "xyz"]
    named = (axis for word in words[-1:] for axis in "xyz" if _KINDS[axis].fullmatch(word))
    return letters[0] if letters else next(named, None)


def _found(part: str, is_last: bool, line: str | None = None) -> list[tuple[str, str]]:
    """What stands before each unit of a line, or of a part of that line, and the unit's name."""
    found, begin = [], 0
    slashes = sum(length_unit(match[3]) is not None for match in _STATED.finditer(line or part) if match[3])
    for match in _STATED.finditer(part):
        square, round_, slashed, in_words, of_name = match.groups()
        label, rest = part[begin : match.start()], part[match.end() :]
        if _VALUE.search(label) or _OF_A_PROTOCOL.match(rest):
            continue  # an entry of a protocol, such as `scan length (mm): 4`
        if slashed and slashes < 2 and _axis(label) is None:
            continue  # a quotient, such as px/mm; two are names of columns in another language
        unit = length_unit(square or round_ or slashed or in_words or of_name)
        is_mark = match[0] == (line or part).strip() and _OF_DATA.fullmatch(_unaccented(square or "")) is not None
        is_short = round_ and round_.isalpha() and len(round_) < 3
        if unit is None and is_last and not is_mark and (square or is_short):
            unit = square or round_
        if unit is not None:
            found.append((label, unit))
            begin = match.end()
    return found


def _text(path: Path) -> str:
    content = read_regular(path, most_numbers())
    wide = content[:2] in BYTE_ORDER_MARKS
    if b"\0" in content and not wide:
        raise ValueError(f"a zero byte at byte {content.index(0)}: no text")
    try:
        text = content.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")  # of instruments that write µ in one byte
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    return _NO_DATA.sub("nan", text) if "data" in text.lower() else text


def _is_comment(line: str) -> bool:
    bare = line.lstrip()
    return bare.startswith(_COMMENTS[1]) or _COMMENT.match(bare) is not None


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
                na_values=_NA_VALUES,
                skipinitialspace=True,
                skip_blank_lines=False,  # an empty line of one column is an empty cell
                engine="c",
                float_precision="round_trip",  # the default of older versions is off by the last digit
            )
    except (ValueError, pd.errors.ParserError, OverflowError):
        return None
    return np.asarray(table, dtype=np.float64)


def _bad_row(rows: list[str], numbers: list[int], layout: Layout, columns: int) -> ValueError:
    """What is wrong with the first row that cannot be read, found by halving, as a file may be long."""
    good, bad = 0, len(rows)
    while bad - good > 1:
        middle = (good + bad) // 2
        good, bad = (middle, bad) if _parsed(rows[:middle], layout) is not None else (good, middle)
    row, number = rows[bad - 1], numbers[bad - 1]
    if layout.columns(row) > columns:
        return ValueError(f"{layout.columns(row)} columns in line {number}, where line {numbers[0]} has {columns}")
    filled = [cell for cell in layout.cells(row) if cell.strip()]
    for i, cell in enumerate(filled):
        if _parsed([cell], Layout("", layout.decimal)) is None:
            told = "what is missing is an empty cell, or nan" if i else "delete that line if it is no row of numbers"
            return ValueError(f"{_short(cell)} in line {number}, not a number ({told})")
    return ValueError(f"rows of numbers that do not make a table, from line {number} on")


def _short(cell: str) -> str:
    cell = re.sub(r"\s+", " ", cell.strip())
    return repr(cell if len(cell) <= 30 else cell[:27] + "...")
