"""What is told of results, whatever command wrote them: tables and lines, for the terminal and for reports."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING

from gfmd_numba.cli.arguments import LIMITS, OF_PATHS
from gfmd_numba.cli.fits import fit_options
from gfmd_numba.cli.tables import column, line, of_fit, of_goal, of_means, of_paths, readable
from gfmd_numba.cli.terminal import Line, Table, Told
from gfmd_numba.text.recorded_scene import is_form_alone

if TYPE_CHECKING:
    import xarray as xr

_WIDE = 24
_SHOWN = (  # as far as a dataset has them: a loaded body has but the last
    "force",
    "line_load",
    "mean_pressure",
    "contact_area_fraction",
    "contact_radius",
    "approach",
    "mean_gap",
    "peak_pressure",
    "n_segments",
    "elastic_energy",
    "kappa",
    "kappa_r",
    "plastic_area_fraction",
    "mean_plastic_depth",
    "mean_worn_depth",
    "mean_tangential_traction",
    "mean_tangential_traction_y",
    "stick_fraction",
    "energy_lost",
    "hysteretic_friction",
    "hysteretic_friction_error",
    "time_error",
)
_AFTER = _SHOWN.index("mean_gap") + 1  # of them a stiffness is told
_MEASURES = {  # of a solved contact: words, and the unit of a contact without units
    "contact_area_fraction_persson": ("Persson's contact area", ""),
    "mean_gap": ("mean gap over rms height", ""),
    "perimeter": ("perimeter", "L_x"),
    "gap_connects": ("channel", ""),
    "contact_connects": ("contact bridges", ""),
    "critical_gap": ("critical gap", "L_x"),
    "largest_gap_fraction": ("largest connected gap", ""),
    "largest_contact_fraction": ("largest contact cluster", ""),
    "n_gaps": ("separate gaps", ""),
    "hydraulic_gap": ("hydraulic gap", "L_x"),
    "flow_factor": ("flow factor", ""),
    "conductance": ("conductance", "1/L_x"),
}
_PRESCRIBED = (
    *("reduced_pressure", "prescribed_pressure", "line_load", "force", "punch_displacement"),
    *("sliding", "sliding_y", "speed", "time"),
)


def of_results(dataset: xr.Dataset, fitted: xr.Dataset | None) -> Told:
    """Yield what came out: of a campaign with its fit if it has limits, and of anything else without."""
    if "case" in dataset.dims:
        yield from of_campaign(dataset, fitted)
    elif "prescribed" in dataset.attrs:
        yield from of_curve(dataset)
    elif "fit_status" in dataset:
        yield from of_fit(dataset)
    elif "step" in dataset.dims and "residual" in dataset:
        yield from of_steps(dataset)
    elif "residual" in dataset:
        yield from of_contact(dataset)
    elif any(name in dataset for name in _MEASURES):
        yield from of_measures(dataset)
    else:
        yield from of_numbers(dataset)


def of_campaign(dataset: xr.Dataset, fitted: xr.Dataset | None) -> Told:
    """Yield limits and how near they are to their target; the means of paths, or of all cases, where there are none."""
    import gfmd_numba

    options = fit_options(dataset)
    if "step" in dataset.dims:
        yield from of_paths(dataset)
    elif fitted is None:
        yield from of_means(dataset, options.get("variable", "kappa"))
    if fitted is None:
        return
    shown = fitted
    if "step" in dataset.dims:
        whole = {name: value for name, value in options.items() if name != "step"}
        for variable in (name for name in OF_PATHS if name in dataset and name != fitted.attrs["variable"]):
            yield from of_fit(gfmd_numba.fit_tfc(dataset, **whole | {"variable": variable}))
        if not (fitted["fit_status"] == "ok").any() and fitted.attrs["variable"] not in OF_PATHS:  # kappa under tension
            shown = gfmd_numba.fit_tfc(dataset, **options | {"variable": "contact_area_fraction"})
    yield from of_fit(shown)
    yield from of_goal(dataset, fitted)


def has_limits(dataset: xr.Dataset) -> bool:
    """Return whether a campaign varies discretisations, so that a limit can be fitted."""
    return "limit" in dataset and bool(LIMITS.keys() & set(dataset["limit"].values))


def _of_form(dataset: xr.Dataset) -> tuple[xr.Dataset, set[str]]:
    """Return the dataset with the force on a form without roughness in a window, and what then means nothing."""
    if not is_form_alone(dataset.attrs["scene"]):
        return dataset, set()
    scene, of_roughness = json.loads(dataset.attrs["scene"])["scene"], {"reduced_pressure", "kappa", "kappa_r"}
    if scene["periodic"] is not False:
        return dataset, of_roughness
    name, si, free = {1: ("line_load", "N m-1", "E* L_x"), 2: ("force", "N", "E* L_x2")}[scene["dimension"]]
    if name not in dataset.variables:
        pressure, length = dataset["mean_pressure"], scene["length"]
        unit = si if pressure.attrs["units"] == "Pa" and length else free
        dataset = dataset.assign({name: (pressure * (length or 1.0) ** scene["dimension"]).assign_attrs(units=unit)})
    return dataset, of_roughness | {"mean_pressure"}


def of_contact(dataset: xr.Dataset) -> Told:
    """Yield what came of one loading, a line each."""
    dataset, nothing = _of_form(dataset)
    prescribed = [name for name in _PRESCRIBED if name in dataset.coords and name not in nothing]
    for name in (*prescribed, *(name for name in _SHOWN if name in dataset.data_vars and name not in nothing)):
        words, number, unit = line(dataset, name)
        yield Line(words, f"{number:<14}{unit}".rstrip(), _WIDE)
    yield Line("residual", f"{float(dataset['residual']):.1e}", _WIDE)


def of_steps(dataset: xr.Dataset) -> Told:
    """Yield the steps of a path: what was prescribed, and what came of it."""
    view, nothing = _of_form(_with_stiffness(dataset))
    prescribed = [name for name in _PRESCRIBED if name in view.coords and view[name].any() and name not in nothing]
    steps = {"step": [str(step) for step in range(dataset.sizes["step"])]}
    shown = (*_SHOWN[:_AFTER], "contact_stiffness", *_SHOWN[_AFTER:])
    found = dict(column(view, name) for name in shown if name in view.data_vars and name not in nothing)
    found["residual"] = [f"{float(residual):.1e}" for residual in dataset["residual"]]
    yield Table("steps of the path", steps | dict(column(dataset, name) for name in prescribed), found)


def _with_stiffness(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset with the stiffness since the step before, if the hard wall alone acts and the load changed."""
    interface = json.loads(dataset.attrs["scene"])["scene"]["interface"]
    if [name for name, law in interface.items() if law is not None] != ["hard_wall"]:
        return dataset
    closed = dataset["approach"] if "approach" in dataset else -dataset["mean_gap"]
    rise, fall = dataset["mean_pressure"].diff("step"), closed.diff("step")
    stiffness = (rise / fall.where((rise != 0.0) & (fall != 0.0))).reindex(step=dataset["step"])
    return dataset.assign(contact_stiffness=stiffness)


def of_curve(dataset: xr.Dataset) -> Told:
    """Yield the curve, one line a load, time or speed."""
    from gfmd_numba.simulate.curve import SHOWN

    load = prescribed(dataset)
    view, nothing = _of_form(named(dataset))
    same = nothing | ({load, "mean_pressure"} if load == "prescribed_pressure" else {load})
    shown = [name for name in ("force", "line_load", *SHOWN) if name in view and name not in same]
    values = dict(column(view, name) for name in shown)
    states = dataset["status"].attrs["flag_meanings"].split()
    if dataset["status"].any():
        values["status"] = [states[int(status)] for status in dataset["status"]]
    if int(dataset["n_realisations"].max()) > 1:
        values["surfaces"] = [str(int(count)) for count in dataset["n_realisations"]]
    heading, loads = column(view, load)
    yield Table(dataset.attrs["title"], {heading: loads}, values)


def prescribed(dataset: xr.Dataset) -> str:
    """Return the name of the variable that the loading of a curve prescribes."""
    from gfmd_numba.contact.dataset import PRESCRIBED

    given = str(dataset.attrs["prescribed"])
    return PRESCRIBED.get(given, given)


def named(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset of a curve whose load has the name of what is prescribed."""
    return dataset.assign({prescribed(dataset): dataset[over(dataset)]})


def over(dataset: xr.Dataset) -> str:
    """Return the dim of a curve."""
    return next((name for name in ("time", "speed") if name in dataset.dims), "prescribed_load")


def of_measures(dataset: xr.Dataset) -> Told:
    """Yield what was measured of a solved contact as a whole, or of each step of a path."""
    cells = {words: values for name in _MEASURES if name in dataset for words, values in _measured(dataset, name)}
    if "step" in dataset.dims:
        yield Table("steps of the path", {"step": [str(step) for step in range(dataset.sizes["step"])]}, cells)
        return
    for words, (value,) in cells.items():
        yield Line(words, value, _WIDE + 4)


def _measured(dataset: xr.Dataset, name: str) -> Iterator[tuple[str, list[str]]]:
    """Yield words and cells of a variable, for each direction if it has them."""
    words, free = _MEASURES[name]
    variable = dataset[name]
    unit = variable.attrs["units"].replace("m-1", "1/m") if variable.attrs["units"] != "1" else free
    parts = [(words, variable)]
    if "direction" in variable.dims:
        parts = [(f"{words} along {each}", variable.sel(direction=each)) for each in ("x", "y")]
    for text, part in parts:
        yield text, [_cell(name, value, unit) for value in part.values.ravel().tolist()]


def _cell(name: str, value: float, unit: str) -> str:
    if name.endswith("_connects"):
        return "yes" if value else "no"
    number, shown = readable(value, unit)
    return f"{float(number):.5g} {shown}".rstrip()


def of_numbers(dataset: xr.Dataset) -> Told:
    """Yield all single numbers of a dataset, a line each."""
    for name, variable in dataset.data_vars.items():
        if not variable.dims and variable.dtype.kind in "fiu":
            unit = variable.attrs.get("units", "1")
            free = {"rms_height": "L_x", "rms_curvature": "1/L_x"}.get(str(name), "") if unit == "1" else unit
            yield Line(str(name), " ".join(readable(float(variable), free)).rstrip(), _WIDE)
