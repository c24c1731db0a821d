"""Figure of means, or of limits, against a parameter, drawn without pyplot so that no state is shared."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.fit_dataset import in_the_limit
from gfmd_numba.analysis.forms import FIT, UnusableDataError
from gfmd_numba.analysis.names import has_names, plain, shown
from gfmd_numba.analysis.plots.style import (
    MARKERS,
    Width,
    add_legend,
    few_ticks,
    log_ticks,
    of_variable,
    ordered_colours,
    scaled,
    sheet,
    with_unit,
)
from gfmd_numba.analysis.selection import axes, ensemble_mean, groups, key
from gfmd_numba.arrays import Reals
from gfmd_numba.text.numbers import si_prefix

_DASHES = ("-", "--", ":", "-.")

Key = tuple[float, ...]  # parameters of a group
Look = dict[str, Any]


@dataclass(frozen=True)
class Looks:
    """The look of each group by its parameters `names`, of which `column` has the colours and the label `label`."""

    of: dict[Key, Look]
    names: tuple[str, ...]
    column: int
    label: str

    @property
    def coloured(self) -> list[float]:
        """Values that have a colour each."""
        return sorted({each[self.column] for each in self.of})

    @property
    def others(self) -> list[Key]:
        """Sets of all other parameters, which have a marker each."""
        return sorted({_others_of(each, self.column) for each in self.of})

    def position(self, each: Key) -> float:
        """Where a group stands among others of its colour, 1 from one colour to the next."""
        others = self.others
        shift = others.index(_others_of(each, self.column)) - (len(others) - 1) / 2
        return self.coloured.index(each[self.column]) + 0.5 * shift / len(others)


def looks_of(dataset: xr.Dataset) -> Looks:
    """Look of each group: a colour for each Hurst exponent if it varies, or value of the first parameter that does."""
    names = axes(dataset)
    keys = [key(parameters) for parameters, _ in groups(dataset)]
    varied = [i for i in range(len(names)) if len({each[i] for each in keys}) > 1]
    column = names.index("hurst") if "hurst" in names else 0
    if varied and column not in varied:
        column = varied[0]
    found = Looks({each: {} for each in sorted(keys)}, names, column, _label(dataset[names[column]]))
    coloured, others = found.coloured, found.others
    told = sorted({column, *varied})
    palette = ordered_colours(len(coloured))
    for each, look in found.of.items():
        style, colour = others.index(_others_of(each, column)), coloured.index(each[column])
        look |= {
            "color": palette[colour],
            "marker": MARKERS[(style if len(others) > 1 else colour) % len(MARKERS)],
            "linestyle": _DASHES[style % len(_DASHES)],
            "label": _told([(dataset[names[i]], each[i]) for i in told]),
        }
    return found


def _others_of(each: Key, column: int) -> Key:
    return each[:column] + each[column + 1 :]


def _label(axis: xr.DataArray) -> str:
    return with_unit(str(axis.attrs.get("label", axis.name)), axis)


def _told(parameters: list[tuple[xr.DataArray, float]]) -> str:
    """Names that values stand for, and a formula of all other values."""
    names = [plain(shown(axis, [value])[0]) for axis, value in parameters if has_names(axis)]
    formula = ", ".join(_value(axis, value) for axis, value in parameters if not has_names(axis))
    return ", ".join([*names, f"${formula}$"] if formula else names)


def _value(axis: xr.DataArray, value: float) -> str:
    """Symbol, value and unit of a parameter within a formula."""
    unit = axis.attrs.get("units", "1")
    factor, unit = (1.0, unit) if unit == "1" else si_prefix(abs(value), unit)
    symbol = str(axis.attrs.get("label", axis.name)).strip("$")
    return f"{symbol} = {factor * value:g}".replace("inf", r"\infty") + (rf"\,\mathrm{{{unit}}}" if unit != "1" else "")


_WIDE = 5.0  # ratio of the largest to the smallest value from which on an axis is logarithmic


ValuesOf = Callable[[xr.Dataset], tuple[Reals, Reals]]  # values (case) of cases, and their errors


def plot_parameter(dataset: xr.Dataset, variable: str, width: Width | None) -> Figure:
    """Draw case means with standard errors against the parameter that has most values, a line for each set of others.

    A parameter of names, like files, is taken only where no number is varied, and no line joins its values.
    UnusableDataError for a dataset in which no parameter is varied.
    """
    if most_varied(dataset) is None:
        raise UnusableDataError(
            "you gave results in which no discretisation is varied, and no other parameter; "
            "gfmd allows results of a campaign with limits or a grid"
        )
    label = of_variable(dataset, variable)
    return over_parameter(dataset, lambda cases: ensemble_mean(cases, variable), label, width)


def over_parameter(dataset: xr.Dataset, values_of: ValuesOf, label: str, width: Width | None) -> Figure:
    """Draw values of cases, with their errors, against the parameter that has most values."""
    name = most_varied(dataset) or next(iter(axes(dataset)))
    looks = looks_of(_without(dataset, name))
    with sheet(1, 1, (5.6, 4.0), width) as (figure, (panel,)):
        draw_values(panel, dataset, values_of, name, looks)
        panel.set_ylabel(label)
        panel.grid(axis="y")
        if len(looks.of) > 1:
            add_legend(figure, [Line2D([], [], **look) for look in looks.of.values()], 2)
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
        panel.errorbar(ordered["_value"].values, value, error, **look)
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


_SYMBOLS = {"kappa": r"$\kappa$", "kappa_counted": r"$\kappa$ of counted nodes", "kappa_r": r"$\kappa_r$"}


@checked
def plot_fit(fit: Annotated[xr.Dataset, FIT], width: Width | None = None) -> Figure:
    """Draw the limits that `fit_tfc` found, with standard errors, against the parameter that has most values.

    Groups whose fit is refused are left out. UnusableDataError for anything but a fit, or one without a limit.
    """
    variable = str(fit.attrs.get("variable"))
    if not {f"{variable}_tfc", f"{variable}_tfc_error", "fit_status"} <= set(fit.variables) or not axes(fit):
        raise UnusableDataError("you gave no fit; gfmd allows what `gfmd fit -o` leaves")
    accepted = fit[[f"{variable}_tfc", f"{variable}_tfc_error"]].isel(group=(fit["fit_status"] == "ok").values)
    if not accepted.sizes["group"]:
        raise UnusableDataError("you gave a fit that was refused in every group; gfmd allows one with a limit")
    label = with_unit(f"{_SYMBOLS.get(variable, variable)} in the TFC limit", fit[f"{variable}_tfc"])
    return over_parameter(accepted.drop_vars("group").rename(group="case"), _limits, label, width)


def _limits(groups: xr.Dataset) -> tuple[Reals, Reals]:
    value, error = in_the_limit(groups)
    return value.values, error.values
