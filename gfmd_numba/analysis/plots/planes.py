"""Picture of horizontal planes below a map: pressure on the surface, and von Mises's stress at each depth."""

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.plots.map_image import draw_image, draw_pressure
from gfmd_numba.analysis.plots.style import STYLE, scaled, told

_COLUMNS = 3
_MOST = 8  # planes that are drawn: the highest


def plot_planes(dataset: xr.Dataset) -> Figure:
    """Draw the pressure on the surface and von Mises's stress on planes of `gfmd fields`, with its largest value."""
    dataset = dataset.isel(z=np.argsort(-dataset["z"].values)[:_MOST])
    panels = 1 + dataset.sizes["z"]
    columns = min(_COLUMNS, panels)
    rows = -(-panels // columns)
    z, z_label = scaled(dataset["z"], "", "L_x")
    unit = z_label.strip(" ()")
    with mpl.rc_context(STYLE):
        figure = Figure((4.7 * columns, 1.4 + 4.4 * rows), dpi=150, layout="constrained")
        places = figure.add_gridspec(rows, columns)
        axes = [figure.add_subplot(places[divmod(i, columns)]) for i in range(panels)]
        draw_pressure(axes[0], dataset)
        for i, axis in enumerate(axes[1:]):
            level = dataset.isel(z=i)
            values, label = scaled(level["von_mises"], "von Mises stress", "E^*")
            draw_image(axis, level, values, label, cmap="cividis", vmin=0.0)
            row, column = np.unravel_index(int(np.argmax(values)), values.shape)
            (x, _), (y, _) = (scaled(level[dim], "", "") for dim in ("x", "y"))
            axis.plot(x[column], y[row], "+", color="#D55E00", ms=10, mew=2)
            stress = label.partition("(")[2].rstrip(")")
            axis.set_title(f"$z$ = {told(z[i], unit, 3)}, at most {told(values.max(), stress)}", fontsize=11)
    return figure
