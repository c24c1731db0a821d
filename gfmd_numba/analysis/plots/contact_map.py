"""Picture of the contact of a map: heights, pressure and gap, and their distributions below."""

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from gfmd_numba.analysis.contact_statistics import contact_statistics
from gfmd_numba.analysis.forms import UnusableDataError
from gfmd_numba.analysis.plots.cohesion_map import draw_cohesion
from gfmd_numba.analysis.plots.friction_map import draw_friction
from gfmd_numba.analysis.plots.map_image import draw_image, draw_pressure, most
from gfmd_numba.analysis.plots.statistics import draw_statistics
from gfmd_numba.analysis.plots.style import STYLE, scaled
from gfmd_numba.arrays import Flags

_CONTACT = "#E69F00"  # of touching nodes among the gaps, which are blue
_FLATTENED = "#D55E00"
_LEAST_PATCH = 6.0  # nodes across, below which an outline would hide what it surrounds
_DECADES = 1e-3  # of the gaps that they tell apart


def plot_map(dataset: xr.Dataset) -> Figure:
    """Draw the contact of a map in its units, tangential tractions if it has any, and statistics where they are known.

    Outlines surround the contact, and on the heights what has been flattened, where clusters are large enough for it.
    Gaps have logarithmic colours and touching nodes one of their own, so that a small gap is told from none.
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
        flat = dataset["plastic_depth"].values > 0.0 if "plastic_depth" in dataset else np.zeros_like(touching)
        told = ", flattened within lines" if _is_in_patches(flat) else ""
        draw_image(heights, dataset, values, label + told, cmap="cividis")
        _outline(heights, dataset, flat, _FLATTENED)
        draw_pressure(pressure, dataset)
        _outline(pressure, dataset, touching)
        _draw_gap(gap, dataset, touching)
        if drags:
            draw = draw_friction if "slip" in dataset else draw_cohesion
            draw([figure.add_subplot(maps[1, i]) for i in range(3)], dataset)
        if statistics is not None:
            draw_statistics([figure.add_subplot(maps[rows - 1, i]) for i in range(3)], statistics)
    return figure


def _is_in_patches(flags: Flags) -> bool:
    """Whether clusters of flags are large enough for an outline."""
    sides = sum(np.count_nonzero(flags != np.roll(flags, 1, axis=i)) for i in (0, 1))
    return bool(sides and 4.0 * flags.sum() / sides >= _LEAST_PATCH)


def _outline(axis: Axes, dataset: xr.Dataset, flags: Flags, colour: str = "0.1") -> None:
    """Surround clusters of flags where they are large enough for it."""
    if _is_in_patches(flags):
        (x, _), (y, _) = (scaled(dataset[dim], "", "") for dim in ("x", "y"))
        axis.contour(x + 0.5 * x[1], y + 0.5 * y[1], flags, [0.5], colors=colour, linewidths=0.6)


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
