"""Picture of the statistics of contacts: pressures, gaps and sizes of contacts."""

from collections.abc import Sequence
from typing import Annotated

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.forms import STATISTICS, UnusableDataError
from gfmd_numba.analysis.plots.style import MARKERS, Width, add_legend, edges, log_ticks, ordered_colours, sheet


@checked
def plot_statistics(statistics: Annotated[xr.Dataset, STATISTICS], width: Width | None = None) -> Figure:
    """Draw the distributions of `contact_statistics`, one colour a `step`, averaged over other dims."""
    if not any({counted, size} <= statistics.variables.keys() for counted, size, _ in _CONTACTS.values()):
        raise UnusableDataError("you gave no sizes of contacts; gfmd allows what `gfmd statistics` leaves")
    with sheet(3, 3, (4.0, 3.6), width) as (figure, panels):
        draw_statistics(panels, statistics)
        handles = panels[0].get_legend_handles_labels()[0]
        add_legend(figure, handles, len(handles))
    return figure


def draw_statistics(panels: Sequence[Axes], statistics: xr.Dataset) -> None:
    """Draw pressures, gaps and sizes of contacts, a panel each; what a legend explains is in the first."""
    pressure, gap, contacts = panels
    others = set(map(str, statistics.dims)) & set(_DENSITY_DIMS)
    drawn = [name for name, each in statistics.variables.items() if name not in others and set(each.dims) & others]
    mean = statistics.reset_coords([name for name in drawn if name in statistics.coords])[drawn]
    mean = mean.mean(set(map(str, mean.dims)) - {"step", *_DENSITY_DIMS})
    steps = [mean.isel(step=i) for i in range(mean.sizes["step"])] if "step" in mean.dims else [mean]
    counted, size, label_of_size = _CONTACTS["clusters" if "clusters" in statistics else "segments"]
    colours = ordered_colours(len(steps))
    loads = [
        f"{float(step.reduced_pressure):.4g}"
        for step in steps
        if "reduced_pressure" in mean.coords and not step.reduced_pressure.ndim
    ]
    for i, step in enumerate(steps):
        colour = colours[i]
        marker = MARKERS[i % len(MARKERS)]
        unloaded = f"step {i}" if "step" in mean.dims else "Simulation"
        label = rf"$\bar{{p}}^* = {loads[i]}$" if len(set(loads)) == len(steps) else unloaded
        pressure.stairs(step["pressure_density"], edges(step["pressure"].values), color=colour, label=label)
        if "pressure_density_persson" in step:
            pressure.plot(step["pressure"], step["pressure_density_persson"], "--", color=colour)
        gap.stairs(step["gap_density"], edges(step["gap"].values), color=colour)
        contacts.plot(step[size], step[counted].where(step[counted] > 0), marker=marker, color=colour)
    if "pressure_density_persson" in mean:
        pressure.plot([], [], "--", color="0.4", label="Persson")
    top = None if (mean["pressure_density"] > 0.0).any() else 1.0  # where nothing touches
    pressure.set(
        xlabel=r"$p\,/\,p_\mathrm{rms}$ of full contact",
        ylabel="Density",
        ylim=(0, top),
        xlim=(0, _end(mean, "pressure")),
    )
    scale = "log" if (mean["gap_density"] > 0.0).any() else "linear"
    gap.set(xlabel="Gap over rms height", ylabel="Density", yscale=scale, xlim=(0, _end(mean, "gap")))
    most = max(10.0, 1.5 * float(mean[counted].max()))
    contacts.set(xlabel=label_of_size, ylabel=counted.capitalize(), xscale="log", yscale="log", ylim=(0.7, most))
    for axis in (contacts.xaxis, contacts.yaxis):
        log_ticks(axis)


def _end(statistics: xr.Dataset, over: str) -> float:
    """Return where no density has more than 2 per mille of its values left, so that an outlier stretches no axis."""
    density = statistics[f"{over}_density"]
    left = density.cumsum(over) < (1.0 - _BEYOND) * density.sum(over)
    last = min(int(left.sum(over).max()) + 1, density.sizes[over] - 1)
    return float(density[over][last])


_BEYOND = 2e-3
_DENSITY_DIMS = ("pressure", "gap", "length", "area")
# how contacts were counted, over what, and how that is labelled
_CONTACTS = {
    "segments": ("segments", "length", r"Segment length over $L_x$"),
    "clusters": ("clusters", "area", r"Cluster area over $L_x^2$"),
}
