"""Tables of dynamic mechanical analysis (DMA): frequency, storage and loss modulus, as their header names them."""

import re
from pathlib import Path
from typing import NamedTuple
from unicodedata import normalize

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness import surface_text
from gfmd_numba.scene.units import PRESSURE, Quantity
from gfmd_numba.text.input_error import InputError, brief

_FEWEST = 3  # frequencies
_LARGEST = 1e30  # frequency or modulus
_LARGEST_LOSS, _DEEPEST_FALL = 3.0, 0.2  # over the storage modulus, and of it, which hardly any solid exceeds

FREQUENCY = Quantity("frequency", ("Hz", "rad/s", "1/s"))
_PLAIN_QUOTES = str.maketrans({**dict.fromkeys("′’´`‘\x92", "'"), **dict.fromkeys('″”“\x94"', "''")})
_COLUMNS = {  # what the label of a column says that it holds: the first that fits
    "other": r"^(log|lg|ln)\b|complian|complex|viscos|angle|winkel|\b[eg] ?\*",
    "tan delta": r"\btan|loss (factor|tangent)|verlustfaktor|facteur de perte",
    "loss modulus": r"\b[eg] ?(''|2\b)|loss|verlust|perte",
    "storage modulus": r"\b[eg] ?('|1\b)|storage|speicher|conservation",
    "angular frequency": r"ω|omega|angular|kreisfreq|pulsation",
    "frequency": r"freq|fréq|\bf\b",
}
_SHEAR = r"\bg ?['12]|shear|schub|cisaillement"
_IN_ORDER = "frequency", "storage modulus", "loss modulus"


class Moduli(NamedTuple):
    """Frequencies in Hz, storage and loss moduli of tension in Pa `[row]`, by rising frequency, and the unit they had.

    `source` and `lines` say where they stand, and `read` what the columns were taken for.
    """

    frequency: Reals
    storage: Reals
    loss: Reals
    unit: str = "Pa"
    source: str = "table"
    lines: tuple[int, ...] = ()
    read: str = ""

    def warnings(self) -> list[str]:
        """Sentences about moduli that no viscoelastic solid has."""
        told, swapped = [], "did you swap the columns of storage and loss?"
        if (ratio := float(np.median(self.loss / self.storage))) > _LARGEST_LOSS:
            told.append(f"{self.source}: the loss modulus is {ratio:.2g} times the storage modulus: {swapped}")
        before = np.maximum.accumulate(self.storage)
        worst = int(np.argmax(1.0 - self.storage / before))
        if 1.0 - self.storage[worst] / before[worst] > _DEEPEST_FALL:
            told.append(
                f"{self.source}: the storage modulus falls with the frequency, to {self.at(worst)}, which no body does "
                f"at one temperature and strain: {swapped} Or give one sweep alone"
            )
        return told

    def at(self, row: int) -> str:
        """The storage modulus of a row, its frequency and its line."""
        value = PRESSURE.in_unit(float(self.storage[row]), self.unit)
        line = f" (line {self.lines[row]})" if self.lines else ""
        return f"{value:.4g} {self.unit} at {self.frequency[row]:.4g} Hz{line}"


class _Column(NamedTuple):
    """Place and label of a column, the unit that it states, if any, and what that is in SI units."""

    at: int
    label: str
    unit: str | None = None
    value: float = 1.0

    @property
    def told(self) -> str:
        """Its label, or its place."""
        return repr(self.label) if self.label else f"column {self.at + 1}"


def read_table(path: Path, unit: str | None = None, poissons_ratio: float | None = None) -> Moduli:
    """Moduli of tension of a text file, whose header says what its columns hold and in which units.

    Without names, three columns are frequency, storage and loss modulus. `unit` is that of moduli where the header
    states none. Moduli of shear need a Poisson's ratio, as E = 2 (1 + nu) G. Separators, decimal commas and comments
    are those of measured surfaces. Raises InputError for what is no such table.
    """
    if poissons_ratio is not None and not -1.0 < poissons_ratio <= 0.5:
        raise InputError.of("poissons_ratio", brief(poissons_ratio), "a number above -1 and at most 0.5")
    try:
        header, values, _, lines = surface_text.read_rows(path)
        columns = _columns(path, header, values.shape[1])
    except InputError:
        raise
    except ValueError as error:
        allowed = "a text file of three columns, frequency, storage and loss modulus, or of more that its header names"
        raise InputError.of(path, error, allowed) from None
    frequency, hertz, told = _frequency(path, columns)
    moduli = [columns[name] for name in ("storage modulus", "loss modulus") if name in columns]
    written, in_pascal = _units(path, moduli, unit)
    of_shear = any(re.search(_SHEAR, _plain(column.label)) for column in moduli)
    if of_shear and poissons_ratio is None:
        allowed = "those with the option --poissons-ratio (0.5 for rubber), as E = 2 (1 + nu) G"
        raise InputError.of(path, f"moduli of shear, {moduli[0].told}", allowed)
    used = [frequency, moduli[0], moduli[1] if len(moduli) == 2 else columns["tan delta"]]
    filled = ~np.isnan(values).all(axis=1)  # the others are empty lines
    rows, at = values[filled][:, [column.at for column in used]], np.array(lines)[filled]
    bad = np.flatnonzero(~((rows > 0.0) & (rows < _LARGEST)).all(axis=1))
    if bad.size:
        row = " ".join(f"{value:g}" for value in rows[bad[0]])
        raise InputError.of(
            path, f"{row} in line {at[bad[0]]}", f"numbers above 0 in {', '.join(column.told for column in used)}"
        )
    if np.unique(rows[:, 0]).size < _FEWEST:
        raise InputError.of(path, f"{len(rows)} rows of numbers", f"at least {_FEWEST} different frequencies")
    order = np.argsort(rows[:, 0], kind="stable")
    cycles, first, second = rows[order].T
    young = 2.0 * (1.0 + (poissons_ratio or 0.0)) if of_shear else 1.0
    storage = young * in_pascal[0] * first
    loss = young * in_pascal[1] * second if len(moduli) == 2 else storage * second
    holds = ["frequency", "storage modulus", "loss modulus" if len(moduli) == 2 else "tan delta"]
    read = ", ".join(f"{name} from {column.told}" for name, column in zip(holds, used, strict=True))
    read += f"; frequencies in {told}, moduli in {written}"
    read += f", E = 2 (1 + nu) G with nu = {poissons_ratio:g}" if of_shear else ""
    return Moduli(hertz * cycles, storage, loss, written, str(path), tuple(at[order].tolist()), read)


def _columns(path: Path, header: list[str], count: int) -> dict[str, _Column]:
    """Columns by what they hold, with their units; raises ValueError where a header does not tell.

    Labels stand in the last line that names a column, units there or below it.
    """
    table = [cells for line in header if len(cells := _cells(line, count)) == count]
    found = [[_holds(cell) for cell in cells] for cells in table]
    named = next((i for i in reversed(range(len(table))) if set(found[i]) & set(_IN_ORDER)), None)
    for line in header[-2:]:
        if named is None and len({*map(_holds, re.split(r"[;,\s]+", line))} & set(_IN_ORDER)) > 1:
            raise ValueError(f"{count} columns of numbers under the header {brief(line)}")
    names = [""] * count if named is None else found[named]
    labels = [""] * count if named is None else table[named]
    below = table[named or 0 :]
    for name in set(_COLUMNS) - {"other"}:
        same = [label for label, each in zip(labels, names, strict=True) if each == name]
        if len(same) > 1:
            raise ValueError(f"{len(same)} columns of the {name}: {', '.join(map(repr, same))}")
    has_all = "storage modulus" in names and bool({"frequency", "angular frequency"} & set(names))
    if not (has_all and {"loss modulus", "tan delta"} & set(names)):
        if count != len(_IN_ORDER) or any(name not in ("", own) for name, own in zip(names, _IN_ORDER, strict=True)):
            known = f"named {', '.join(map(repr, labels))}" if named is not None else "without names"
            raise ValueError(f"{count} columns {known}")
        names = list(_IN_ORDER)
    columns = {}
    for at, (name, label) in enumerate(zip(names, labels, strict=True)):
        quantity = {"frequency": FREQUENCY, "angular frequency": FREQUENCY}.get(name, PRESSURE)
        if name in _COLUMNS and name != "other":
            stated = (_stated(path, cells[at], quantity) for cells in below if name != "tan delta")
            columns[name] = _Column(at, label, *next(filter(None, stated), ()))
    return columns


def _cells(line: str, count: int) -> list[str]:
    """Cells of a line of the header, as far as there are columns; between blanks, names may have several words."""
    cells = [cell.strip() for cell in surface_text.cells_of(line)]
    if len(cells) != count and not re.search(r"[;,\t]", line):
        apart = re.sub(r" +(?=\S+)", lambda gap: "\t" if _holds(line[gap.end() :].split()[0]) else gap[0], line)
        cells = apart.split("\t")
    while len(cells) > count and not cells[-1]:
        cells.pop()
    return cells


def _plain(label: str) -> str:
    """A label in small letters, with plain quotes and blanks."""
    return normalize("NFKC", label.translate(_PLAIN_QUOTES)).translate(_PLAIN_QUOTES).replace("_", " ").lower()


def _holds(label: str) -> str:
    """What a column holds by its label, nothing if that does not tell."""
    plain = _plain(label).strip()
    return next((name for name, words in _COLUMNS.items() if re.search(words, plain)), "")


def _stated(path: Path, cell: str, quantity: Quantity) -> tuple[str, float] | None:
    """Unit of a quantity that a cell of a header states, and what it is in SI units; None if it states none.

    Raises InputError for something else in brackets that is no symbol.
    """
    cell = normalize("NFKC", cell)
    in_brackets = re.findall(r"[\[(]([^\[\]()]*)[\])]", cell)
    behind = (cell[found.end() :] for found in re.finditer(r"^|[\s,/_]", cell))
    for text in (*in_brackets, *behind):
        text = text.strip(" .")
        if text and (value := _in_si(re.sub(r"^1 ?/ ?(\w+)$", r"\1^-1", text), quantity)) is not None:
            return text, value
    for text in in_brackets:
        if not _holds(text):
            raise InputError.of(path, f"the unit {brief(text)} in {brief(cell)}", quantity.allowed)
    return None


def _in_si(unit: str, quantity: Quantity) -> float | None:
    """What a unit is in SI units, None if it is none of the quantity."""
    try:
        return quantity.si_value(f"1 {unit}")
    except ValueError:
        return None


def _frequency(path: Path, columns: dict[str, _Column]) -> tuple[_Column, float, str]:
    """Column of frequencies, what one of it is in Hz, and the unit in words. The header tells cycles from radians."""
    is_angular = "frequency" not in columns
    column = columns["angular frequency" if is_angular else "frequency"]
    unit = column.unit or ("rad/s" if is_angular else "Hz")
    of_cycles, of_radians = "hz" in unit.lower() or "hertz" in unit, unit.startswith("rad")
    if (is_angular and of_cycles) or not (is_angular or of_cycles or of_radians):
        raise InputError.of(path, f"{column.told} in {unit}", "a frequency in Hz, or an angular frequency in rad/s")
    return column, column.value if of_cycles else column.value / (2.0 * np.pi), unit


def _units(path: Path, moduli: list[_Column], unit: str | None) -> tuple[str, list[float]]:
    """Unit of the first of the columns of moduli, and what one of each is in Pa."""
    given = None if unit is None else _in_si(unit, PRESSURE)
    if unit is not None and given is None:
        raise InputError.of("unit", brief(unit), "a unit of pressure, like MPa")
    stated = [column for column in moduli if column.unit is not None]
    for column in stated:
        if given not in (None, column.value):
            raise InputError.of("unit", brief(unit), f"the unit of {path}, {column.unit}, or none")
    written = stated[0].unit if stated else unit
    if written is None:
        raise InputError.of(path, "no unit of moduli", "one in the header, like E' [MPa], or with the option --unit")
    common = stated[0].value if stated else given
    assert common is not None
    return written, [common if column.unit is None else column.value for column in moduli]
