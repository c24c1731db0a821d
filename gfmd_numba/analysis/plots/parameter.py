"""Figure of means, or of limits, against a parameter, drawn without pyplot so that no state is shared."""

from collections.abc import Callable

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from gfmd_numba.analysis.forms import UnusableDataError
from gfmd_numba.analysis.names import has_names, plain, shown
from gfmd_numba.analysis.plots.looks import Looks
from gfmd_numba.analysis.plots.looks import looks as looks_of
from gfmd_numba.analysis.plots.style import LINE, STYLE, few_ticks, log_ticks, of_variable, scaled, with_unit
from gfmd_numba.analysis.selection import axes, ensemble_mean, groups, key
from gfmd_numba.arrays import Reals

_WIDE = 5.0  # ratio of the largest to the smallest value from which on an axis is logarithmic


ValuesOf = Callable[[xr.Dataset], tuple[Reals, Reals]]  # values (case) of cases, and their errors


def plot_parameter(dataset: xr.Dataset, variable: str) -> Figure:
    """Draw case means with standard errors against the parameter that has most values, a line for each set of others.

    A parameter of names, like files, is taken only where no number is varied, and no line joins its values.
    UnusableDataError for a dataset in which no parameter is varied.
    """
    if most_varied(dataset) is None:
        raise UnusableDataError(
            "you gave results in which no discretisation is varied, and no other parameter; "
            "gfmd allows results of a campaign with limits or a grid"
        )
    return over_parameter(dataset, lambda cases: ensemble_mean(cases, variable), of_variable(dataset, variable))


def over_parameter(dataset: xr.Dataset, values_of: ValuesOf, label: str) -> Figure:
    """Draw values of cases, with their errors, against the parameter that has most values."""
    name = most_varied(dataset) or next(iter(axes(dataset)))
    looks = looks_of(_without(dataset, name))
    with mpl.rc_context(STYLE):
        figure = Figure((5.6, 4.6), dpi=150, layout="constrained")
        panel = figure.subplots()
        draw_values(panel, dataset, values_of, name, looks)
        panel.set_ylabel(label)
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


def draw_values(panel: Axes, dataset: xr.Dataset, values_of: ValuesOf, name: str, looks: Looks) -> None:
    """Draw values of cases, with their errors, against a parameter, a line for each set of others."""
    values = _axis(panel, dataset[name])
    for parameters, group in groups(_without(dataset, name).assign_coords(_value=("case", values))):
        ordered = group.sortby("_value")
        value, error = values_of(ordered)
        look = looks.of[key(parameters)] | ({"linestyle": "none"} if has_names(dataset[name]) else {})
        panel.errorbar(ordered["_value"].values, value, error, ms=5.5, capsize=2.5, lw=1.3, **look)
    if panel.get_xscale() == "log":
        log_ticks(panel.xaxis)


def _without(dataset: xr.Dataset, name: str) -> xr.Dataset:
    """Cases without a parameter, unless it is the only one."""
    return dataset.drop_vars(name) if len(list(axes(dataset))) > 1 else dataset


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
    else:
        few_ticks(panel.xaxis)
    panel.set_xlabel(label)
    return np.asarray(values, dtype=float)
