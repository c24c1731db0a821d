"""What the header of a text file says of its columns: names and units of length: `x [mm]`, `height (um)`, `z/nm`."""

import re

from gfmd_numba.scene.length_units import length_unit

_STATED = re.compile(r"\[\s*([^\s\[\]]{1,12})\s*\]|\(\s*([^\s()]{1,12})\s*\)|/\s*([^\s\[\]()/,;]{1,12})")
_HEIGHT = re.compile(r"\b(z|h|heights?|topography)\W*$", re.IGNORECASE)
_POSITION = re.compile(r"\b(x|y|positions?|distance|lateral)\W*$", re.IGNORECASE)
_NO_HEIGHT = re.compile(r"\b(x|positions?|distance|lateral)\W*$", re.IGNORECASE)  # as y is, where the other is x
_VALUE = re.compile(r"(^|[\s:=])[\d.,]+\s*$")  # a number, whose unit follows: of something else


def stated_units(header: list[str], columns: int) -> tuple[str | None, ...]:
    """Unit of each column, of a table with up to three, or the one of a map; None where the header states none.

    The last line that states units decides. What stands in brackets in the last line of all, and is no unit of length,
    is returned as it is.
    """
    wanted = columns if columns <= 3 else 1
    for line in reversed(header):
        found = _found(line, line is header[-1])
        heights = [unit for label, unit in found if _HEIGHT.search(label)]
        if found and len(found) == wanted:
            return tuple(unit for _, unit in found)
        if len(found) == 1 and wanted == 2:
            return _of_one(line, *found[0])
        if wanted == 1 and len(heights) == 1:
            return (heights[0],)
    return (None,) * wanted


def heights_first(header: list[str]) -> bool:
    """Whether the labels of two columns say that the first holds heights, and the second positions."""
    for line in reversed(header):
        parts = re.split("[,;\t]", _STATED.sub("", line))
        parts = parts if len(parts) == 2 else _STATED.sub("", line).split()
        labels = [re.sub("_[^_]*$", "", part.strip("\"' ")) for part in parts]  # of z_um z
        if len(labels) == 2 and any(_HEIGHT.search(label) or _POSITION.search(label) for label in labels):
            first, second = labels
            of_x = _NO_HEIGHT.search(second) is not None and not _NO_HEIGHT.search(first)
            of_z = _HEIGHT.search(first) is not None and _POSITION.search(second) is not None
            return of_x or of_z
    return False


def axis_units(header: list[str]) -> dict[str, str]:
    """Units of x and y, as far as the last line that names one states them."""
    for line in reversed(header):
        named = {axis: unit for label, unit in _found(line, line is header[-1]) if (axis := _axis(label)) is not None}
        if named:
            return named
    return {}


def _axis(label: str) -> str | None:
    found = re.search(r"\b([xy])\W*$", label, re.IGNORECASE)
    return None if found is None else found.group(1).lower()


def _found(line: str, is_last: bool) -> list[tuple[str, str]]:
    """What stands before each unit of a line, and the unit's name."""
    found, begin = [], 0
    for match in _STATED.finditer(line):
        square, round_, slashed = match.groups()
        label, rest = line[begin : match.start()], line[match.end() :]
        if _VALUE.search(label) or re.match(r"\s*[:=]\s*\S", rest):
            continue  # an entry of a protocol, such as `scan length (mm): 4`
        if slashed and not (_HEIGHT.search(label) or _POSITION.search(label)):
            continue  # a quotient, such as px/mm
        unit = length_unit(square or round_ or slashed)
        if unit is None and is_last and (square or (round_ and round_.isalpha() and len(round_) < 3)):
            unit = square or round_
        if unit is not None:
            found.append((label, unit))
            begin = match.end()
    return found


def _of_one(line: str, label: str, unit: str) -> tuple[str | None, str | None]:
    """Units of two columns of which a line states one: for both if it stands alone."""
    if not label.strip():
        alone = len(line.split()) == 1
        return (unit, unit) if alone else (unit, None)
    second = bool(re.search("[,;\t]", label)) or len(label.split()) > 1
    return (None, unit) if second else (unit, None)
