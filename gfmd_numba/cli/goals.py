"""The error that a campaign was meant to have, and the one it has."""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING

from gfmd_numba.cli.sentences import say
from gfmd_numba.cli.tables import duration, show_target

if TYPE_CHECKING:
    import xarray as xr


def show_goal(dataset: xr.Dataset, fitted: xr.Dataset) -> None:
    """Print what a campaign has reached of its target, round by round if it ran until then; nothing without one."""
    if "round" in dataset.dims:
        _show_rounds(dataset)
    elif "target" in dataset.attrs:
        show_target(fitted, dataset.attrs["target"])


def _show_rounds(dataset: xr.Dataset) -> None:
    target = float(dataset.attrs["target"])
    for number in dataset["round"].values.tolist():
        one = dataset.sel(round=number)
        error, predicted = float(one["round_error"]), float(one["round_predicted_error"])
        found = "without an error" if isnan(error) else f"error {error:.2%}"
        asked = "the pilot" if isnan(predicted) else f"{predicted:.2%} expected"
        seconds = float(one["round_cpu_seconds"])
        spent = "not finished" if isnan(seconds) else f"{duration(seconds)} of processor time so far"
        say("round", f"{number}: {found}, {asked}; {spent}")
    last = dataset.isel(round=-1)
    error, factor, seconds = (float(last[f"round_{name}"]) for name in ("error", "error_factor", "cpu_seconds"))
    sure = "" if isnan(error) else f" ({error:.2%}, and with 90 % probability below {error * factor:.2%})"
    say("until", f"{dataset.attrs['until'].split('=')[0]} to {target:.2%}: {dataset.attrs['ended']}{sure}")
    if not isnan(error):  # which falls with the square root of time
        say("price", f"the next digit, {error / 10:.2%}, takes about {duration(100 * seconds)} of processor time")
