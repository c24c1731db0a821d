"""Figures of curves: area, mean gap and peak pressure over the load, the time or the sliding speed."""

from typing import Annotated

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.forms import CREEP, CURVE, FRICTION, UnusableDataError
from gfmd_numba.analysis.plots.style import COLOURS, Width, last_rows, log_ticks, prefix, sheet
from gfmd_numba.arrays import Reals
from gfmd_numba.text.numbers import typical

_PANELS = (  # variable, label, unit where the scene leaves E* or L_x open, whether it is drawn on a logarithmic axis
    ("contact_area_fraction", "Contact area fraction", "", True),
    ("mean_gap", r"Mean gap $\bar{u}$", "L_x", False),
    ("contact_stiffness", r"Stiffness $-d\bar{p}\,/\,d\bar{u}$", "E^*/L_x", True),
    ("peak_pressure", "Peak pressure", "E^*", True),
)
_OF_FORM = (  # without a period
    ("contact_radius", "Contact radius", "L_x", True),
    ("approach", "Approach", "L_x", True),
    ("contact_stiffness", r"Stiffness $d\bar{p}\,/\,d$approach", "E^*/L_x", True),
    _PANELS[3],
)
_LOADS = {"displacement": ("Punch displacement", "L_x"), "force": ("Force", ""), "line_load": ("Line load", "")}
_OVER_SPEED = (
    ("hysteretic_friction", "Friction by hysteresis", "", False),
    _PANELS[0],
    _PANELS[1],
    _PANELS[3],
)
_IN_TIME = (*_PANELS[:2], ("n_segments", "Separate contacts", "", False), _PANELS[3])


@checked
def plot_curve(dataset: Annotated[xr.Dataset, CURVE], width: Width | None = None) -> Figure:
    """Draw a load curve of `gfmd curve` over the mean pressure, or the displacement or force that was prescribed.

    Loads that are not ok are left out. Bands are standard errors over realisations. Raises UnusableDataError for a
    dataset that is no load curve, or has no load with a result.
    """
    panels = _OF_FORM if {"contact_radius", "approach"} <= dataset.variables.keys() else _PANELS
    label = _LOADS.get(dataset.attrs.get("prescribed", ""))
    if label is not None:
        return _drawn(dataset, "prescribed_load", "prescribed_load", label, panels, width)
    return _drawn(dataset, "prescribed_load", "mean_pressure", (r"Mean pressure $\bar{p}$", "E^*"), panels, width)


@checked
def plot_creep(dataset: Annotated[xr.Dataset, CREEP], width: Width | None = None) -> Figure:
    """Draw a creep curve of `gfmd curve --times` over the time.

    Times that are not ok are left out. Bands are standard errors over realisations. Raises UnusableDataError for a
    dataset that is no creep curve, or has no time with a result.
    """
    return _drawn(dataset, "time", "time", ("Time", ""), _IN_TIME, width)


@checked
def plot_friction(dataset: Annotated[xr.Dataset, FRICTION], width: Width | None = None) -> Figure:
    """Draw a friction curve of `gfmd curve --speeds` over the speed.

    Speeds that are not ok are left out. Bands are standard errors over realisations. Raises UnusableDataError for a
    dataset that is no friction curve, or has no speed with a result.
    """
    return _drawn(dataset, "speed", "speed", ("Sliding speed", "L_x"), _OVER_SPEED, width)


def _drawn(
    dataset: xr.Dataset,
    dim: str,
    variable: str,
    label: tuple[str, str],
    panels: tuple[tuple[str, str, str, bool], ...],
    width: Width | None,
) -> Figure:
    """Draw a curve along a dim where it has results, over a variable with a label and a unit for scenes without."""
    dataset = dataset.isel({dim: dataset["n_realisations"].values > 0})
    if not dataset.sizes[dim]:
        what = dim.removeprefix("prescribed_")
        raise UnusableDataError(f"you gave no {what} with a result; gfmd allows a curve with runs that are ok")
    over = dataset[variable]
    factor, unit = prefix(over, label[1], typical)
    counts = dataset["n_realisations"]
    least, most = int(counts.min()), int(counts.max())
    surfaces = f"{most}" if least == most else f"{least} to {most}"
    title = f"Mean of {surfaces} surfaces, band: standard error" if most > 1 else ""
    with sheet(len(panels), 2, (4.8, 3.2), width, title=title, sharex=True) as (figure, axes):
        for axis, (name, text, free, logarithmic) in zip(axes, panels, strict=True):
            drawn = _draw(axis, dataset, name, text, free, factor * over.values)
            if logarithmic and drawn.size and drawn.min() > 0.0:
                axis.set_yscale("log")
                log_ticks(axis.yaxis)
            if (over > 0).all() and float(over.max()) > 10.0 * float(over.min()):
                axis.set_xscale("log")
                log_ticks(axis.xaxis)
        for axis in last_rows(axes):
            axis.set_xlabel(f"{label[0]} ({unit})")
    return figure


def _per_gap(dataset: xr.Dataset, unit: str) -> str:
    """Unit of a stiffness, with E* or L_x where the scene leaves but one of them open."""
    pressure, gap = (dataset[name].attrs.get("units", "1") for name in ("mean_pressure", "mean_gap"))
    if pressure != "1" and gap == "1":
        return f"{unit}$/L_x$"
    return "$E^*$/m" if pressure == "1" and gap != "1" else unit


def _draw(axis: Axes, dataset: xr.Dataset, name: str, text: str, natural: str, x: Reals) -> Reals:
    """Draw one variable with its error; gives the values that are drawn."""
    known = np.isfinite(dataset[name].values)  # full contact is infinitely stiff
    finite = dataset[name][known]
    factor, unit = prefix(finite, natural, typical) if finite.size and natural else (1.0, "")
    values = factor * finite.values
    axis.plot(x[known], values, "o-", color=COLOURS[0])
    if f"{name}_standard_error" in dataset:
        error = factor * dataset[f"{name}_standard_error"].values[known]
        axis.fill_between(x[known], values - error, values + error, color=COLOURS[0], alpha=0.25, lw=0)
    if name == "contact_stiffness":
        unit = _per_gap(dataset, unit)
    axis.set_ylabel(f"{text} ({unit})" if unit else text)
    axis.grid()
    return values
