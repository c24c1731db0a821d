"""Pictures of what crosses a contact: the flow through its gap, and the current through its spots."""

from typing import Annotated

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.forms import CONDUCTANCE, LEAKAGE
from gfmd_numba.analysis.plots.map_image import OF_MAPS, decades, draw_image, enlarge_peak, most, panel_of
from gfmd_numba.analysis.plots.style import COLOURS, Width, named_last_step, scaled, sheet


@checked
def plot_leakage(dataset: Annotated[xr.Dataset, LEAKAGE], width: Width | None = None) -> Figure:
    """Draw the flow of `leakage` through each node, a panel for each direction, of a path that of the last step."""
    title, last = named_last_step(dataset), dataset.isel(step=-1) if "step" in dataset.dims else dataset
    with sheet(2, 2, panel_of(last, 4.4), width, title=title, **OF_MAPS) as (figure, axes):
        for axis, along in zip(axes, ("x", "y"), strict=True):
            flow = last["local_flow"].sel(direction=along).values
            label = f"Flow along ${along}$ over its mean, none in grey" if flow.any() else f"No flow along ${along}$"
            colours = mpl.colormaps["Blues"].with_extremes(bad="0.85")
            draw_image(axis, last, np.where(flow > 0.0, flow, np.nan), label, "both", cmap=colours, norm=decades(flow))
    return figure


@checked
def plot_conductance(dataset: Annotated[xr.Dataset, CONDUCTANCE], width: Width | None = None) -> Figure:
    """Draw the current of `contact_conductance` through each node, of a path that of the last step."""
    title, last = named_last_step(dataset), dataset.isel(step=-1) if "step" in dataset.dims else dataset
    label, current = "Current over its mean", last["current_density"].values
    is_map = "y" in last.dims
    with sheet(1, 1, panel_of(last, 5.6) if is_map else (9.0, 3.6), width, title=title) as (figure, (axis,)):
        if is_map:
            colours = mpl.colormaps["inferno_r"].with_extremes(bad="white")
            shown = np.where(current > 0.0, current, np.nan)
            draw_image(axis, last, shown, label, "max", cmap=colours, vmin=0.0, vmax=most(current))
            enlarge_peak(axis, shown)
        else:
            x, x_label = scaled(last["x"], "Position $x$", "L_x")
            axis.fill_between(x, current, color=COLOURS[1], alpha=0.35, lw=0)
            axis.plot(x, current, color=COLOURS[1], lw=0.9)
            axis.set(xlabel=x_label, ylabel=label, xlim=(x[0], x[-1]), ylim=(0.0, None))
    return figure
