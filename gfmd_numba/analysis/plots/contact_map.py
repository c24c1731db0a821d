"""Picture of the contact of a map: heights, pressure and gap, and their distributions below."""

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from gfmd_numba.analysis.contact_statistics import contact_statistics
from gfmd_numba.analysis.plots.cohesion_map import draw_cohesion
from gfmd_numba.analysis.plots.friction_map import draw_friction
from gfmd_numba.analysis.plots.map_image import draw_image, draw_pressure, most
from gfmd_numba.analysis.plots.statistics import draw_statistics
from gfmd_numba.analysis.plots.style import STYLE, scaled
from gfmd_numba.analysis.selection import UnusableDataError
from gfmd_numba.arrays import Flags

_CONTACT = "#E69F00"  # of touching nodes among the gaps, which are blue
_LEAST_PATCH = 6.0  # nodes across, below which an outline would hide what it surrounds
_DECADES = 1e-3  # of the gaps that they tell apart


def plot_map(dataset: xr.Dataset) -> Figure:
    """Draw the contact of a map in its units, tangential tractions if it has any, and statistics where they are known.

    Outlines surround the contact where its clusters are large enough for it. Gaps have logarithmic colours and
    touching nodes one of their own, so that a small gap is told from none.
    """
    try:
        statistics = contact_statistics(dataset)
    except UnusableDataError:  # a run that is not ok, or a part of a map
        statistics = None
    touching = dataset["gap"].values == 0.0
    with mpl.rc_context(STYLE):
        drags = "tangential_traction_y" in dataset
        rows = 1 + drags + (statistics is not None)
        figure = Figure((14.0, 1.0 + 4.2 * rows), dpi=150, layout="constrained")
        maps = figure.add_gridspec(rows, 3)
        heights, pressure, gap = (figure.add_subplot(maps[0, i]) for i in range(3))
        punch = dataset["height"] if "height" in dataset else dataset["displacement"] + dataset["gap"]
        of = "both surfaces together" if "body_height" in dataset else "the punch"
        values, label = scaled(punch, f"Height of {of}", "L_x")
        draw_image(heights, dataset, values, label, cmap="cividis")
        draw_pressure(pressure, dataset)
        _outline(pressure, dataset, touching)
        _draw_gap(gap, dataset, touching)
        if drags:
            draw = draw_friction if "slip" in dataset else draw_cohesion
            draw([figure.add_subplot(maps[1, i]) for i in range(3)], dataset)
        if statistics is not None:
            draw_statistics([figure.add_subplot(maps[rows - 1, i]) for i in range(3)], statistics)
    return figure


def _outline(axis: Axes, dataset: xr.Dataset, touching: Flags) -> None:
    """Surround the contact where its clusters are large enough for it."""
    sides = sum(np.count_nonzero(touching != np.roll(touching, 1, axis=i)) for i in (0, 1))
    if sides and 4.0 * touching.sum() / sides >= _LEAST_PATCH:
        (x, _), (y, _) = (scaled(dataset[dim], "", "") for dim in ("x", "y"))
        axis.contour(x + 0.5 * x[1], y + 0.5 * y[1], touching, [0.5], colors="0.1", linewidths=0.5)


def _draw_gap(axis: Axes, dataset: xr.Dataset, touching: Flags) -> None:
    values, label = scaled(dataset["gap"], "Gap", "L_x")
    colours = mpl.colormaps["Blues"].with_extremes(bad=_CONTACT)
    largest = most(values)
    norm = None if largest is None else LogNorm(_DECADES * largest, largest, clip=True)
    draw_image(
        axis,
        dataset,
        np.where(touching, np.nan, values),
        f"{label}, contact in orange",
        "both",
        cmap=colours,
        norm=norm,
    )
