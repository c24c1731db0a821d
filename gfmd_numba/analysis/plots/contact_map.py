"""Picture of the contact of a map: heights, pressure and gap, and their distributions below."""

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from gfmd_numba.analysis.contact_statistics import contact_statistics
from gfmd_numba.analysis.plots.statistics import draw_statistics
from gfmd_numba.analysis.plots.style import STYLE, scaled
from gfmd_numba.analysis.selection import UnusableDataError
from gfmd_numba.arrays import Flags, Reals

_CONTACT = "#E69F00"  # of touching nodes among the gaps, which are blue
_LEAST_PATCH = 6.0  # nodes across, below which an outline would hide what it surrounds
_SHARE = 0.98  # of the values above 0 that colours tell apart
_DECADES = 1e-3  # of the gaps that they tell apart


def plot_map(dataset: xr.Dataset) -> Figure:
    """Draw the contact of a map in its units, and its statistics where they are known.

    Outlines surround the contact where its clusters are large enough for it. Gaps have logarithmic colours and
    touching nodes one of their own, so that a small gap is told from none.
    """
    try:
        statistics = contact_statistics(dataset)
    except UnusableDataError:  # a run that is not ok, or a part of a map
        statistics = None
    touching = dataset["gap"].values == 0.0
    with mpl.rc_context(STYLE):
        rows = 1 if statistics is None else 2
        figure = Figure((14.0, 1.0 + 4.2 * rows), dpi=150, layout="constrained")
        maps = figure.add_gridspec(rows, 3)
        heights, pressure, gap = (figure.add_subplot(maps[0, i]) for i in range(3))
        punch = dataset["height"] if "height" in dataset else dataset["displacement"] + dataset["gap"]
        values, label = scaled(punch, "Height of the punch", "L_x")
        _draw(heights, dataset, values, label, cmap="cividis")
        _draw_pressure(pressure, dataset, touching)
        _draw_gap(gap, dataset, touching)
        if statistics is not None:
            draw_statistics([figure.add_subplot(maps[1, i]) for i in range(3)], statistics)
    return figure


def _draw(axis: Axes, dataset: xr.Dataset, values: Reals, label: str, extend: str = "neither", **look: Any) -> None:
    (x, x_label), (y, y_label) = (scaled(dataset[dim], f"Position ${dim}$", "L_x") for dim in ("x", "y"))
    extent = (0.0, x[-1] + x[1], 0.0, y[-1] + y[1])
    image = axis.imshow(values, origin="lower", extent=extent, interpolation="none", **look)
    axis.figure.colorbar(image, ax=axis, label=label, extend=extend, location="top", shrink=0.9)
    axis.set(xlabel=x_label, ylabel=y_label)


def _draw_pressure(axis: Axes, dataset: xr.Dataset, touching: Flags) -> None:
    values, label = scaled(dataset["pressure"], "Pressure $p$", "E^*")
    colours = mpl.colormaps["inferno_r"].with_extremes(bad="white")
    shown = np.where(values != 0.0, values, np.nan)
    lowest = -(_most(-values) or 0.0)  # adhesion pulls
    _draw(axis, dataset, shown, label, "max", cmap=colours, vmin=lowest, vmax=_most(values))
    sides = sum(np.count_nonzero(touching != np.roll(touching, 1, axis=i)) for i in (0, 1))
    if sides and 4.0 * touching.sum() / sides >= _LEAST_PATCH:
        (x, _), (y, _) = (scaled(dataset[dim], "", "") for dim in ("x", "y"))
        axis.contour(x + 0.5 * x[1], y + 0.5 * y[1], touching, [0.5], colors="0.1", linewidths=0.5)


def _draw_gap(axis: Axes, dataset: xr.Dataset, touching: Flags) -> None:
    values, label = scaled(dataset["gap"], "Gap", "L_x")
    colours = mpl.colormaps["Blues"].with_extremes(bad=_CONTACT)
    most = _most(values)
    norm = None if most is None else LogNorm(_DECADES * most, most, clip=True)
    _draw(
        axis,
        dataset,
        np.where(touching, np.nan, values),
        f"{label}, contact in orange",
        "both",
        cmap=colours,
        norm=norm,
    )


def _most(values: Reals) -> float | None:
    """Value that nearly all of those above 0 do not exceed."""
    return float(np.quantile(values[values > 0.0], _SHARE)) if (values > 0.0).any() else None
