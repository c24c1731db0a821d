"""Picture of one surface: heights, spectrum, autocorrelation and height distribution with those of theory."""

from typing import Annotated

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import gammaincinv

from gfmd_numba.analysis.forms import SURFACE
from gfmd_numba.analysis.plots import style
from gfmd_numba.analysis.plots.map_image import draw_image
from gfmd_numba.analysis.plots.style import COLOURS, Width, drawn, scaled
from gfmd_numba.arrays import Reals


@drawn
def plot_surface(dataset: Annotated[xr.Dataset, SURFACE], width: Width | None = None) -> Figure:
    """Draw a surface of `gfmd surface` in four panels, each with the curve of theory where the dataset has one."""
    with style.sheet(4, 2, (5.0, 3.6), width) as (figure, axes):
        heights, spectrum, correlation, distribution = axes
        h = scaled(dataset["height"], "Height $h$", "L_x")
        style.by_nodes(dataset, _draw_line, draw_image)(heights, dataset, *h)
        _draw_spectrum(spectrum, dataset)
        distance, label = scaled(dataset["distance"], r"Distance $\rho$", "L_x")
        correlation.axhline(0.0, color="0.8", lw=0.8)
        correlation.plot(distance, dataset["autocorrelation"], color=COLOURS[0])
        if "autocorrelation_theory" in dataset:
            correlation.plot(distance, dataset["autocorrelation_theory"], "--", color=COLOURS[1])
        correlation.set(xlabel=label, ylabel=r"Autocorrelation $R(\rho)$", xlim=(0.0, distance[-1]))
        level = dataset["level"].values
        distribution.stairs(dataset["height_density"], style.edges(level), color=COLOURS[0], fill=True, alpha=0.35)
        distribution.plot(level, dataset["height_density_gaussian"], "--", color=COLOURS[1])
        distribution.set(xlabel="Height $h/w$", ylabel="Density $p(h)\\,w$", xlim=(-4.5, 4.5))
        style.add_legend(figure, spectrum.get_legend_handles_labels()[0], 3)
    return figure


def _draw_line(axis: Axes, dataset: xr.Dataset, heights: Reals, label: str) -> None:
    x, x_label = scaled(dataset["x"], "Position $x$", "L_x")
    axis.plot(x, heights, color="0.25", lw=0.8)
    axis.set(xlabel=x_label, ylabel=label, xlim=(x[0], x[-1]))


def _draw_spectrum(axis: Axes, dataset: xr.Dataset) -> None:
    per_length, unit = style.prefix(dataset["x"], "L_x")
    q, density = dataset["wavenumber"].values / per_length, dataset["spectral_density"].values
    inside = density > 1e-14 * density.max()
    # the mean power of n independent waves is distributed as chi^2 with 2 n degrees of freedom
    waves, mean = dataset["waves"].values[inside], density[inside]
    low, high = (mean * waves / gammaincinv(waves, quantile) for quantile in (0.84, 0.16))
    bars = np.maximum([mean - low, high - mean], 0.0)
    axis.errorbar(
        q[inside], mean, bars, fmt="o", color=COLOURS[0], label="surface, with the 68 % range of its ensemble"
    )
    if "spectral_density_theory" in dataset:
        theory = dataset["spectral_density_theory"].values
        drawn = theory > 1e-14 * theory.max()
        axis.plot(q[drawn], theory[drawn], "--", color=COLOURS[1], label="theory")
    density_unit = dataset["spectral_density"].attrs.get("units", "1")
    density_label = f" (m$^{{{density_unit[1:]}}}$)" if density_unit != "1" else ""
    axis.set(xscale="log", yscale="log", xlabel=f"Wave number $q$ (1/{unit})", ylabel="$C(q)$" + density_label)
    for each in (axis.xaxis, axis.yaxis):
        style.log_ticks(each)
