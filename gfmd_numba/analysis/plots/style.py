"""What all figures share: colours, fonts, and values in the SI prefix that suits them."""

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axis import Axis
from matplotlib.colors import to_hex
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from gfmd_numba.arrays import Reals
from gfmd_numba.text.numbers import si_prefix

# Okabe and Ito: told apart with any colour vision. In grey the first two are alike: lines of both need a dash or marker
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
LINE = 0.34  # inches of a line of a legend
STYLE: dict[Any, Any] = {
    "font.size": 11,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "legend.handlelength": 2.6,  # a whole dash and dot
}
_KAPPA = r"$\kappa = a_r\,E^*\bar{g}\,/\,\bar{p}$"


def ordered_colours(count: int) -> list[str]:
    """Return colours of ordered values, from dark to light, so that they are told apart in grey too.

    All have a contrast of at least 3 : 1 to white.
    """
    if count == 1:
        return [COLOURS[0]]
    return [to_hex(mpl.colormaps["viridis"](float(place))) for place in np.linspace(0.0, 0.6, count)]


def few_ticks(axis: Axis) -> None:
    """Leave room between the labels of a linear axis of a small panel."""
    axis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))


def log_ticks(axis: Axis) -> None:
    """Label a logarithmic axis so that values can be read: with plain numbers, and between few powers of ten."""
    low, high = axis.get_view_interval()
    if high < 100.0 * low:
        axis.set_major_locator(MaxNLocator(3) if high < 4.0 * low else LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_minor_formatter(NullFormatter())
    if high < 100.0 * low or (low >= 1e-4 and high < 1e5):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def of_variable(dataset: xr.Dataset, variable: str) -> str:
    """Label of what is measured."""
    long_name = dataset[variable].attrs.get("long_name", variable)
    return _KAPPA if variable == "kappa" else with_unit(long_name, dataset[variable])


def with_unit(text: str, variable: xr.DataArray) -> str:
    """Text with the unit of a variable behind it."""
    unit = str(variable.attrs.get("units", "1"))
    return text if unit == "1" else f"{text} ({unit})"


def told(value: float, unit: str, digits: int = 4) -> str:
    """Return a number with its unit for a sentence; a unit that begins with a power of ten is multiplied."""
    times = r"$\times$" if unit.startswith("$10^") else " "
    return f"{value:.{digits}g}" + (times + unit if unit else "")


def scaled(variable: xr.DataArray, text: str, natural: str) -> tuple[Reals, str]:
    """Values in the SI prefix that suits them, and their label; `natural` stands for the unit 1."""
    factor, unit = prefix(variable, natural)
    return factor * variable.values, f"{text} ({unit})"


def prefix(variable: xr.DataArray, natural: str) -> tuple[float, str]:
    """Return factor and label of the SI prefix that suits the values; natural stands for the unit 1."""
    unit = str(variable.attrs.get("units", "1"))
    largest = float(abs(variable).max())
    if unit == "1":
        power = int(np.floor(np.log10(largest))) if largest else 0
        return (1.0, f"${natural}$") if -2 <= power <= 3 else (10.0**-power, rf"$10^{{{power}}}\,{natural}$")
    return si_prefix(largest, unit)


_PRESCRIBED = (
    ("reduced_pressure", "$p^*$", ""),
    ("punch_displacement", "punch displacement", "L_x"),
    ("sliding", "sliding", "L_x"),
    ("sliding_y", "sliding along $y$", "L_x"),
)


def named_last_step(dataset: xr.Dataset) -> str:
    """Return which step of a path is drawn, and its loading; nothing for a dataset without a path."""
    if dataset.sizes.get("step", 1) == 1:
        return ""
    said = f"Step {dataset.sizes['step'] - 1}, the last"
    for name, symbol, natural in _PRESCRIBED:
        if name in dataset and dataset[name].any():
            factor, unit = prefix(dataset[name], natural) if natural else (1.0, "")
            said += f", {symbol} = {told(factor * float(dataset[name][-1]), unit)}"
    return said


def edges(centres: Reals) -> Reals:
    """Return the edges of bins of one width around their centres."""
    half = 0.5 * (centres[1] - centres[0])
    return np.append(centres - half, centres[-1] + half)
