"""Figures of single contacts and of their statistics, drawn without pyplot so that no state is shared."""

from collections.abc import Sequence
from typing import Annotated

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from gfmd_numba.analysis.contact_statistics import contact_statistics
from gfmd_numba.analysis.forms import DRAWN_CONTACT, STATISTICS, UnusableDataError
from gfmd_numba.analysis.plots import style
from gfmd_numba.analysis.plots.map_image import OF_MAPS, decades, draw_image, draw_pressure, most, panel_of
from gfmd_numba.analysis.plots.style import COLOURS, Width, drawn
from gfmd_numba.arrays import Flags
from gfmd_numba.arrays.regions import on_wall

_BEYOND = 2e-3
_DENSITY_DIMS = ("pressure", "gap", "length", "area")
# how contacts were counted: over what, and how that is labelled
_CONTACTS = {
    "segments": ("length", r"Segment length over $L_x$"),
    "clusters": ("area", r"Cluster area over $L_x^2$"),
}
_SUM = "sum of the heights"  # how a height is named that stands for rough bodies which no dataset tells apart
_CONTACT = "#E69F00"  # of touching nodes among the gaps, which are blue
_FLATTENED = "#D55E00"
_LEAST_PATCH = 6.0  # nodes across, below which an outline would hide what it surrounds
_ARROWS = 20  # along a side of the map, at most


@drawn
def plot_statistics(statistics: Annotated[xr.Dataset, STATISTICS], width: Width | None = None) -> Figure:
    """Draw the distributions of `contact_statistics`, one colour a `step`, averaged over other dims."""
    if not any({counted, size} <= statistics.variables.keys() for counted, (size, _) in _CONTACTS.items()):
        raise UnusableDataError("you gave no sizes of contacts; gfmd allows what `gfmd statistics` leaves")
    with style.sheet(_panels(statistics), 3, (4.0, 3.6), width) as (figure, panels):
        handles = draw_statistics(panels, statistics)
        style.add_legend(figure, handles, len(handles))
    return figure


def _panels(statistics: xr.Dataset) -> int:
    """Return how many panels statistics have: gaps alone where nothing touches."""
    return 3 if (statistics["pressure_density"] > 0.0).any() else 1


def draw_statistics(panels: Sequence[Axes], statistics: xr.Dataset) -> list[Artist]:
    """Draw gaps, or pressures, gaps and sizes of contacts, a panel each; return what a legend explains."""
    gap = panels[len(panels) // 2]
    others = set(map(str, statistics.dims)) & set(_DENSITY_DIMS)
    drawn = [name for name, each in statistics.variables.items() if name not in others and set(each.dims) & others]
    mean = statistics.reset_coords([name for name in drawn if name in statistics.coords])[drawn]
    mean = mean.mean(set(map(str, mean.dims)) - {"step", *_DENSITY_DIMS})
    steps = [mean.isel(step=i) for i in range(mean.sizes["step"])] if "step" in mean.dims else [mean]
    counted = "clusters" if "clusters" in statistics else "segments"
    size, label_of_size = _CONTACTS[counted]
    colours = style.ordered_colours(len(steps))
    persson = "pressure_density_persson" in mean and bool((mean["pressure_density_persson"] > 0.0).any())
    loads = [
        f"{float(step.reduced_pressure):.4g}"
        for step in steps
        if "reduced_pressure" in mean.coords and not step.reduced_pressure.ndim
    ]
    for i, step in enumerate(steps):
        colour = colours[i]
        marker = style.MARKERS[i % len(style.MARKERS)]
        unloaded = f"step {i}" if "step" in mean.dims else "Simulation"
        label = rf"$\bar{{p}}^* = {loads[i]}$" if len(set(loads)) == len(steps) else unloaded
        gap.stairs(step["gap_density"], style.edges(step["gap"].values), color=colour, label=label)
        if len(panels) == 1:
            continue
        panels[0].stairs(step["pressure_density"], style.edges(step["pressure"].values), color=colour)
        if persson:
            panels[0].plot(step["pressure"], step["pressure_density_persson"], "--", color=colour)
        panels[2].plot(step[size], step[counted].where(step[counted] > 0), marker=marker, color=colour)
    scale = "log" if (mean["gap_density"] > 0.0).any() else "linear"
    gap.set(xlabel="Gap over rms height", ylabel="Density", yscale=scale, xlim=(0, _end(mean, "gap")))
    logarithmic: list[Axis] = [gap.yaxis] if scale == "log" else []
    if len(panels) > 1:
        if persson:
            panels[0].plot([], [], "--", color="0.4", label="Persson")
        x_label, end = r"$p\,/\,p_\mathrm{rms}$ of full contact", _end(mean, "pressure")
        panels[0].set(xlabel=x_label, ylabel="Density", ylim=(0, None), xlim=(0, end))
        limits = 0.7, max(10.0, 1.5 * float(mean[counted].max()))
        panels[2].set(xlabel=label_of_size, ylabel=counted.capitalize(), xscale="log", yscale="log", ylim=limits)
        logarithmic += [panels[2].xaxis, panels[2].yaxis]
    for axis in logarithmic:
        style.log_ticks(axis)
    explained = dict.fromkeys((gap, panels[0]))
    return [handle for panel in explained for handle in panel.get_legend_handles_labels()[0]]


def _end(statistics: xr.Dataset, over: str) -> float:
    """Return where no density has more than 2 per mille of its values left, so that an outlier stretches no axis."""
    density = statistics[f"{over}_density"]
    left = density.cumsum(over) < (1.0 - _BEYOND) * density.sum(over)
    last = min(int(left.sum(over).max()) + 1, density.sizes[over] - 1)
    return float(density[over][last])


_TRACTIONS = {  # those drawn with the pressure: label, colour, dashes
    "tangential_traction": (r"tangential $\tau$", COLOURS[0], "-"),
    "prescribed_normal_traction": ("prescribed, outwards", COLOURS[2], "--"),
    "prescribed_tangential_traction": ("prescribed, along $x$", COLOURS[3], "-."),
}


@drawn
def plot_contact(dataset: Annotated[xr.Dataset, DRAWN_CONTACT], width: Width | None = None) -> Figure:
    """Draw one contact in the dataset's units: punch and body over x, pressure below; or maps with their statistics.

    Of a path of loadings the last one is drawn, and the title says so. Raises UnusableDataError for a dataset
    without these fields.
    """
    step, dataset = style.last_step(dataset)
    return style.by_nodes(dataset, _plot_profile, _plot_map)(dataset, step, width)


def _plot_profile(dataset: xr.Dataset, step: str, width: Width | None) -> Figure:
    """Punch and body over x, with the pressure below, and other tractions where there are any."""
    x, x_label = style.scaled(dataset["x"], "Position $x$", "L_x")
    body = dataset["displacement"] + dataset.get("body_height", 0.0)
    body.attrs = dataset["displacement"].attrs
    punch = body + dataset["gap"]
    above_it, below_it = "rigid punch, peaks down", "elastic body"
    if "counter_body_height" in dataset:
        above_it = "other body"
    named_height = str(dataset["height"].attrs.get("long_name", "")) if "height" in dataset else ""
    if "body_height" not in dataset and named_height.startswith(_SUM):
        above_it, below_it = "heights of both surfaces", "displacement of both"
    factor, unit = style.prefix(body if body.any() else punch.assign_attrs(body.attrs), "L_x")
    low, high = factor * body.values, factor * punch.values
    others = [name for name in _TRACTIONS if name in dataset and (name == "tangential_traction" or dataset[name].any())]
    every = [dataset[name] for name in ("pressure", *others)]
    per_unit, unit_of_tractions = style.prefix(every, "E^*")
    pressure, *tractions = (per_unit * each.values for each in every)
    rubs = r"Tractions $p$, $\tau$" if others == ["tangential_traction"] else "Tractions"
    named = rubs if others else "Pressure $p$"
    with style.sheet(3, 1, (9.0, 2.1), width, title=step, sharex=True, height_ratios=[3, 6, 4]) as (figure, axes):
        whole, above, below = axes
        # valleys of the punch rise far above the contact: the close-up below follows the body
        span = (max(np.ptp(low), 1e-3 * np.ptp(high)) if low.any() else np.ptp(high)) or 1.0
        bottom, top = low.min() - 0.25 * span, min(high.max() + 0.1 * span, low.max() + 0.6 * span)
        highest = max(top, high.max())
        whole.fill_between(x, high, highest, color="0.82", lw=0)
        whole.plot(x, high, color="0.35", lw=0.8)
        whole.plot(x, low, color=COLOURS[0])
        whole.set(ylabel=f"Position ({unit})")
        whole.margins(y=0.0)
        above.fill_between(x, high, highest, color="0.82", lw=0, label=above_it)
        above.fill_between(x, bottom, low, color="#BBD9EC", lw=0, label=below_it)
        above.plot(x, high, color="0.35", lw=0.8)
        if "plastic_depth" in dataset and dataset["plastic_depth"].any():
            before = factor * (punch - dataset["plastic_depth"]).values
            above.plot(x, before, color="0.35", lw=0.8, ls=":", label="original punch")
        above.plot(x, low, color=COLOURS[0])
        above.set(ylabel=f"Close-up ({unit})", ylim=(bottom, top), xlim=(x[0], x[-1]))
        whole.axhspan(bottom, top, color=COLOURS[5], alpha=0.25, lw=0, zorder=0, label="range of the close-up")
        figure.align_ylabels()
        below.fill_between(x, pressure, color=COLOURS[1], alpha=0.35, lw=0)
        below.plot(x, pressure, color=COLOURS[1], lw=0.9, label="pressure $p$" if others else None)
        below.axhline(pressure.mean(), color="0.25", lw=1.0, ls="--", label=r"mean $\bar{p}$")
        for (label, colour, dashes), traction in zip((_TRACTIONS[name] for name in others), tractions, strict=True):
            below.plot(x, traction, dashes, color=colour, label=label)
        below.set(xlabel=x_label, ylabel=f"{named} ({unit_of_tractions})")
        if min(each.min() for each in (pressure, *tractions)) >= 0:
            below.set_ylim(bottom=0)
        if not any(each.any() for each in (pressure, *tractions)):
            below.set(yticks=[0.0], ylim=(-1.0, 1.0))
        handles = [handle for axis in (above, below, whole) for handle in axis.get_legend_handles_labels()[0]]
        style.add_legend(figure, handles, 4 + (len(others) == 1), "outside lower center")  # above stands the step
    return figure


def _plot_map(dataset: xr.Dataset, step: str, width: Width | None) -> Figure:
    """Draw the contact of a map in its units, tangential tractions if it has any, and statistics where they are known.

    Outlines surround the contact, and on the heights what has been flattened, where clusters are large enough for it.
    Gaps have logarithmic colours and touching nodes one of their own, so that a small gap is told from none.
    """
    try:
        statistics = contact_statistics(dataset)
    except UnusableDataError:  # a run that is not ok, or a part of a map
        statistics = None
    touching = on_wall(dataset["gap"].values)
    drags = "tangential_traction_y" in dataset
    added = 0 if statistics is None else _panels(statistics)
    count = 3 * (1 + drags) + added
    with style.sheet(count, 3, panel_of(dataset, 3.3), width, title=step, **OF_MAPS) as (figure, axes):
        heights, pressure, gap = axes[:3]
        punch = dataset["height"] if "height" in dataset else dataset["displacement"] + dataset["gap"]
        of = "both surfaces together" if "body_height" in dataset else "the punch"
        values, label = style.scaled(punch, f"Height of {of}", "L_x")
        flat = dataset["plastic_depth"].values > 0.0 if "plastic_depth" in dataset else np.zeros_like(touching)
        told = ", flattened within lines" if _is_in_patches(flat) else ""
        draw_image(heights, dataset, values, label + told)
        _outline(heights, dataset, flat, _FLATTENED)
        draw_pressure(pressure, dataset)
        _outline(pressure, dataset, touching)
        values, label = style.scaled(dataset["gap"], "Gap", "L_x")
        colours = mpl.colormaps["Blues"].with_extremes(bad=_CONTACT)
        label, norm = (f"{label}, contact in orange", decades(values)) if touching.any() else (label, None)
        draw_image(gap, dataset, np.where(touching, np.nan, values), label, "both", cmap=colours, norm=norm)
        if drags:
            draw = draw_friction if "slip" in dataset else draw_cohesion
            draw(axes[3:6], dataset)
        if statistics is not None:
            handles = draw_statistics(axes[-added:], statistics)
            style.add_legend(figure, handles, 2, "outside lower center")
    return figure


def _is_in_patches(flags: Flags) -> bool:
    """Whether clusters of flags are large enough for an outline."""
    sides = sum(np.count_nonzero(flags != np.roll(flags, 1, axis=i)) for i in (0, 1))
    return bool(sides and 4.0 * flags.sum() / sides >= _LEAST_PATCH)


def _outline(axis: Axes, dataset: xr.Dataset, flags: Flags, colour: str = "0.1") -> None:
    """Surround clusters of flags where they are large enough for it."""
    if _is_in_patches(flags):
        (x, _), (y, _) = (style.scaled(dataset[dim], "", "") for dim in ("x", "y"))
        axis.contour(x + 0.5 * x[1], y + 0.5 * y[1], flags, [0.5], colors=colour, linewidths=0.6)


_SLIP = ListedColormap(mpl.colormaps["viridis"](np.linspace(0.8, 0.0, 256)))  # without yellow, faint on white


def draw_friction(axes: list[Axes], dataset: xr.Dataset) -> None:
    """Draw stick and slip, the size and the direction of the tangential traction, and the way slid in the last step."""
    touching, slip = on_wall(dataset["gap"].values), dataset["slip"].values
    states = np.where(touching, np.where(slip > 0.0, 1.0, 2.0), 0.0)
    colours = ListedColormap(["white", COLOURS[5], COLOURS[0]])
    bar = draw_image(axes[0], dataset, states, "Nodes", cmap=colours, norm=BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3))
    bar.set_ticks([0.0, 1.0, 2.0], labels=["open", "slipping", "sticking"])
    draw_traction(axes[1], dataset, touching)
    values, label = style.scaled(dataset["slip"], "Slip in this step", "L_x")
    draw_image(
        axes[2], dataset, np.where(values > 0.0, values, np.nan), label, "both", cmap=_SLIP, norm=decades(values)
    )


def draw_traction(axis: Axes, dataset: xr.Dataset, shown: Flags) -> None:
    """Draw the size of the tangential traction on the nodes `shown`, and arrows along its mean over squares of nodes.

    The longest arrow stands for the largest mean.
    """
    both = dataset["tangential_traction"], dataset["tangential_traction_y"]
    factor, unit = style.prefix(both, "E^*")
    traction = np.where(shown, [factor * component.values for component in both], 0.0)
    size = np.hypot(*traction)
    colours = mpl.colormaps["YlOrBr"].with_extremes(bad="white")
    label = rf"Tangential traction $\tau$ ({unit})"
    draw_image(
        axis, dataset, np.where(shown, size, np.nan), label, "max", cmap=colours, vmin=0.0, vmax=most(size) or 1.0
    )
    places = {dim: style.scaled(dataset[dim], "", "")[0] for dim in "yx"}
    squares = {dim: -(-len(at) // _ARROWS) for dim, at in places.items()}
    along = xr.Dataset({"x_": (("y", "x"), traction[0]), "y_": (("y", "x"), traction[1])}, places)
    mean = along.coarsen(squares, boundary="trim").mean().stack(at=("y", "x"))
    pulled = mean.isel(at=np.hypot(mean["x_"].values, mean["y_"].values) > 0.0)
    if pulled.sizes["at"]:
        arrows = (pulled[name].values for name in ("x", "y", "x_", "y_"))
        axis.quiver(*arrows, color="0.1", width=0.005, pivot="middle", edgecolor="white", linewidth=0.4)


def draw_cohesion(axes: list[Axes], dataset: xr.Dataset) -> None:
    """Draw size and direction of the tangential traction, and the tangential displacement along x and along y."""
    draw_traction(axes[0], dataset, np.ones(dataset["gap"].shape, dtype=np.bool_))
    both = dataset["tangential_displacement"], dataset["tangential_displacement_y"]
    factor, unit = style.prefix(both, "L_x")
    for axis, way, component in zip(axes[1:], "xy", both, strict=True):
        label = f"Tangential displacement along ${way}$ ({unit})"
        draw_image(axis, dataset, factor * component.values, label)
