"""The one error about what a user gives, in words fit for a terminal."""

import reprlib
from typing import Self

from gfmd_numba.text.printable import printable

ABSENT = object()

_short = reprlib.Repr()
_short.maxstring = _short.maxother = _short.maxlong = 60
_short.maxlevel = 2

MOST_LINES, MOST_CHARACTERS, LONGEST_LINE = 100, 8000, 1500  # of one message


class InputError(ValueError):
    """What is wrong with the input, one argument `FILE:LINE:COLUMN: key: you gave ...; gfmd allows ...` per line.

    Its text is short and fit for a terminal: what is not printable is escaped. `more` faults are only counted.
    """

    def __init__(self, *faults: str, more: int = 0) -> None:
        super().__init__(*faults)
        self.more = more

    @classmethod
    def of(cls, where: object, given: object, allowed: object) -> Self:
        """Error about what was given somewhere, and what is allowed there."""
        return cls(f"{where}: you gave {given}; gfmd allows {allowed}")

    def __str__(self) -> str:
        lines: list[str] = []
        for line in map(printable, self.args[:MOST_LINES]):
            half = LONGEST_LINE // 2  # the ends of a line tell where, and what is allowed
            lines.append(line if len(line) <= LONGEST_LINE else f"{line[:half]} ... {line[-half:]}")
            if sum(map(len, lines)) > MOST_CHARACTERS - LONGEST_LINE:
                break
        left = len(self.args) - len(lines) + self.more
        return "\n".join([*lines, f"and {left} more"] if left else lines)


def brief(value: object) -> str:
    """Return what was given, short enough for a message."""
    if value is ABSENT:
        return "nothing"
    if value is None:
        return "an empty value"
    if isinstance(value, float):
        return repr(float(value))  # of NumPy's too
    return str(value).lower() if isinstance(value, bool) else _short.repr(value)
