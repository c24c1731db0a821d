"""Pictures of tangential tractions on a map without slip, of a cohesive law or of inclined surfaces."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from gfmd_numba.analysis.plots.friction_map import draw_traction
from gfmd_numba.analysis.plots.map_image import draw_image
from gfmd_numba.analysis.plots.style import prefix


def draw_cohesion(axes: list[Axes], dataset: xr.Dataset) -> None:
    """Draw size and direction of the tangential traction, and the tangential displacement along x and along y."""
    draw_traction(axes[0], dataset, np.ones(dataset["gap"].shape, dtype=np.bool_))
    both = dataset["tangential_displacement"], dataset["tangential_displacement_y"]
    factor, unit = prefix(max(both, key=lambda component: float(abs(component).max())), "L_x")
    for axis, way, component in zip(axes[1:], "xy", both, strict=True):
        label = f"Tangential displacement along ${way}$ ({unit})"
        draw_image(axis, dataset, factor * component.values, label, cmap="cividis")
