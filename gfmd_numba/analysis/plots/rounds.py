"""Figure of a run until an error is reached: the error against the processor time spent."""

from typing import Annotated, Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from gfmd_numba.analysis.arguments import TARGET, checked
from gfmd_numba.analysis.forms import ROUNDS, UnusableDataError
from gfmd_numba.analysis.plots.style import COLOURS, STYLE

_RESULT, _TARGET = COLOURS[0], COLOURS[2]
_ROUNDS: dict[str, Any] = {"fmt": "o-", "color": _RESULT, "ms": 5.5, "capsize": 3, "lw": 1.3}
_BARS = "rounds, bars to 90 % confidence"
_TIMES = {  # ticks of an axis of time, in s
    "1 ms": 1e-3,
    "10 ms": 1e-2,
    "0.1 s": 0.1,
    "0.2 s": 0.2,
    "0.5 s": 0.5,
    "1 s": 1.0,
    "2 s": 2.0,
    "5 s": 5.0,
    "10 s": 10.0,
    "20 s": 20.0,
    "1 min": 60.0,
    "2 min": 120.0,
    "5 min": 300.0,
    "10 min": 600.0,
    "30 min": 1800.0,
    "1 h": 3600.0,
    "2 h": 7200.0,
    "5 h": 18e3,
    "10 h": 36e3,
    "1 day": 86400.0,
    "4 days": 4 * 86400.0,
    "40 days": 40 * 86400.0,
    "1 year": 365 * 86400.0,
}


@checked
def plot_rounds(dataset: Annotated[xr.Dataset, ROUNDS]) -> Figure:
    """Draw the error of the worst group after each round against processor time, and its target.

    Bars go to the error that is not exceeded with 90 % probability. UnusableDataError for results without a round that
    has an error.
    """
    if "round" not in dataset.dims or not (dataset["round_error"] > 0).any():
        raise UnusableDataError(
            "you gave results without a round that has an error; gfmd allows those of `gfmd run --until`"
        )
    known = dataset.isel(round=np.flatnonzero((dataset["round_error"] > 0).values))
    seconds, errors = known["round_cpu_seconds"].values, known["round_error"].values
    target = TARGET.checked(dataset.attrs.get("target"), "the attribute target")
    with mpl.rc_context(STYLE):
        figure = Figure((7.2, 4.8), dpi=150, layout="constrained")
        axis = figure.subplots()
        axis.set(xscale="log", yscale="log", xlabel="Processor time of the contacts", ylabel=_ylabel(dataset))
        axis.axhline(target, color=_TARGET, lw=1.3, label=f"target {100 * target:.3g} %")
        axis.plot(
            seconds,
            known["round_predicted_error"],
            "o",
            color=_RESULT,
            mfc="none",
            ms=9,
            label="expected before the round",
        )
        sure = errors * (known["round_error_factor"].values - 1.0)
        axis.errorbar(seconds, errors, [0.0 * sure, sure], label=_BARS, **_ROUNDS)
        for number, x, y in zip(known["round"].values, seconds, errors, strict=True):
            _write(axis, str(number) if number else "pilot", (x, y), (-5, -7), "right")
        axis.set_xlim(0.5 * seconds[0], 2.0 * seconds[-1])
        _tick(axis)
        axis.grid(color="0.9", linewidth=0.8)
        figure.legend(loc="outside upper center", ncols=2)
    return figure


def _write(axis: Axes, text: str, at: tuple[float, float], shift: tuple[float, float], side: str) -> None:
    axis.annotate(text, at, textcoords="offset points", xytext=shift, ha=side, va="top")


def _tick(axis: Axes) -> None:
    """Ticks of times as people say them, and of errors in per cent."""
    axis.margins(y=0.16)
    low, high = axis.get_xlim()
    shown = {text: time for text, time in _TIMES.items() if low <= time <= high}
    axis.set_xticks(list(shown.values()), list(shown))
    axis.xaxis.set_minor_locator(NullLocator())
    axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:.3g} %"))
    axis.yaxis.set_minor_locator(NullLocator())


def _ylabel(dataset: xr.Dataset) -> str:
    variable = str(dataset.attrs["until"]).split("=")[0]
    symbol = {"kappa": r"$\kappa$", "kappa_r": r"$\kappa_r$"}.get(variable, variable.replace("_", " "))
    return f"Relative error of {symbol} in the limit"
