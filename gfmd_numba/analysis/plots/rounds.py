"""Figure of a run until an error is reached: the error against the processor time spent."""

from typing import Annotated, Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator

from gfmd_numba.analysis.arguments import targets_of
from gfmd_numba.analysis.forms import ROUNDS, UnusableDataError
from gfmd_numba.analysis.plots.style import COLOURS, MARKERS, Width, add_legend, drawn, log_ticks, sheet, symbol

_TARGET = COLOURS[2]
_BARS = "rounds, bars to 90 % confidence"


@drawn
def plot_rounds(dataset: Annotated[xr.Dataset, ROUNDS], width: Width | None = None) -> Figure:
    """Draw the error of the worst group after each round against processor time, and its target, of each variable.

    Bars go to the error that is not exceeded with 90 % probability. UnusableDataError for results without a round that
    has an error, InputError for targets that are none.
    """
    targets = targets_of(dataset)
    if "round" not in dataset.dims or not targets or not (dataset["round_error"] > 0).any():
        raise UnusableDataError(
            "you gave results without a round that has an error; gfmd allows those of `gfmd run --until`"
        )
    with sheet(1, 1, (7.2, 4.2), width) as (figure, (axis,)):
        which = symbol(next(iter(targets))) if len(targets) == 1 else "each target"
        ylabel = f"Relative error of {which} in the limit"
        axis.set(xscale="log", yscale="log", xlabel="Processor time of the contacts (s)", ylabel=ylabel)
        seconds = dataset["round_cpu_seconds"].values[np.isfinite(dataset["round_cpu_seconds"].values)]
        axis.set_xlim(0.5 * seconds[0], 2.0 * seconds[-1])
        for number, (name, target) in enumerate(targets.items()):
            of_target = dataset.sel(target=name) if "target" in dataset.dims else dataset
            _draw(axis, of_target, target, number, f"{symbol(name)}: " if len(targets) > 1 else "")
        log_ticks(axis.xaxis)
        axis.margins(y=0.16)
        least, most = axis.get_ylim()
        few = MaxNLocator(4) if most < 4.0 * least else LogLocator(subs=(1.0, 2.0, 5.0))  # two labels at least
        axis.yaxis.set_major_locator(few)
        axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:.3g} %"))
        axis.yaxis.set_minor_locator(NullLocator())
        axis.grid()
        add_legend(figure, axis.get_legend_handles_labels()[0], 2)
    return figure


def _draw(axis: Axes, dataset: xr.Dataset, target: float, number: int, whose: str) -> None:
    """Draw the rounds of one target; of several, its line has the colour of its rounds."""
    known = dataset.isel(round=np.flatnonzero((dataset["round_error"] > 0).values))
    seconds, errors = known["round_cpu_seconds"].values, known["round_error"].values
    colour, marker = COLOURS[number % len(COLOURS)], MARKERS[number % len(MARKERS)]
    line: dict[str, Any] = {"color": colour, "ls": "--"} if whose else {"color": _TARGET}
    axis.axhline(target, label=f"{whose}target {100 * target:.3g} %", **line)
    expected = known["round_predicted_error"]
    label = f"{whose}expected before the round"
    axis.plot(seconds, expected, marker, color=colour, mfc="none", ms=8, label=label)
    sure = errors * (known["round_error_factor"].values - 1.0)
    bars = [0.0 * sure, sure]
    axis.errorbar(seconds, errors, bars, fmt=f"{marker}-", color=colour, label=f"{whose}{_BARS}")
    for which, x, y in zip(known["round"].values, seconds, errors, strict=True):
        if which:
            axis.annotate(str(which), (x, y), textcoords="offset points", xytext=(-5, -7), ha="right", va="top")
        else:  # on the other side, away from the numbers of the axis
            axis.annotate("pilot", (x, y), textcoords="offset points", xytext=(6, 0), va="bottom")
