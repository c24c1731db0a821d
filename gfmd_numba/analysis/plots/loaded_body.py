"""Picture of a body that is loaded without a punch: displacements above, tractions below."""

import matplotlib as mpl
import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.plots.style import COLOURS, STYLE, prefix, scaled

_COMPONENTS = (("normal", "-", COLOURS[0]), ("tangential", "--", COLOURS[1]))


def plot_loaded_body(dataset: xr.Dataset) -> Figure:
    """Draw both displacements and both tractions of the surface over x, in the units of the dataset."""
    x, x_label = scaled(dataset["x"], "Position $x$", "L_x")
    with mpl.rc_context(STYLE):
        figure = Figure((9.0, 5.4), dpi=150, layout="constrained")
        panels = figure.subplots(2, 1, sharex=True)
        for axis, quantity, natural in zip(panels, ("displacement", "traction"), ("L_x", "E^*"), strict=True):
            both = [dataset[f"{component}_{quantity}"] for component, _, _ in _COMPONENTS]
            factor, unit = prefix(max(both, key=lambda each: float(abs(each).max())), natural)
            for (component, dashes, colour), values in zip(_COMPONENTS, both, strict=True):
                axis.plot(x, factor * values.values, dashes, color=colour, lw=1.3, label=component)
            axis.axhline(0.0, color="0.8", lw=0.8, zorder=0)
            axis.set(ylabel=f"{quantity.capitalize()} ({unit})", xlim=(x[0], x[-1]))
        panels[1].set_xlabel(x_label)
        figure.legend(handles=panels[0].get_legend_handles_labels()[0], loc="outside upper right", ncols=2)
    return figure
