"""Values on the nodes of a map as an image with its colours explained, and what crosses a contact: flow and current."""

from collections.abc import Callable
from typing import Annotated, Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import AutoLocator, LogLocator, MaxNLocator, NullFormatter

from gfmd_numba.analysis.forms import CONDUCTANCE, LEAKAGE
from gfmd_numba.analysis.plots.style import COLOURS, Width, by_nodes, drawn, fill, last_step, scaled, sheet, usual
from gfmd_numba.arrays import Reals

_AS_IT_IS: dict[str, Any] = {"origin": "lower", "interpolation": "none"}
_TICKS = 5
_DECADES = 1e-3  # of the largest value, which logarithmic colours still tell
_LEAST_ENLARGED = 48  # nodes along a side of a map that has hot spots
_ENLARGED = 0.16  # of the shorter side, that is enlarged
_CORNERS, _INSET = (0.02, 0.6), 0.38  # of the panel: where the enlarged part begins, and how large it is
_SHARE = 0.98  # of the values above 0 that colours tell apart
_LEFT, _ABOVE_AND_BELOW = 0.75, 1.4  # inches beside and above a map: labels, and the bar of its colours
OF_MAPS: dict[str, Any] = {"least": 1.65, "around": (_LEFT, _ABOVE_AND_BELOW)}  # of a sheet of maps


def panel_of(dataset: xr.Dataset, across: float) -> tuple[float, float]:
    """Return the size in inches of the panel of a map, so that the map fills it."""
    x, y = (float(dataset[dim][-1] + dataset[dim][1]) for dim in ("x", "y"))
    return across, _ABOVE_AND_BELOW + (across - _LEFT) * y / x


def draw_image(
    axis: Axes, dataset: xr.Dataset, values: Reals, label: str, extend: str = "neither", **look: Any
) -> Colorbar:
    """Draw values `[y, x]` over the positions of a dataset; `look` is told to matplotlib's imshow.

    Without limits or a norm, outliers have the colours of the ends, which then are arrows.
    """
    look = {"cmap": "cividis"} | look
    if not look.keys() & {"norm", "vmin", "vmax"}:
        look["vmin"], look["vmax"] = ends = usual(values)
        beyond = bool((values < ends[0]).any()), bool((values > ends[1]).any())
        extend = {(True, True): "both", (True, False): "min", (False, True): "max"}.get(beyond, extend)
    (x, x_label), (y, y_label) = (scaled(dataset[dim], f"Position ${dim}$", "L_x") for dim in ("x", "y"))
    extent = (0.0, x[-1] + x[1], 0.0, y[-1] + y[1])
    image = axis.imshow(values, **_AS_IT_IS, extent=extent, **look)
    axis.set(xlabel=x_label, ylabel=y_label)
    bar = axis.figure.colorbar(image, ax=axis, label=label, extend=extend, location="top", shrink=0.9)
    bar.minorformatter = NullFormatter()
    if isinstance(look.get("norm"), LogNorm):
        bar.locator = LogLocator()  # decades alone
    elif isinstance(bar.locator, AutoLocator):
        bar.locator = MaxNLocator(_TICKS)  # so few that long numbers have room
    return bar


def enlarge_peak(axis: Axes, values: Reals) -> None:
    """Enlarge the surroundings of the largest value `[y, x]` of a map in a corner without values, if there is one.

    Hot spots are so small that a map of the width of a column does not show them.
    """
    ny, nx = values.shape
    if min(ny, nx) < _LEAST_ENLARGED or not (values > 0.0).any():
        return
    row, column = np.unravel_index(int(np.nanargmax(values)), values.shape)
    (left, right), (bottom, top) = axis.get_xlim(), axis.get_ylim()
    x, y = left + (column + 0.5) / nx * (right - left), bottom + (row + 0.5) / ny * (top - bottom)
    half = 0.5 * _ENLARGED * min(right - left, top - bottom)
    x, y = np.clip(x, left + half, right - half), np.clip(y, bottom + half, top - half)
    free = [(left, low) for left in _CORNERS for low in _CORNERS if not _covered(values, left, low)]
    if not free:
        return
    corner = max(free, key=lambda corner: np.hypot(corner[0] - column / nx, corner[1] - row / ny))
    inset = axis.inset_axes((*corner, _INSET, _INSET))
    image = axis.images[0]
    inset.imshow(values, **_AS_IT_IS, extent=image.get_extent(), cmap=image.cmap, clim=image.get_clim())
    inset.set(xticks=[], yticks=[], xlim=(x - half, x + half), ylim=(y - half, y + half))
    inset.spines[:].set(visible=True, color=COLOURS[0])
    axis.indicate_inset_zoom(inset, edgecolor=COLOURS[0], alpha=1.0)


def _covered(values: Reals, left: float, low: float) -> bool:
    """Whether the enlarged part would hide a value above 0 of a map `[y, x]`."""
    rows, columns = (
        slice(int(start * n), int((start + _INSET) * n) + 1) for start, n in zip((low, left), values.shape, strict=True)
    )
    return bool((values[rows, columns] > 0.0).any())


def draw_pressure(axis: Axes, dataset: xr.Dataset) -> None:
    """Draw the pressure on the surface of a dataset: white where there is none, and colours from 0 or the tension."""
    values, label = scaled(dataset["pressure"], "Pressure $p$", "E^*")
    colours = mpl.colormaps["inferno_r"].with_extremes(bad="white")
    tension = most(-values) or 0.0
    shown, extend = np.where(values != 0.0, values, np.nan), "both" if tension else "max"
    bar = draw_image(axis, dataset, shown, label, extend, cmap=colours, vmin=-tension, vmax=most(values))
    if not np.isfinite(shown).any():
        bar.remove()
        axis.set_title("No pressure")
    enlarge_peak(axis, shown)


def decades(values: Reals) -> LogNorm | None:
    """Logarithmic colours that tell three decades of the values above 0 apart; None without any."""
    largest = most(values)
    return None if largest is None else LogNorm(_DECADES * largest, largest, clip=True)


def most(values: Reals) -> float | None:
    """Value that nearly all of those above 0 do not exceed; None without any above 0."""
    return float(np.quantile(values[values > 0.0], _SHARE)) if (values > 0.0).any() else None


@drawn
def plot_leakage(dataset: Annotated[xr.Dataset, LEAKAGE], width: Width | None = None) -> Figure:
    """Draw the flow of `leakage` through each node, a panel for each direction that has any, of a path at its end."""
    title, last = last_step(dataset)
    panel, around, draw = _look(last, 4.4, _draw_flow)
    flows = {along: last["local_flow"].sel(direction=along).values for along in ("x", "y")}
    closed = " or ".join(f"${along}$" for along, flow in flows.items() if not flow.any())
    title = ". ".join(filter(None, (title, closed and f"No flow along {closed}")))
    shown = [along for along, flow in flows.items() if flow.any()] or ["x"]
    with sheet(len(shown), 2, panel, width, title=title, **around) as (figure, axes):
        for axis, along in zip(axes, shown, strict=True):
            draw(axis, last, flows[along], f"Flow along ${along}$ over its mean")
    return figure


def _draw_flow(axis: Axes, dataset: xr.Dataset, flow: Reals, label: str) -> None:
    colours = mpl.colormaps["Blues"].with_extremes(bad="0.85")
    drawn = np.where(flow > 0.0, flow, np.nan)
    bar = draw_image(axis, dataset, drawn, f"{label}, none in grey", "both", cmap=colours, norm=decades(flow))
    if not flow.any():
        bar.remove()


@drawn
def plot_conductance(dataset: Annotated[xr.Dataset, CONDUCTANCE], width: Width | None = None) -> Figure:
    """Draw the current of `contact_conductance` through each node, of a path that of the last step."""
    title, last = last_step(dataset)
    panel, around, draw = _look(last, 5.6, _draw_current)
    with sheet(1, 1, panel, width, title=title, **around) as (figure, (axis,)):
        draw(axis, last, last["current_density"].values, "Current over its mean")
    return figure


def _draw_current(axis: Axes, dataset: xr.Dataset, current: Reals, label: str) -> None:
    colours = mpl.colormaps["inferno_r"].with_extremes(bad="white")
    shown = np.where(current > 0.0, current, np.nan)
    draw_image(axis, dataset, shown, label, "max", cmap=colours, vmin=0.0, vmax=most(current))
    enlarge_peak(axis, shown)


Draw = Callable[[Axes, xr.Dataset, Reals, str], None]
Look = tuple[tuple[float, float], dict[str, Any], Draw]


def _look(dataset: xr.Dataset, across: float, draw: Draw) -> Look:
    """Inches of a panel, what the sheet is told, and what draws: `draw` of maps."""
    of_profiles: Look = (9.0, 3.6), {}, _draw_profile
    return by_nodes(dataset, lambda: of_profiles, lambda: (panel_of(dataset, across), OF_MAPS, draw))()


def _draw_profile(axis: Axes, dataset: xr.Dataset, values: Reals, label: str) -> None:
    x, x_label = scaled(dataset["x"], "Position $x$", "L_x")
    fill(axis, x, values, xlabel=x_label, ylabel=label)
