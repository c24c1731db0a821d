"""How the groups of a campaign are told apart in a figure: by colour in one parameter, by marker in the others."""

from dataclasses import dataclass
from typing import Any

import xarray as xr

from gfmd_numba.analysis.names import has_names, plain, shown
from gfmd_numba.analysis.plots.style import MARKERS, ordered_colours, with_unit
from gfmd_numba.analysis.selection import axes, groups, key
from gfmd_numba.text.si_prefix import si_prefix

_DASHES = ("-", "--", ":", "-.")

Key = tuple[float, ...]  # parameters of a group
Look = dict[str, Any]


@dataclass(frozen=True)
class Looks:
    """The look of each group by its parameters `names`, of which `column` has the colours and the label `label`."""

    of: dict[Key, Look]
    names: tuple[str, ...]
    column: int
    label: str

    @property
    def coloured(self) -> list[float]:
        """Values that have a colour each."""
        return sorted({each[self.column] for each in self.of})

    @property
    def others(self) -> list[Key]:
        """Sets of all other parameters, which have a marker each."""
        return sorted({_without(each, self.column) for each in self.of})

    def position(self, each: Key) -> float:
        """Where a group stands among others of its colour, 1 from one colour to the next."""
        others = self.others
        shift = others.index(_without(each, self.column)) - (len(others) - 1) / 2
        return self.coloured.index(each[self.column]) + 0.5 * shift / len(others)


def looks(dataset: xr.Dataset) -> Looks:
    """Look of each group: a colour for each Hurst exponent, or else value of the first parameter that varies."""
    names = axes(dataset)
    keys = [key(parameters) for parameters, _ in groups(dataset)]
    varied = [i for i in range(len(names)) if len({each[i] for each in keys}) > 1]
    column = names.index("hurst") if "hurst" in names else next(iter(varied), 0)
    found = Looks({each: {} for each in sorted(keys)}, names, column, _label(dataset[names[column]]))
    coloured, others = found.coloured, found.others
    told = sorted({column, *varied})
    palette = ordered_colours(len(coloured))
    for each, look in found.of.items():
        style, colour = others.index(_without(each, column)), coloured.index(each[column])
        look |= {
            "color": palette[colour],
            "marker": MARKERS[(style if len(others) > 1 else colour) % len(MARKERS)],
            "linestyle": _DASHES[style % len(_DASHES)],
            "label": _told([(dataset[names[i]], each[i]) for i in told]),
        }
    return found


def _without(each: Key, column: int) -> Key:
    return each[:column] + each[column + 1 :]


def _label(axis: xr.DataArray) -> str:
    return with_unit(str(axis.attrs.get("label", axis.name)), axis)


def _told(parameters: list[tuple[xr.DataArray, float]]) -> str:
    """Names that values stand for, and a formula of all other values."""
    names = [plain(shown(axis, [value])[0]) for axis, value in parameters if has_names(axis)]
    formula = ", ".join(_value(axis, value) for axis, value in parameters if not has_names(axis))
    return ", ".join([*names, f"${formula}$"] if formula else names)


def _value(axis: xr.DataArray, value: float) -> str:
    """Symbol, value and unit of a parameter within a formula."""
    unit = axis.attrs.get("units", "1")
    factor, unit = (1.0, unit) if unit == "1" else si_prefix(abs(value), unit)
    symbol = str(axis.attrs.get("label", axis.name)).strip("$")
    return f"{symbol} = {factor * value:g}".replace("inf", r"\infty") + (rf"\,\mathrm{{{unit}}}" if unit != "1" else "")
