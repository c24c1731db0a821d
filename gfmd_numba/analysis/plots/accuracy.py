"""Work-precision diagrams: what accuracy costs in time."""

from itertools import cycle
from typing import Annotated

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from gfmd_numba.analysis.forms import ACCURACY
from gfmd_numba.analysis.plots.style import MARKERS, Width, drawn, log_ticks, ordered_colours, sheet, small, symbol

TITLES = {
    "solver residual": "Solver and residual",
    "damping of Verlet": "Damping and time step of Verlet",
    "eps_c": r"Continuum: $1/\varepsilon_c$",
    "eps_f": r"Fractal: $1/\varepsilon_f$",
    "eps_t": r"Thermodynamic: $1/\varepsilon_t$",
    "surfaces": "Number of surfaces",
    "load steps": "Parts of each step of the path",
    "topography order": "Order in the slope of rough bodies",
}
_EQUAL = {"solver residual": 1e-10, "topography order": 1e-16}  # errors below are drawn there
_AS_THEY_ARE = {"surfaces", "load steps", "topography order"}  # settings next to the points, and those of one over eps:
_WRITTEN = {"eps_c", "eps_f", "eps_t"} | _AS_THEY_ARE
_OF_PATHS = {"hysteresis": "hysteresis_error", "pull-off pressure": "pull_off_pressure_error"}
_YLABELS = {
    "damping of Verlet": "Processor time (s)",
    "load steps": "Relative error",
    "topography order": "Displacement by the next order over $L_x$",
}
_COLUMNS = 3
_LABELS = 3.4  # heights of notes that labels take below a panel


@drawn
def plot_accuracy(dataset: Annotated[xr.Dataset, ACCURACY], width: Width | None = None) -> Figure:
    """Draw error in kappa against seconds for each study of `gfmd accuracy`; settings stand next to the points.

    Settings with failed surfaces are left out. Raises UnusableDataError for a dataset without studies.
    """
    good = dataset.isel(point=dataset["failed"].values == 0)
    studies = {name: _drawn(good.isel(point=good["study"].values == name), name) for name in TITLES}
    shown = {name: study for name, study in studies.items() if study.sizes["point"]}
    with sheet(len(shown), _COLUMNS, (4.3, 4.4), width) as (figure, axes):
        for axis, (name, study) in zip(axes, shown.items(), strict=True):
            _draw(axis, name, study)
    return figure


def _draw(axis: Axes, name: str, study: xr.Dataset) -> None:
    curves = dict.fromkeys(study["curve"].values.tolist())
    for curve, colour, marker in zip(curves, ordered_colours(len(curves)), cycle(MARKERS), strict=False):
        points = study.isel(point=study["curve"].values == curve)
        x, y = points["seconds"].values, np.maximum(np.abs(points["error"].values), _EQUAL.get(name, 1e-5))
        x, y = (points["setting"].values, x) if name == "damping of Verlet" else (x, y)
        axis.plot(x, y, marker=marker, color=colour, label=curve)
        for at, height, setting in zip(x, y, points["setting"].values, strict=True) if name in _WRITTEN else ():
            written = f"{setting:g}" if name in _AS_THEY_ARE else f"{1 / setting:g}"
            axis.annotate(written, (at, height), textcoords="offset points", xytext=(4, 4), fontsize=small())
    axis.set(xscale="log", yscale="log", title=TITLES[name])
    axis.set_xlabel("Damping over critical damping" if name == "damping of Verlet" else "Processor time (s)")
    axis.set_ylabel(_YLABELS.get(name, f"Relative error of {_symbol(study)}"))
    axis.margins(x=0.12, y=0.12)
    for each in (axis.xaxis, axis.yaxis):
        log_ticks(each)
    axis.grid()
    below = ScaledTranslation(0.0, -_LABELS * small() / 72.0, axis.figure.dpi_scale_trans)
    place = {"bbox_to_anchor": (0.5, 0.0), "bbox_transform": axis.transAxes + below}
    axis.legend(fontsize=small(), loc="upper center", ncols=2, **place)


def _drawn(study: xr.Dataset, name: str) -> xr.Dataset:
    """Points of a study whose error is known; a curve for each measure where a path's steps are divided."""
    if name == "load steps":
        errors = {_symbol(study): "error"} | {label: each for label, each in _OF_PATHS.items() if each in study}
        points = study.sizes["point"]
        parts = [study.assign(curve=("point", [label] * points), error=study[each]) for label, each in errors.items()]
        study = xr.concat(parts, "point")
    if name == "topography order" and "next_order" in study:
        study = study.assign(error=study["next_order"])
    return study.isel(point=np.isfinite(study["error"].values))


def _symbol(study: xr.Dataset) -> str:
    """What the errors of a study are about."""
    return symbol(str(study["variable"].values[0]) if "variable" in study and study.sizes["point"] else "kappa")
