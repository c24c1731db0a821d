"""A campaign along a loading path as campaigns under one load: one for each step, or one for the path as a whole."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from gfmd_numba.analysis.facts_of_cases import PATH_LOAD
from gfmd_numba.analysis.forms import UnusableDataError
from gfmd_numba.text.input_error import brief

_PATH_STEP = {
    "long_name": "step of the path, from the first loading",
    "units": "1",
    "symbol": "step",
    "label": "step of the path",
    "axis": "physics",
    "rank": 1000,  # the last of all
}


def steps_of(dataset: xr.Dataset, variable: str, step: int | None = None) -> list[xr.Dataset]:
    """Datasets `(case, realisation)` in which a variable of a path stands: one for each step, told by `path_step`.

    With `step` that one alone. What is known of the path as a whole stands once, with the contact of the step with
    the largest area. A dataset without a path stands for itself. UnusableDataError for a step that there is not.
    """
    along = {"case", "step"} <= set(dataset.dims)
    at_steps = along and variable in dataset and "step" in dataset[variable].dims
    if step is not None and not (at_steps and type(step) is int and 0 <= step < dataset.sizes["step"]):
        steps = f"a step from 0 to {dataset.sizes['step'] - 1}" if at_steps else f"nothing, as {variable} has no steps"
        raise UnusableDataError(f"step: you gave {brief(step)}; gfmd allows {steps}")
    if not along:
        return [dataset]
    if at_steps:
        return [_at(dataset, each) for each in (range(dataset.sizes["step"]) if step is None else [step])]
    largest = 0
    if "contact_area_fraction" in dataset:
        area = dataset["contact_area_fraction"]
        area = area.mean(set(area.dims) - {"step"})
        largest = int(np.nan_to_num(area).argmax())
    return [_at(dataset, largest).drop_vars("path_step")]


def joined(fits: Sequence[xr.Dataset]) -> xr.Dataset:
    """Return one fit with the groups of several."""
    whole = xr.concat(
        fits,
        "group",
        data_vars="minimal",
        coords="minimal",
        compat="override",
        join="override",
        combine_attrs="override",
    )
    return whole.assign_coords(group=("group", np.arange(whole.sizes["group"]), fits[0]["group"].attrs))


def _at(dataset: xr.Dataset, step: int) -> xr.Dataset:
    one = dataset.isel(step=step).drop_vars("step", errors="ignore")
    if {"step_load", "reduced_pressure"} <= set(dataset.variables):  # which is that of the first load
        first = dataset["step_load"].isel(step=0).values
        share = np.divide(one["step_load"].values, first, out=np.full(len(first), np.nan), where=first != 0.0)
        one = one.assign_coords({PATH_LOAD: ("case", one["reduced_pressure"].values * share)})
    return one.assign_coords(path_step=("case", np.full(one.sizes["case"], step), _PATH_STEP))
