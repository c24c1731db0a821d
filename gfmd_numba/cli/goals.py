"""The error that a campaign was meant to have, and the one it has."""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING

from gfmd_numba.cli.sentences import say
from gfmd_numba.cli.tables import duration, show_target

if TYPE_CHECKING:
    import xarray as xr

_OF_A_ROUND = ("error", "error_factor", "predicted_error", "cpu_seconds")


def show_goal(dataset: xr.Dataset, fitted: xr.Dataset) -> None:
    """Print what a campaign has reached of its target, round by round if it ran until then; nothing without one."""
    if "round" in dataset.dims:
        _show_rounds(dataset, fitted)
    elif "target" in dataset.attrs:
        show_target(fitted, dataset.attrs["target"])


def _show_rounds(dataset: xr.Dataset, fitted: xr.Dataset) -> None:
    for number in dataset["round"].values.tolist():
        one = {name: float(dataset[f"round_{name}"].sel(round=number)) for name in _OF_A_ROUND}
        found = said_of_error(one["error"], one["error_factor"])
        asked = f"{one['predicted_error']:.2%} expected"
        if isnan(one["predicted_error"]):
            asked = "finer levels" if number else "the pilot"
        seconds = one["cpu_seconds"]
        spent = "not finished" if isnan(seconds) else f"{duration(seconds)} of processor time for the contacts so far"
        say("round", f"{number}: {found}, {asked}; {spent}")
    say("until", f"{dataset.attrs['until'].split('=')[0]} to {dataset.attrs['target']:.2%}: {dataset.attrs['ended']}")
    if isnan(one["error"]) or isnan(seconds):
        return
    left, digit = _left_open(fitted), one["error"] / 10
    if left < digit:  # the rest of the error falls with the square root of time
        price = f"takes about {duration(100 * seconds)} of processor time for the contacts"
    else:
        price = f"needs finer levels, as the distance beyond these leaves {100 * left:.2g} % open"
    say("price", f"the next digit, {digit:.2%}, {price}")


def said_of_error(error: float, factor: float) -> str:
    """Return the error after a round, and what it does not exceed with 90 % probability; nan: none is known."""
    if isnan(error):
        return "without an error"
    return f"error {error:.2%} (with 90 % probability below {error * factor:.2%})"


def _left_open(fitted: xr.Dataset) -> float:
    """Return the largest relative error of a limit that its levels leave, however many surfaces there are."""
    from gfmd_numba.analysis.fit_dataset import in_the_limit

    open_parts = fitted["error_budget"].sel(source=["extrapolation", "rivals"]).fillna(0.0)
    return float(((open_parts**2).sum("source") ** 0.5 / abs(in_the_limit(fitted)[0])).max())
