"""Values on the nodes of a map as an image with its colours explained."""

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LogNorm
from matplotlib.ticker import AutoLocator, MaxNLocator

from gfmd_numba.analysis.plots.style import scaled
from gfmd_numba.arrays import Reals

_TICKS = 5
_DECADES = 1e-3  # of the largest value, which logarithmic colours still tell
_SHARE = 0.98  # of the values above 0 that colours tell apart


def draw_image(
    axis: Axes, dataset: xr.Dataset, values: Reals, label: str, extend: str = "neither", **look: Any
) -> Colorbar:
    """Draw values `[y, x]` over the positions of a dataset; `look` is told to matplotlib's imshow."""
    (x, x_label), (y, y_label) = (scaled(dataset[dim], f"Position ${dim}$", "L_x") for dim in ("x", "y"))
    extent = (0.0, x[-1] + x[1], 0.0, y[-1] + y[1])
    image = axis.imshow(values, origin="lower", extent=extent, interpolation="none", **look)
    axis.set(xlabel=x_label, ylabel=y_label)
    bar = axis.figure.colorbar(image, ax=axis, label=label, extend=extend, location="top", shrink=0.9)
    if isinstance(bar.locator, AutoLocator):
        bar.locator = MaxNLocator(_TICKS)  # so few that long numbers have room
    return bar


def draw_pressure(axis: Axes, dataset: xr.Dataset) -> None:
    """Draw the pressure on the surface of a dataset: white where there is none, and colours from 0 or the tension."""
    values, label = scaled(dataset["pressure"], "Pressure $p$", "E^*")
    colours = mpl.colormaps["inferno_r"].with_extremes(bad="white")
    tension = most(-values) or 0.0
    shown, extend = np.where(values != 0.0, values, np.nan), "both" if tension else "max"
    draw_image(axis, dataset, shown, label, extend, cmap=colours, vmin=-tension, vmax=most(values))


def decades(values: Reals) -> LogNorm | None:
    """Logarithmic colours that tell three decades of the values above 0 apart; None without any."""
    largest = most(values)
    return None if largest is None else LogNorm(_DECADES * largest, largest, clip=True)


def most(values: Reals) -> float | None:
    """Value that nearly all of those above 0 do not exceed; None without any above 0."""
    return float(np.quantile(values[values > 0.0], _SHARE)) if (values > 0.0).any() else None
