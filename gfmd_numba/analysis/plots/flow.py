"""Figure of a body that has flown inside: pressure, residual displacement, plastic strain and stress on a section."""

from typing import Annotated

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.forms import DRAWN_CONTACT
from gfmd_numba.analysis.plots.style import COLOURS, Width, named_last_step, prefix, scaled, sheet
from gfmd_numba.arrays import Reals


@checked
def plot_flow(dataset: Annotated[xr.Dataset, DRAWN_CONTACT], width: Width | None = None) -> Figure:
    """Draw what has flown below a contact over x and depth, of a map on the row where most has; of a path at its end.

    Above it are the pressure and the residual displacement. Raises UnusableDataError for a dataset without these
    fields.
    """
    step = named_last_step(dataset)
    dataset = dataset.isel(step=-1) if "step" in dataset.dims else dataset
    if "y" in dataset.dims:
        most = dataset["equivalent_plastic_strain"].max(["depth", "x"]).values
        dataset = dataset.isel(y=int(most.argmax()))
    x, x_label = scaled(dataset["x"], "Position $x$", "L_x")
    depth, depth_label = scaled(dataset["depth"], "Depth", "L_x")
    edges = np.append(0.0, np.cumsum(_thicknesses(depth)))
    sides = np.append(x, 2.0 * x[-1] - x[-2]) - 0.5 * (x[1] - x[0])
    panels = sheet(3, 1, (9.0, 2.5), width, title=step, sharex=True, height_ratios=[3, 4, 4])
    with panels as (figure, (above, strain, stress)):
        pressure, label = scaled(dataset["pressure"], "Pressure", "E^*")
        above.fill_between(x, pressure, color=COLOURS[1], alpha=0.35, lw=0)
        above.plot(x, pressure, color=COLOURS[1], lw=0.9)
        above.set(ylabel=label, ylim=(0.0, None), xlim=(x[0], x[-1]))
        moved, label = scaled(dataset["residual_displacement"], "Residual $u_z$", "L_x")
        other = above.twinx()
        other.plot(x, moved, color=COLOURS[0], lw=1.1, ls="--")
        other.set_ylabel(label, color=COLOURS[0])
        factor, unit = prefix(dataset["von_mises_stress"], "E^*")
        plastic, von_mises = dataset["equivalent_plastic_strain"].values, factor * dataset["von_mises_stress"].values
        for axes, values, name, colours in (
            (strain, 100.0 * plastic, "Plastic strain (%)", "magma_r"),
            (stress, von_mises, f"von Mises stress ({unit})", "viridis"),
        ):
            image = axes.pcolormesh(sides, edges, values, cmap=colours, vmin=0.0, rasterized=True)
            axes.set(ylabel=depth_label, ylim=(edges[-1], 0.0))
            figure.colorbar(image, ax=axes, label=name)
        if plastic.any():
            stress.contour(x, depth, plastic > 0.0, [0.5], colors="w", linewidths=0.8)
        stress.set_xlabel(x_label)
    return figure


def _thicknesses(middles: Reals) -> Reals:
    """Thicknesses of sublayers with these middles, the first of which begins at the surface."""
    found, top = np.empty_like(middles), 0.0
    for i, middle in enumerate(middles):
        found[i] = 2.0 * (middle - top)
        top = middle + 0.5 * found[i]
    return found
