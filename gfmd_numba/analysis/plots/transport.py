"""Pictures of what crosses a contact: the flow through its gap, and the current through its spots."""

from typing import Annotated

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.forms import CONDUCTANCE, LEAKAGE
from gfmd_numba.analysis.plots.map_image import decades, draw_image, most
from gfmd_numba.analysis.plots.style import COLOURS, STYLE, named_last_step, scaled


@checked
def plot_leakage(dataset: Annotated[xr.Dataset, LEAKAGE]) -> Figure:
    """Draw the flow of `leakage` through each node, a panel for each direction, of a path that of the last step."""
    last = dataset.isel(step=-1) if "step" in dataset.dims else dataset
    with mpl.rc_context(STYLE):
        figure = Figure((11.0, 5.6), dpi=150, layout="constrained")
        for axis, along in zip(figure.subplots(1, 2), ("x", "y"), strict=True):
            flow = last["local_flow"].sel(direction=along).values
            label = f"Flow along ${along}$ over its mean, none in grey" if flow.any() else f"No flow along ${along}$"
            colours = mpl.colormaps["Blues"].with_extremes(bad="0.85")
            draw_image(axis, last, np.where(flow > 0.0, flow, np.nan), label, "both", cmap=colours, norm=decades(flow))
        _name_step(figure, dataset)
    return figure


@checked
def plot_conductance(dataset: Annotated[xr.Dataset, CONDUCTANCE]) -> Figure:
    """Draw the current of `contact_conductance` through each node, of a path that of the last step."""
    last = dataset.isel(step=-1) if "step" in dataset.dims else dataset
    label, current = "Current over its mean", last["current_density"].values
    with mpl.rc_context(STYLE):
        if "y" in last.dims:
            figure = Figure((6.0, 5.6), dpi=150, layout="constrained")
            colours = mpl.colormaps["inferno_r"].with_extremes(bad="white")
            shown = np.where(current > 0.0, current, np.nan)
            draw_image(figure.subplots(), last, shown, label, "max", cmap=colours, vmin=0.0, vmax=most(current))
        else:
            figure = Figure((9.0, 3.6), dpi=150, layout="constrained")
            axis, (x, x_label) = figure.subplots(), scaled(last["x"], "Position $x$", "L_x")
            axis.fill_between(x, current, color=COLOURS[1], alpha=0.35, lw=0)
            axis.plot(x, current, color=COLOURS[1], lw=0.9)
            axis.set(xlabel=x_label, ylabel=label, xlim=(x[0], x[-1]), ylim=(0.0, None))
        _name_step(figure, dataset)
    return figure


def _name_step(figure: Figure, dataset: xr.Dataset) -> None:
    if "step" in dataset.dims:
        figure.suptitle(named_last_step(dataset), fontsize=11, x=0.01, ha="left")
