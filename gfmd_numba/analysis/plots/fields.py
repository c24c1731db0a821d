"""Picture of the body under a contact: pressure above, von Mises's stress below."""

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.plots.style import COLOURS, STYLE, scaled
from gfmd_numba.analysis.selection import UnusableDataError

_DEEPEST = 0.5  # of L_x: below, the waves have died out


def plot_body(dataset: xr.Dataset) -> Figure:
    """Draw fields of `gfmd fields` over x and z in their units, of a path the last; raises UnusableDataError."""
    if not {"x", "z", "von_mises", "pressure"} <= dataset.variables.keys():
        raise UnusableDataError("given no fields inside a body; allowed: what `gfmd fields` leaves")
    dataset = dataset.isel(step=-1) if "step" in dataset.dims else dataset
    if not np.isfinite(dataset["von_mises"]).all():
        raise UnusableDataError("given fields of a run that is not ok; allowed: those of one that is, see `status`")
    period = float(dataset["x"][-1] + dataset["x"][1])
    dataset = dataset.isel(z=dataset["z"].values >= -_DEEPEST * period)
    x, x_label = scaled(dataset["x"], "Position $x$", "L_x")
    unit = x[-1] / float(dataset["x"][-1])
    z = dataset["z"].values * unit
    pressure, pressure_label = scaled(dataset["pressure"], "Pressure $p$", "E^*")
    mises, mises_label = scaled(dataset["von_mises"], "von Mises stress", "E^*")
    with mpl.rc_context(STYLE):
        figure = Figure((9.0, 6.4), dpi=150, layout="constrained")
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=[1, 3])
        above.fill_between(x, pressure, color=COLOURS[1], alpha=0.35, lw=0)
        above.plot(x, pressure, color=COLOURS[1], lw=0.9)
        above.set(ylabel=pressure_label)
        # stresses at the edges of contacts are far above all others: the colours follow the rest
        levels = np.linspace(0.0, np.quantile(mises, 0.998) or 1.0, 25)
        drawn = below.contourf(x, z, mises, levels, cmap="cividis", extend="max")
        below.set(xlabel=x_label, ylabel=x_label.replace("Position $x$", "Height $z$"), xlim=(x[0], x[-1]))
        figure.colorbar(drawn, ax=below, label=mises_label, format="%.3g", ticks=levels[::6])
    return figure
