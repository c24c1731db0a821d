"""Pictures of friction on a map: which nodes stick and slip, the tangential tractions, and how far nodes have slid."""

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm

from gfmd_numba.analysis.plots.map_image import draw_image, most
from gfmd_numba.analysis.plots.style import COLOURS, prefix, scaled
from gfmd_numba.arrays import Flags, Reals

_ARROWS = 20  # along a side of the map, at most
_SLIP = ListedColormap(mpl.colormaps["viridis"](np.linspace(0.8, 0.0, 256)))  # without yellow, faint on white
_DECADES = 1e-3  # of the slip that colours tell apart


def draw_friction(axes: list[Axes], dataset: xr.Dataset) -> None:
    """Draw stick and slip, the size and the direction of the tangential traction, and the way slid in the last step."""
    touching, slip = dataset["gap"].values == 0.0, dataset["slip"].values
    states = np.where(touching, np.where(slip > 0.0, 1.0, 2.0), 0.0)
    colours = ListedColormap(["white", COLOURS[5], COLOURS[0]])
    bar = draw_image(axes[0], dataset, states, "Nodes", cmap=colours, norm=BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3))
    bar.set_ticks([0.0, 1.0, 2.0], labels=["open", "slipping", "sticking"])
    draw_traction(axes[1], dataset, touching)
    values, label = scaled(dataset["slip"], "Slip in this step", "L_x")
    largest = most(values)
    norm = None if largest is None else LogNorm(_DECADES * largest, largest, clip=True)
    draw_image(axes[2], dataset, np.where(values > 0.0, values, np.nan), label, "both", cmap=_SLIP, norm=norm)


def draw_traction(axis: Axes, dataset: xr.Dataset, shown: Flags) -> None:
    """Draw the size of the tangential traction on the nodes `shown`, and arrows along its mean over squares of nodes.

    The longest arrow stands for the largest mean.
    """
    both = dataset["tangential_traction"], dataset["tangential_traction_y"]
    factor, unit = prefix(max(both, key=lambda component: float(abs(component).max())), "E^*")
    traction = np.where(shown, [factor * component.values for component in both], 0.0)
    size = np.hypot(*traction)
    colours = mpl.colormaps["YlOrBr"].with_extremes(bad="white")
    label = rf"Tangential traction $\tau$ ({unit})"
    draw_image(
        axis, dataset, np.where(shown, size, np.nan), label, "max", cmap=colours, vmin=0.0, vmax=most(size) or 1.0
    )
    square = [-(-n // _ARROWS) for n in size.shape]
    along_x, along_y = (_mean_of_squares(component, square) for component in traction)
    places = [_mean_of_squares(each, square) for each in np.meshgrid(*(scaled(dataset[i], "", "")[0] for i in "xy"))]
    pulled = np.hypot(along_x, along_y) > 0.0
    if pulled.any():
        arrows = (each[pulled] for each in (*places, along_x, along_y))
        axis.quiver(*arrows, color="0.1", width=0.005, pivot="middle", edgecolor="white", linewidth=0.4)


def _mean_of_squares(values: Reals, square: list[int]) -> Reals:
    """Mean of values `[y, x]` over squares of so many nodes; those beyond the last whole square are left out."""
    down, across = (n // k for n, k in zip(values.shape, square, strict=True))
    whole = values[: down * square[0], : across * square[1]]
    return np.asarray(whole.reshape(down, square[0], across, square[1]).mean(axis=(1, 3)))
