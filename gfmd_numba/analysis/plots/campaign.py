"""Figures of a campaign: means over its limits, or means and limits over a parameter; drawn without pyplot."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import NullLocator
from numpy.typing import NDArray

from gfmd_numba.analysis import selection
from gfmd_numba.analysis.arguments import Variable
from gfmd_numba.analysis.fit_dataset import in_the_limit
from gfmd_numba.analysis.forms import CAMPAIGN, FIT, UnusableDataError
from gfmd_numba.analysis.plots import style
from gfmd_numba.analysis.plots.style import MARKERS, Width, drawn
from gfmd_numba.analysis.selection import groups, values_as_text
from gfmd_numba.arrays import Reals
from gfmd_numba.text.input_error import InputError
from gfmd_numba.text.numbers import si_prefix

_TILTED = {"rotation": 20, "ha": "right"}
_DASHES = ("-", "--", ":", "-.")

Key = tuple[float, ...]  # parameters of a group
Look = dict[str, Any]
_WIDE = 5.0  # ratio of the largest to the smallest value from which on an axis is logarithmic
_OF_FIT = ("limit", "reference_eps", "curve_eps", "curve")
_NOTHING_VARIES = (
    "results in which no discretisation is varied, and no other parameter; gfmd allows results of a campaign with "
    "limits or a grid"
)
_PANELS = {
    "eps_c": ("Continuum limit", r"$1/\varepsilon_c = \lambda_s/2\Delta x$"),
    "eps_f": ("Fractal limit", r"$1/\varepsilon_f = \lambda_l/\lambda_s$"),
    "eps_t": ("Thermodynamic limit", r"$1/\varepsilon_t = L_x/\lambda_l$"),
}


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
    names = selection.axes(dataset)
    keys = [selection.key(parameters) for parameters, _ in groups(dataset)]
    varied = [i for i in range(len(names)) if len({each[i] for each in keys}) > 1]
    column = names.index("hurst") if "hurst" in names else 0
    if varied and column not in varied:
        column = varied[0]
    found = Looks({each: {} for each in sorted(keys)}, names, column, _label(dataset[names[column]]))
    coloured, others = found.coloured, found.others
    told = sorted({column, *varied})
    palette = style.ordered_colours(len(coloured))
    for each, look in found.of.items():
        dashes, colour = others.index(_others_of(each, column)), coloured.index(each[column])
        look |= {
            "color": palette[colour],
            "marker": MARKERS[(dashes if len(others) > 1 else colour) % len(MARKERS)],
            "linestyle": _DASHES[dashes % len(_DASHES)],
            "label": _told([(dataset[names[i]], each[i]) for i in told]),
        }
    return found


def _others_of(each: Key, column: int) -> Key:
    return each[:column] + each[column + 1 :]


def _label(axis: xr.DataArray) -> str:
    return style.with_unit(str(axis.attrs.get("label", axis.name)), axis)


def _told(parameters: list[tuple[xr.DataArray, float]]) -> str:
    """Names that values stand for, and a formula of all other values."""
    names = [
        selection.without_formula(values_as_text(axis, [value])[0])
        for axis, value in parameters
        if selection.has_names(axis)
    ]
    formula = ", ".join(_value(axis, value) for axis, value in parameters if not selection.has_names(axis))
    return ", ".join([*names, f"${formula}$"] if formula else names)


def _value(axis: xr.DataArray, value: float) -> str:
    """Symbol, value and unit of a parameter within a formula."""
    unit = axis.attrs.get("units", "1")
    factor, unit = (1.0, unit) if unit == "1" else si_prefix(abs(value), unit)
    symbol = str(axis.attrs.get("label", axis.name)).strip("$")
    return f"{symbol} = {style.in_formula(f'{factor * value:g}')}" + (rf"\,\mathrm{{{unit}}}" if unit != "1" else "")


ValuesOf = Callable[[xr.Dataset], tuple[Reals, Reals]]  # values (case) of cases, and their errors


def over_parameter(dataset: xr.Dataset, values_of: ValuesOf, label: str, width: Width | None) -> Figure:
    """Draw values of cases, with their errors, against the parameter that has most values, a line for each other set.

    A parameter of names, like files, is taken only where no number is varied, and no line joins its values.
    """
    name = most_varied(dataset) or next(iter(selection.axes(dataset)))
    looks = looks_of(_without(dataset, name))
    with style.sheet(1, 1, (5.6, 4.0), width) as (figure, (panel,)):
        draw_values(panel, dataset, values_of, name, looks)
        panel.set_ylabel(label)
        panel.grid(axis="y")
        if len(looks.of) > 1:
            style.add_legend(figure, [Line2D([], [], **look) for look in looks.of.values()], 2)
    return figure


def most_varied(dataset: xr.Dataset) -> str | None:
    """The parameter that has most values, one of numbers if there is any; None where no parameter is varied."""
    sizes = {name: np.unique(dataset[name]).size for name in selection.axes(dataset)}
    name = max(sizes, key=lambda each: (sizes[each] > 1 and not selection.has_names(dataset[each]), sizes[each]))
    return name if sizes[name] > 1 else None


def draw_values(panel: Axes, dataset: xr.Dataset, values_of: ValuesOf, name: str, looks: Looks) -> None:
    """Draw values of cases, with their errors, against a parameter, a line for each set of others."""
    values = _axis(panel, dataset[name])
    for parameters, group in groups(_without(dataset, name).assign_coords(_value=("case", values))):
        ordered = group.sortby("_value")
        value, error = values_of(ordered)
        look = looks.of[selection.key(parameters)] | (
            {"linestyle": "none"} if selection.has_names(dataset[name]) else {}
        )
        panel.errorbar(ordered["_value"].values, value, error, **look)
    if panel.get_xscale() == "log":
        style.log_ticks(panel.xaxis)


def _without(dataset: xr.Dataset, name: str) -> xr.Dataset:
    """Cases without a parameter, unless it is the only one."""
    return dataset.drop_vars(name) if len(list(selection.axes(dataset))) > 1 else dataset


def _axis(panel: Axes, parameter: xr.DataArray) -> NDArray[np.float64]:
    """Where the values of a parameter stand on its axis, side by side if they are names or one of them is infinite."""
    label = str(parameter.attrs.get("label", parameter.name))
    named = selection.has_names(parameter)
    if named or not np.isfinite(parameter).all():
        levels, position = np.unique(parameter, return_inverse=True)
        told, look = [f"{level:g}" for level in levels], dict[str, Any]()
        if named:
            told, look = list(map(selection.without_formula, values_as_text(parameter, levels))), _TILTED
        panel.set_xticks(range(len(levels)), told, **look)
        panel.set_xlabel(style.with_unit(label, parameter))
        return position.astype(float)
    values, label = (
        (parameter.values, label) if parameter.attrs.get("units", "1") == "1" else style.scaled(parameter, label, "")
    )
    if values.min() > 0.0 and values.max() > _WIDE * values.min():
        panel.set_xscale("log")
    else:
        style.few_ticks(panel.xaxis)
    panel.set_xlabel(label)
    return np.asarray(values, dtype=float)


@drawn
def plot_fit(fit: Annotated[xr.Dataset, FIT], width: Width | None = None) -> Figure:
    """Draw the limits that `fit_tfc` found, with standard errors, against the parameter that has most values.

    Groups whose fit is refused are left out. UnusableDataError for anything but a fit, or one without a limit.
    """
    variable = str(fit.attrs.get("variable"))
    name = f"{variable}_tfc"
    if not {name, f"{name}_error", "fit_status"} <= set(fit.variables) or not selection.axes(fit):
        raise UnusableDataError("you gave no fit; gfmd allows what `gfmd fit -o` leaves")
    accepted = fit[[name, f"{name}_error"]].isel(group=(fit["fit_status"] == "ok").values)
    if not accepted.sizes["group"]:
        raise UnusableDataError("you gave a fit that was refused in every group; gfmd allows one with a limit")
    label = style.with_unit(f"{style.symbol(variable)} in the TFC limit", fit[name])
    accepted = accepted.drop_vars("group").rename(group="case")
    return over_parameter(accepted, lambda each: (each[name].values, each[f"{name}_error"].values), label, width)


@drawn
def plot_campaign(
    dataset: Annotated[xr.Dataset, CAMPAIGN],
    fit: Annotated[xr.Dataset, FIT] | None = None,
    variable: Variable = "kappa",
    width: Width | None = None,
) -> Figure:
    """Draw case means with standard errors against 1/eps, one panel per varied limit, with a fit.

    The fit is the output of fit_tfc; open markers are kappa from counted contact nodes. Without limits the means are
    drawn against a parameter. ValueError for an unknown variable, a fit of another one, or data without variation.
    """
    selection.good(dataset, variable)
    read = [name for name in (variable, "kappa_counted", "status") if name in dataset.data_vars]
    dataset = dataset[read]  # all others would be copied for each group
    present = [
        limit
        for limit in selection.discretisations(dataset)
        if np.unique(selection.select_limit(dataset, limit)[limit]).size > 1
    ]
    if not present:
        references = dataset["is_reference"].values  # a campaign without limits may mark none
        dataset = dataset.isel(case=references | ~references.any())
        if most_varied(dataset) is None:
            raise UnusableDataError(f"you gave {_NOTHING_VARIES}")
        label = style.of_variable(dataset, variable)
        return over_parameter(dataset, partial(selection.means, variable=variable), label, width)
    if fit is not None and fit.attrs["variable"] != variable:
        raise InputError.of("fit", f"one of {fit.attrs['variable']!r}", f"one of {variable!r}, as is drawn")
    looks = looks_of(dataset)
    fitted = {} if fit is None else _fitted(fit, looks)
    widths = [3.0] * len(present) + [1.3] * bool(fitted)
    size = (max(sum(widths), 5.0) + 0.6) / len(widths), 4.0
    grid: dict[str, Any] = {"least": 1.65, "sharey": True, "width_ratios": widths}
    with style.sheet(len(widths), len(widths), size, width, **grid) as (figure, panels):
        for axis, limit in zip(panels, present, strict=False):
            _draw_limit(axis, selection.select_limit(dataset, limit), limit, variable, looks, fitted)
        if fitted:
            _draw_extrapolated(panels[-1], fitted, looks)
        low, high = _usual_means(dataset, variable, fitted)
        panels[0].set_ylim(max(panels[0].get_ylim()[0], low), min(panels[0].get_ylim()[1], high))
        for axis in panels:
            axis.grid(axis="y")
            if axis.get_subplotspec().is_first_col():  # type: ignore[union-attr]
                axis.set_ylabel(style.of_variable(dataset, variable))
        handles: list[Artist] = [Line2D([], [], **look) for look in looks.of.values()]
        if variable == "kappa" and "kappa_counted" in dataset:
            handles.append(Line2D([], [], color="0.5", marker="o", fillstyle="none", ls="", label="nodes counted"))
        if len(looks.of) > 1:
            said = "Markers are shifted sideways,\nso that their error bars can be seen."
            said = said if width == "single" else said.replace("\n", " ")
            figure.supxlabel(said, fontsize=style.small(), color="0.35")
        if fitted:
            handles.append(Line2D([], [], color="0.4", ls=":", label=r"limit along a panel, $1/\varepsilon\to\infty$"))
        at = [float(each["reference_eps"].sel(limit="eps_c")) for each in fitted.values()]
        omits = fit is not None and fit.attrs["omit_nyquist"] == "True"
        if omits and not all(map(selection.at_nyquist, at)) and selection.at_nyquist(dataset["eps_c"]).any():
            handles.append(Patch(color="0.94", label="not fitted"))
            panels[present.index("eps_c")].axvspan(0.85, 1.2, color="0.94", zorder=0)
        style.add_legend(figure, handles, -(-len(handles) // max(1, len(handles) // 4)))
    return figure


def _usual_means(dataset: xr.Dataset, variable: str, fitted: dict[Key, xr.Dataset]) -> tuple[float, float]:
    """Return the ends of an axis for all limits and means that are no outliers, with room for error bars."""
    drawn = [selection.means(dataset, name)[0] for name in (variable, "kappa_counted") if name in dataset]
    low, high = style.usual(np.concatenate([*drawn, [float(in_the_limit(fit)[0]) for fit in fitted.values()]]))
    room = 0.5 * (high - low) or abs(high) or 1.0
    return low - room, high + room


def _fitted(fit: xr.Dataset, looks: Looks) -> dict[Key, xr.Dataset]:
    """Fit of each group that has one, by its parameters; raises InputError for a fit of other groups."""
    if not {*looks.names, *_OF_FIT} <= fit.variables.keys():
        raise InputError.of("fit", "a fit of other parameters", "that of the same dataset")
    accepted = fit.isel(group=np.flatnonzero(fit["fit_status"].values == "ok"))
    single = [accepted.isel(group=index) for index in range(accepted.sizes["group"])]
    found = {selection.key({name: float(group[name]) for name in looks.names}): group for group in single}
    if not found.keys() <= looks.of.keys():
        raise InputError.of("fit", "a fit of other groups", "that of the same dataset")
    return found


def _draw_limit(
    axis: Axes, cases: xr.Dataset, limit: str, variable: str, looks: Looks, fitted: dict[Key, xr.Dataset]
) -> None:
    order = list(looks.of)
    # neighbours stand a little apart so that error bars of different groups do not hide each other
    spacing = min(0.06, 0.3 / len(order))
    for parameters, group in groups(cases):
        physics = selection.key(parameters)
        look = looks.of[physics]
        position = np.exp(spacing * (order.index(physics) - (len(order) - 1) / 2)) / group[limit].values
        if variable == "kappa" and "kappa_counted" in group:
            counted, _ = selection.means(group, "kappa_counted")
            axis.plot(position, counted, look["marker"], color=look["color"], mfc="none", mew=0.7, zorder=1)
        mean, error = selection.means(group, variable)
        axis.errorbar(position, mean, error, fmt=look["marker"], color=look["color"])
        if physics in fitted:
            one = fitted[physics].sel(limit=limit)
            axis.plot(1 / one["curve_eps"], one["curve"], look["linestyle"], c=look["color"])
            others = fitted[physics]["correction"].where(fitted[physics]["limit"] != limit).sum()
            pairs = fitted[physics]["interaction"].where(~fitted[physics]["pair"].str.contains(limit)).sum()
            tends_to = float(in_the_limit(fitted[physics])[0] + others + pairs)
            axis.axhline(tends_to, ls=":", lw=0.8, color=look["color"], zorder=1)
    title, label = _PANELS[limit]
    levels = np.unique(1 / cases[limit].values)
    axis.set_xscale("log")
    labels = [f"{level:.8g}" for level in levels]
    axis.set_xticks(levels, labels, rotation=90 if _collide(labels, levels) else 0)
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set(title=title, xlabel=label)


def _collide(labels: list[str], levels: Reals) -> bool:
    """Whether labels of neighbouring levels meet below a panel, which has room for some 26 characters."""
    room = 26.0 * np.diff(np.log(levels)) / np.ptp(np.log(levels))
    return any(0.5 * len(one + other) + 0.6 > gap for (one, other), gap in zip(pairwise(labels), room, strict=True))


def _draw_extrapolated(axis: Axes, fitted: dict[Key, xr.Dataset], looks: Looks) -> None:
    for each, fit in fitted.items():
        look = looks.of[each]
        position, (value, error) = looks.position(each), map(float, in_the_limit(fit))
        axis.errorbar(position, value, error, fmt=look["marker"], color=look["color"])
    axis.set_xticks(range(len(looks.coloured)), [f"{value:g}" for value in looks.coloured])
    axis.tick_params(axis="x", rotation=90 if len(looks.coloured) > 4 else 0)
    axis.set(title="TFC limit", xlabel=looks.label, xlim=(-0.6, len(looks.coloured) - 0.4))
