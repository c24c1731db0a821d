"""The error that a campaign was meant to have, and the one it has."""

from __future__ import annotations

from math import isnan, nan
from typing import TYPE_CHECKING

from gfmd_numba.cli.sentences import say
from gfmd_numba.cli.tables import duration, show_target

if TYPE_CHECKING:
    import xarray as xr


def show_goal(dataset: xr.Dataset, fitted: xr.Dataset) -> None:
    """Print what a campaign has reached of its target, round by round if it ran until then; nothing without one."""
    from gfmd_numba.analysis.arguments import targets_of

    targets = targets_of(dataset)
    if "round" in dataset.dims:
        _show_rounds(dataset, fitted, targets)
    elif fitted.attrs["variable"] in targets:
        show_target(fitted, targets[fitted.attrs["variable"]])
    if others := [name for name in targets if name != fitted.attrs["variable"]]:
        say("note", f"`gfmd fit --variable NAME` shows the limit of {' or '.join(others)}")


def _show_rounds(dataset: xr.Dataset, fitted: xr.Dataset, targets: dict[str, float]) -> None:
    known = {name: dataset.sel(target=name) if "target" in dataset.dims else dataset for name in targets}
    for number in dataset["round"].values.tolist():
        errors, asked = [], "finer levels" if number else "the pilot"
        for name, of_target in known.items():
            one = of_target.sel(round=number)
            found = said_of_error(float(one["round_error"]), float(one["round_error_factor"]))
            errors.append(f"{name} {found}" if len(targets) > 1 else found)
            if not isnan(expected := float(one["round_predicted_error"])):
                asked = f"{expected:.2%}{f' of {name}' if len(targets) > 1 else ''} expected"
        seconds = float(dataset["round_cpu_seconds"].sel(round=number))
        spent = "not finished" if isnan(seconds) else f"{duration(seconds)} of processor time for the contacts so far"
        say("round", f"{number}: {', '.join(errors)}, {asked}; {spent}")
    reached = dataset.attrs.get("reached", "").split(", ")
    for name, target in targets.items():
        say("until", f"{name} to {target:.2%}: {'reached' if name in reached else dataset.attrs['ended']}")
    of_fitted = known.get(fitted.attrs["variable"])
    error = nan if of_fitted is None else float(of_fitted["round_error"][-1])
    if isnan(error) or isnan(seconds):
        return
    left, digit = _left_open(fitted), error / 10
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
