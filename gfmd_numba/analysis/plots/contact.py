"""Figure of a single contact, drawn without pyplot so that no state is shared."""

from typing import Annotated

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.forms import DRAWN_CONTACT, UnusableDataError
from gfmd_numba.analysis.plots.contact_map import plot_map
from gfmd_numba.analysis.plots.last_step import named_last_step
from gfmd_numba.analysis.plots.style import COLOURS, STYLE, prefix, scaled

_TRACTIONS = {  # those drawn with the pressure: label, colour, dashes
    "tangential_traction": (r"tangential $\tau$", COLOURS[0], "-"),
    "prescribed_normal_traction": ("prescribed, outwards", COLOURS[2], "--"),
    "prescribed_tangential_traction": ("prescribed, along $x$", COLOURS[3], "-."),
}


@checked
def plot_contact(dataset: Annotated[xr.Dataset, DRAWN_CONTACT]) -> Figure:
    """Draw one contact in the dataset's units: punch and body over x, pressure below; or maps with their statistics.

    Of a path of loadings the last one is drawn, and the title says so. Raises UnusableDataError for a dataset
    without these fields.
    """
    if not {"x", "displacement", "gap", "pressure"} <= dataset.variables.keys():
        raise UnusableDataError("you gave no results of a contact; gfmd allows what `gfmd solve` leaves of one")
    step = named_last_step(dataset)
    dataset = dataset.isel(step=-1) if "step" in dataset.dims else dataset
    figure = plot_map(dataset) if "y" in dataset.dims else _plot_profile(dataset)
    if step:
        figure.suptitle(step, fontsize=11, x=0.01, ha="left")
    return figure


def _plot_profile(dataset: xr.Dataset) -> Figure:
    """Punch and body over x, with the pressure below, and other tractions where there are any."""
    x, x_label = scaled(dataset["x"], "Position $x$", "L_x")
    body = dataset["displacement"] + dataset.get("body_height", 0.0)
    body.attrs = dataset["displacement"].attrs
    punch = body + dataset["gap"]
    above_it = "other body" if "counter_body_height" in dataset else "rigid punch"
    factor, unit = prefix(body, "L_x")
    low, high = factor * body.values, factor * punch.values
    others = [name for name in _TRACTIONS if name in dataset and (name == "tangential_traction" or dataset[name].any())]
    every = [dataset[name] for name in ("pressure", *others)]
    per_unit, unit_of_tractions = prefix(max(every, key=lambda each: float(abs(each).max())), "E^*")
    pressure, *tractions = (per_unit * each.values for each in every)
    rubs = r"Tractions $p$, $\tau$" if others == ["tangential_traction"] else "Tractions"
    named = rubs if others else "Pressure $p$"
    with mpl.rc_context(STYLE):
        figure = Figure((9.0, 6.6), dpi=150, layout="constrained")
        whole, above, below = figure.subplots(3, 1, sharex=True, height_ratios=[3, 6, 4])
        # valleys of the punch rise far above the contact: the close-up below follows the body
        span = max(np.ptp(low), 1e-3 * np.ptp(high)) or 1.0
        bottom, top = low.min() - 0.25 * span, min(high.max() + 0.1 * span, low.max() + 0.6 * span)
        highest = max(top, high.max())
        whole.fill_between(x, high, highest, color="0.82", lw=0)
        whole.plot(x, high, color="0.35", lw=0.8)
        whole.plot(x, low, color=COLOURS[0], lw=1.2)
        whole.set(ylabel=f"Height ({unit})")
        whole.margins(y=0.0)
        above.fill_between(x, high, highest, color="0.82", lw=0, label=above_it)
        above.fill_between(x, bottom, low, color="#BBD9EC", lw=0, label="elastic body")
        above.plot(x, high, color="0.35", lw=1.0)
        if "plastic_depth" in dataset and dataset["plastic_depth"].any():
            before = factor * (punch - dataset["plastic_depth"]).values
            above.plot(x, before, color="0.35", lw=0.8, ls=":", label="punch before it yielded")
        above.plot(x, low, color=COLOURS[0], lw=1.2)
        above.set(ylabel=f"Close-up ({unit})", ylim=(bottom, top), xlim=(x[0], x[-1]))
        whole.axhspan(bottom, top, color=COLOURS[5], alpha=0.25, lw=0, zorder=0, label="range of the close-up")
        figure.align_ylabels()
        below.fill_between(x, pressure, color=COLOURS[1], alpha=0.35, lw=0)
        below.plot(x, pressure, color=COLOURS[1], lw=0.9)
        below.axhline(pressure.mean(), color="0.25", lw=1.0, ls="--", label=r"mean $\bar{p}$")
        for (label, colour, dashes), traction in zip((_TRACTIONS[name] for name in others), tractions, strict=True):
            below.plot(x, traction, dashes, color=colour, lw=1.1, label=label)
        below.set(xlabel=x_label, ylabel=f"{named} ({unit_of_tractions})")
        if min(each.min() for each in (pressure, *tractions)) >= 0:
            below.set_ylim(bottom=0)
        handles = [handle for axis in (above, below, whole) for handle in axis.get_legend_handles_labels()[0]]
        figure.legend(
            handles=handles, loc="outside lower center", ncols=4 + (len(others) == 1)
        )  # above stands the step
    return figure
