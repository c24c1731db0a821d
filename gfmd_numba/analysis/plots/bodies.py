"""Figures of bodies: stress under a contact, plastic flow there, and the surface of a body loaded without a punch."""

from typing import Annotated, Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from gfmd_numba.analysis.forms import DRAWN_CONTACT, FIELDS, LOADED_BODY, UnusableDataError, by_layer
from gfmd_numba.analysis.plots.map_image import OF_MAPS, draw_image, draw_pressure, panel_of
from gfmd_numba.analysis.plots.style import (
    COLOURS,
    Width,
    add_legend,
    by_nodes,
    drawn,
    fill,
    last_step,
    prefix,
    scaled,
    sheet,
    told,
)
from gfmd_numba.arrays import Reals

_USUAL = 0.998  # of the stresses have colours of their own: those at edges of contacts are far above all others
_DEEPEST = 0.5  # of L_x: below, the waves have died out
_COLUMNS = 3
_TITLE = 0.3  # inches of the title of a panel
_MOST = 8  # planes that are drawn: the highest
_COMPONENTS_OF_MAPS = (
    ("normal", "", "out of the body"),
    ("tangential", "", "along $x$"),
    ("tangential", "_y", "along $y$"),
)
_QUANTITIES = {"displacement": "L_x", "traction": "E^*"}  # and their units without a length or moduli
_ZERO = 1e-6  # of the largest component: what is smaller is left by a residual


@drawn
def plot_body(dataset: Annotated[xr.Dataset, FIELDS], width: Width | None = None) -> Figure:
    """Draw fields of `gfmd fields` in their units, of a path the last step; raises UnusableDataError."""
    step, dataset = last_step(dataset)
    if not np.isfinite(dataset["von_mises"]).all():
        raise UnusableDataError(
            "you gave fields of a run that is not ok; gfmd allows those of one that is, see `status`"
        )
    of_other = "Counter body" if dataset.attrs.get("body") == "counter_body" else ""
    title = ". ".join(filter(None, (of_other, step)))
    return (_plot_planes if dataset["von_mises"].ndim == 3 else _plot_section)(dataset, title, width)


def _plot_section(dataset: xr.Dataset, title: str, width: Width | None) -> Figure:
    dim = str(dataset["von_mises"].dims[1])
    period = float(dataset[dim][-1] + dataset[dim][1])
    dataset = dataset.isel(z=dataset["z"].values >= -_DEEPEST * period)
    if dataset.sizes["z"] < 2:
        raise UnusableDataError("you gave fields at fewer than two depths of a section; gfmd allows two or more")
    x, x_label = scaled(dataset[dim], f"Position ${dim}$", "L_x")
    unit = x[-1] / float(dataset[dim][-1])
    z = dataset["z"].values * unit
    pressure, pressure_label = scaled(dataset["pressure"], "Pressure $p$", "E^*")
    mises, mises_label = scaled(dataset["von_mises"], "von Mises stress", "E^*")
    deepest, highest = np.unravel_index(int(np.argmax(mises)), mises.shape)
    grid: dict[str, Any] = {"around": (2.0, 1.0), "height_ratios": [1.2, 3.3, 2.3]}
    with sheet(3, 1, (9.0, 3.2), width, title=title, **grid) as (figure, axes):
        above, whole, close = axes
        fill(above, x, pressure, ylabel=pressure_label.replace(" (", "\n("), xlabel=x_label)
        if not pressure.any():
            above.set(yticks=[], ylabel="Pressure $p$")
            above.text(0.5, 0.4, "no pressure along this section", ha="center", transform=above.transAxes)
        z_label = x_label.replace(f"Position ${dim}$", "Height $z$")
        _draw(figure, whole, x, z, mises, float(np.quantile(mises, _USUAL)), mises_label)
        whole.set(xlabel=x_label, ylabel=z_label, aspect="equal")
        peak = float(mises.max())
        depth = max(-1.5 * z[deepest], (x[-1] + x[1]) / 24.0, -np.sort(z)[-2])  # two levels at least
        across = min(3.0 * depth, x[-1])  # flat, so that its title fits
        near = np.abs(x - np.clip(x[highest], across / 2.0, x[-1] - across / 2.0)) <= across / 2.0
        shallow = z >= -depth
        _draw(figure, close, x[near], z[shallow], mises[np.ix_(shallow, near)], peak, mises_label)
        close.plot(x[highest], z[deepest], "+", color=COLOURS[1], ms=8, mew=1.5)
        unit_of_stress = mises_label.partition("(")[2].rstrip(")")
        length = x_label.partition("(")[2].rstrip(")")
        at = f"${dim}$ = {told(x[highest], length)}, $z$ = {told(z[deepest], length, 3)}"
        above.set_title(_place_of_section(dataset, unit, length))
        close.set_title(f"Largest stress, {told(peak, unit_of_stress)} at {at}")
        close.set(xlabel=x_label, ylabel=z_label, aspect="equal")
    return figure


def _place_of_section(dataset: xr.Dataset, factor: float, unit: str) -> str:
    """Say where a section below a map is, in a unit; nothing of a profile."""
    across = ({"x", "y"} & set(dataset.coords)) - set(dataset.dims)
    return "".join(f"Section at ${axis}$ = {told(factor * float(dataset[axis]), unit)}" for axis in across)


def _draw(figure: Figure, axis: Axes, x: Reals, z: Reals, values: Reals, most: float, label: str) -> None:
    levels = np.linspace(0.0, most or 1.0, 25)
    extend = "max" if values.max() > levels[-1] else "neither"
    layers = [layer for layer in by_layer(z) if len(layer) > 1] or [np.arange(len(z))]
    for layer in layers:  # stresses jump at interfaces
        drawn = axis.contourf(x, z[layer], values[layer], levels, cmap="cividis", extend=extend)
    ticks = [tick for tick in MaxNLocator(5).tick_values(0.0, levels[-1]) if tick <= levels[-1]]
    figure.colorbar(drawn, ax=axis, label=label, format="%.3g", ticks=ticks)


def _plot_planes(dataset: xr.Dataset, title: str, width: Width | None) -> Figure:
    """Draw the pressure on the surface and von Mises's stress on planes of `gfmd fields`, with its largest value."""
    dataset = dataset.isel(z=np.argsort(-dataset["z"].values)[:_MOST])
    z, z_label = scaled(dataset["z"], "", "L_x")
    unit = z_label.strip(" ()")
    across, up = panel_of(dataset, 3.8)
    beside, above = OF_MAPS["around"]
    grid = OF_MAPS | {"around": (beside, above + _TITLE)}
    with sheet(1 + len(z), _COLUMNS, (across, up + _TITLE), width, title=title, **grid) as (figure, axes):
        draw_pressure(axes[0], dataset)
        for i, axis in enumerate(axes[1:]):
            level = dataset.isel(z=i)
            values, label = scaled(level["von_mises"], "von Mises stress", "E^*")
            usual = float(np.quantile(values, _USUAL))
            draw_image(axis, level, values, label, "max", vmin=0.0, vmax=usual)
            row, column = np.unravel_index(int(np.argmax(values)), values.shape)
            (x, _), (y, _) = (scaled(level[dim], "", "") for dim in ("x", "y"))
            axis.plot(x[column], y[row], "+", color=COLOURS[1], ms=8, mew=1.5)
            stress = label.partition("(")[2].rstrip(")")
            axis.set_title(f"$z$ = {told(z[i], unit, 3)}, at most {told(values.max(), stress)}")
    return figure


@drawn
def plot_flow(dataset: Annotated[xr.Dataset, DRAWN_CONTACT], width: Width | None = None) -> Figure:
    """Draw what has flowed below a contact over x and depth, of a map on the row where most has; of a path at its end.

    Above it are the pressure and the residual displacement. Raises UnusableDataError for a dataset without these
    fields.
    """
    step, dataset = last_step(dataset)
    most = dataset["equivalent_plastic_strain"].max(["depth", "x"])
    dataset = dataset.isel({dim: int(most.values.argmax()) for dim in most.dims})
    step = ". ".join(filter(None, (step, _place_of_section(dataset, *prefix(dataset["x"], "L_x")))))
    x, x_label = scaled(dataset["x"], "Position $x$", "L_x")
    depth, depth_label = scaled(dataset["depth"], "Depth", "L_x")
    edges = [0.0]  # of sublayers with these middles
    for middle in depth:
        edges.append(2.0 * middle - edges[-1])
    sides = np.append(x, 2.0 * x[-1] - x[-2]) - 0.5 * (x[1] - x[0])
    panels = sheet(4, 1, (9.0, 2.2), width, title=step, sharex=True, height_ratios=[2, 2, 4, 4])
    with panels as (figure, (above, dents, strain, stress)):
        pressure, label = scaled(dataset["pressure"], "Pressure", "E^*")
        fill(above, x, pressure, ylabel=label.replace(" (", "\n("))
        moved, label = scaled(dataset["residual_displacement"], "Residual $u_z$", "L_x")
        dents.plot(x, moved, color=COLOURS[0])
        dents.set(ylabel=label.replace(" (", "\n("))
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


_COMPONENTS = (("normal", "-", COLOURS[0]), ("tangential", "--", COLOURS[1]))


@drawn
def plot_loaded_body(dataset: Annotated[xr.Dataset, LOADED_BODY], width: Width | None = None) -> Figure:
    """Draw all displacements and tractions of the surface over x, or of a map, in the units of the dataset."""
    return by_nodes(dataset, _plot_profile, _plot_map)(dataset, width)


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
            factor, unit = prefix(both, natural)
            for (component, dashes, colour), values in zip(_COMPONENTS, both, strict=True):
                axis.plot(x, factor * values.values, dashes, color=colour, label=component)
            axis.axhline(0.0, color="0.8", lw=0.8, zorder=0)
            axis.set(ylabel=f"{quantity.capitalize()} ({unit})", xlim=(x[0], x[-1]))
        panels[1].set_xlabel(x_label)
        add_legend(figure, panels[0].get_legend_handles_labels()[0], 2)
    return figure


def _plot_map(dataset: xr.Dataset, width: Width | None) -> Figure:
    """Draw a column for each component; a row has one unit, so that components can be compared."""
    with sheet(6, 3, panel_of(dataset, 3.8), width, **OF_MAPS) as (figure, axes):
        for row, (quantity, natural) in zip((axes[:3], axes[3:]), _QUANTITIES.items(), strict=True):
            every = [dataset[f"{component}_{quantity}{end}"] for component, end, _ in _COMPONENTS_OF_MAPS]
            sizes = [float(abs(each).max()) for each in every]
            factor, unit = prefix(every, natural)
            largest = factor * max(sizes)
            for axis, (_, _, way), values, size in zip(row, _COMPONENTS_OF_MAPS, every, sizes, strict=True):
                label = f"{quantity.capitalize()} {way} ({unit})"
                # a component that is 0 to within the residual has one colour
                ends: dict[str, Any] = (
                    {"vmin": -largest, "vmax": largest} if factor * size <= _ZERO * largest and largest else {}
                )
                draw_image(axis, dataset, factor * values.values, label, **ends)
    return figure
