"""Figure of a campaign without limits: means against a parameter, drawn without pyplot so that no state is shared."""

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from gfmd_numba.analysis.names import has_names, plain, shown
from gfmd_numba.analysis.plots.looks import Looks
from gfmd_numba.analysis.plots.looks import looks as looks_of
from gfmd_numba.analysis.plots.style import LINE, STYLE, log_ticks, of_variable, scaled, with_unit
from gfmd_numba.analysis.selection import UnusableDataError, axes, ensemble_mean, groups, key

_WIDE = 5.0  # ratio of the largest to the smallest value from which on an axis is logarithmic


def plot_parameter(dataset: xr.Dataset, variable: str) -> Figure:
    """Draw case means with standard errors against the parameter that has most values, a line for each set of others.

    A parameter of names, like files, is taken only where no number is varied, and no line joins its values.
    UnusableDataError for a dataset in which no parameter is varied.
    """
    name = most_varied(dataset)
    if name is None:
        raise UnusableDataError(
            "given results in which no discretisation is varied, and no other parameter; "
            "allowed: results of a campaign with limits or a grid"
        )
    others = dataset.drop_vars(name)
    looks = looks_of(others)
    with mpl.rc_context(STYLE):
        figure = Figure((5.6, 4.6), dpi=150, layout="constrained")
        panel = figure.subplots()
        draw_means(panel, dataset, variable, name, looks)
        panel.set_ylabel(of_variable(dataset, variable))
        panel.grid(axis="y", color="0.9", linewidth=0.8)
        if len(looks.of) > 1:
            handles = [Line2D([], [], **look) for look in looks.of.values()]
            figure.set_figheight(4.6 + LINE * max(0, -(-len(handles) // 2) - 3))  # the panel keeps its height
            figure.legend(handles=handles, loc="outside upper center", ncols=2)
    return figure


def most_varied(dataset: xr.Dataset) -> str | None:
    """The parameter that has most values, one of numbers if there is any; None where no parameter is varied."""
    sizes = {name: np.unique(dataset[name]).size for name in axes(dataset)}
    name = max(sizes, key=lambda each: (sizes[each] > 1 and not has_names(dataset[each]), sizes[each]))
    return name if sizes[name] > 1 else None


def draw_means(panel: Axes, dataset: xr.Dataset, variable: str, name: str, looks: Looks, factor: float = 1.0) -> None:
    """Draw case means, times a factor, with standard errors against a parameter, a line for each set of others."""
    values = _axis(panel, dataset[name])
    for parameters, group in groups(dataset.drop_vars(name).assign_coords(_value=("case", values))):
        ordered = group.sortby("_value")
        mean, error = ensemble_mean(ordered, variable)
        look = looks.of[key(parameters)] | ({"linestyle": "none"} if has_names(dataset[name]) else {})
        x = ordered["_value"].values
        panel.errorbar(x, factor * mean, factor * error, ms=5.5, capsize=2.5, lw=1.3, **look)
    if panel.get_xscale() == "log":
        log_ticks(panel.xaxis)


def _axis(panel: Axes, parameter: xr.DataArray) -> NDArray[np.float64]:
    """Where the values of a parameter stand on its axis, side by side if they are names or one of them is infinite."""
    label = str(parameter.attrs.get("label", parameter.name))
    if has_names(parameter):
        levels, position = np.unique(parameter, return_inverse=True)
        panel.set_xticks(range(len(levels)), list(map(plain, shown(parameter, levels))), rotation=20, ha="right")
        panel.set_xlabel(label)
        return position.astype(float)
    if not np.isfinite(parameter).all():
        levels, position = np.unique(parameter, return_inverse=True)
        panel.set_xticks(range(len(levels)), [f"{level:g}" for level in levels])
        panel.set_xlabel(with_unit(label, parameter))
        return position.astype(float)
    values, label = (
        (parameter.values, label) if parameter.attrs.get("units", "1") == "1" else scaled(parameter, label, "")
    )
    if values.min() > 0.0 and values.max() > _WIDE * values.min():
        panel.set_xscale("log")
    panel.set_xlabel(label)
    return np.asarray(values, dtype=float)
