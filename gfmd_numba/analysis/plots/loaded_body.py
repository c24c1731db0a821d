"""Picture of a body that is loaded without a punch: displacements above, tractions below; a rough profile on top."""

from typing import Annotated, Any

import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.forms import LOADED_BODY
from gfmd_numba.analysis.plots.map_image import OF_MAPS, draw_image, panel_of
from gfmd_numba.analysis.plots.style import COLOURS, Width, add_legend, prefix, scaled, sheet

_COMPONENTS = (("normal", "-", COLOURS[0]), ("tangential", "--", COLOURS[1]))
_OF_MAPS = (("normal", "", "out of the body"), ("tangential", "", "along $x$"), ("tangential", "_y", "along $y$"))
_QUANTITIES = {"displacement": "L_x", "traction": "E^*"}  # and their units without a length or moduli

_ZERO = 1e-6  # of the largest component: what is smaller is left by a residual


@checked
def plot_loaded_body(dataset: Annotated[xr.Dataset, LOADED_BODY], width: Width | None = None) -> Figure:
    """Draw all displacements and tractions of the surface over x, or of a map, in the units of the dataset."""
    return (_plot_map if "y" in dataset.dims else _plot_profile)(dataset, width)


def _plot_profile(dataset: xr.Dataset, width: Width | None) -> Figure:
    x, x_label = scaled(dataset["x"], "Position $x$", "L_x")
    rough = "body_height" in dataset
    with sheet(2 + rough, 1, (9.0, 2.4), width, sharex=True) as (figure, axes):
        panels = axes[-2:]
        if rough:
            heights, unit = prefix(dataset["body_height"], "L_x")
            axes[0].plot(x, heights * dataset["body_height"].values, color="0.35", lw=0.8)
            axes[0].set(ylabel=f"Topography ({unit})")
        for axis, (quantity, natural) in zip(panels, _QUANTITIES.items(), strict=True):
            both = [dataset[f"{component}_{quantity}"] for component, _, _ in _COMPONENTS]
            factor, unit = prefix(max(both, key=lambda each: float(abs(each).max())), natural)
            for (component, dashes, colour), values in zip(_COMPONENTS, both, strict=True):
                axis.plot(x, factor * values.values, dashes, color=colour, label=component)
            axis.axhline(0.0, color="0.8", lw=0.8, zorder=0)
            axis.set(ylabel=f"{quantity.capitalize()} ({unit})", xlim=(x[0], x[-1]))
        panels[1].set_xlabel(x_label)
        add_legend(figure, panels[0].get_legend_handles_labels()[0], 2)
    return figure


def _limits(every: list[xr.DataArray], values: xr.DataArray, factor: float) -> dict[str, Any]:
    """Limits of the colours of a component that is 0 to within the residual, which is then of one colour."""
    largest = max(float(abs(each).max()) for each in every)
    zero = float(abs(values).max()) <= _ZERO * largest
    return {"vmin": -factor * largest, "vmax": factor * largest} if zero and largest else {}


def _plot_map(dataset: xr.Dataset, width: Width | None) -> Figure:
    """Draw a column for each component; a row has one unit, so that components can be compared."""
    with sheet(6, 3, panel_of(dataset, 3.8), width, **OF_MAPS) as (figure, axes):
        for row, (quantity, natural) in zip((axes[:3], axes[3:]), _QUANTITIES.items(), strict=True):
            every = [dataset[f"{component}_{quantity}{end}"] for component, end, _ in _OF_MAPS]
            factor, unit = prefix(max(every, key=lambda each: float(abs(each).max())), natural)
            for axis, (_, _, way), values in zip(row, _OF_MAPS, every, strict=True):
                label = f"{quantity.capitalize()} {way} ({unit})"
                draw_image(
                    axis, dataset, factor * values.values, label, cmap="cividis", **_limits(every, values, factor)
                )
    return figure
