"""Figure of a campaign, drawn without pyplot so that no state is shared."""

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

from gfmd_numba.analysis.arguments import Variable, checked
from gfmd_numba.analysis.fit_dataset import in_the_limit
from gfmd_numba.analysis.forms import CAMPAIGN, FIT
from gfmd_numba.analysis.plots.parameter import Key, Looks, looks_of, plot_parameter
from gfmd_numba.analysis.plots.style import Width, add_legend, first_columns, of_variable, sheet, small, usual
from gfmd_numba.analysis.selection import (
    at_nyquist,
    discretisations,
    ensemble_mean,
    good,
    groups,
    key,
    select_limit,
)
from gfmd_numba.arrays import Reals
from gfmd_numba.text.input_error import InputError

_OF_FIT = ("limit", "reference_eps", "curve_eps", "curve")
_PANELS = {
    "eps_c": ("Continuum limit", r"$1/\varepsilon_c = \lambda_s/2\Delta x$"),
    "eps_f": ("Fractal limit", r"$1/\varepsilon_f = \lambda_l/\lambda_s$"),
    "eps_t": ("Thermodynamic limit", r"$1/\varepsilon_t = L_x/\lambda_l$"),
}


@checked
def plot_campaign(
    dataset: Annotated[xr.Dataset, CAMPAIGN],
    fit: Annotated[xr.Dataset, FIT] | None = None,
    variable: Variable = "kappa",
    width: Width | None = None,
) -> Figure:
    """Draw case means with standard errors against 1/eps, one panel per varied limit, with a fit.

    The fit is the output of fit_tfc; open markers are kappa from counted contact nodes. Without limits the means are
    drawn against a parameter. ValueError for an unknown variable, a fit of another variable, or a dataset in which
    nothing is varied.
    """
    good(dataset, variable)
    shown = [name for name in (variable, "kappa_counted", "status") if name in dataset.data_vars]
    dataset = dataset[shown]  # all others would be copied for each group
    present = [limit for limit in discretisations(dataset) if np.unique(select_limit(dataset, limit)[limit]).size > 1]
    if not present:
        return plot_parameter(_without_cross_levels(dataset), variable, width)
    if fit is not None and fit.attrs["variable"] != variable:
        raise InputError(
            f"fit: you gave one of {fit.attrs['variable']!r}; gfmd allows one of {variable!r}, as is drawn"
        )
    looks = looks_of(dataset)
    fitted = {} if fit is None else _fitted(fit, looks)
    widths = [3.0] * len(present) + [1.3] * bool(fitted)
    size = (max(sum(widths), 5.0) + 0.6) / len(widths), 4.0
    grid: dict[str, Any] = {"least": 1.65, "sharey": True, "width_ratios": widths}
    with sheet(len(widths), len(widths), size, width, **grid) as (figure, panels):
        for axis, limit in zip(panels, present, strict=False):
            _draw_limit(axis, select_limit(dataset, limit), limit, variable, looks, fitted)
        if fitted:
            _draw_extrapolated(panels[-1], fitted, looks)
        low, high = _usual_means(dataset, variable, fitted)
        panels[0].set_ylim(max(panels[0].get_ylim()[0], low), min(panels[0].get_ylim()[1], high))
        for axis in first_columns(panels):
            axis.set_ylabel(of_variable(dataset, variable))
        for axis in panels:
            axis.grid(axis="y")
        handles: list[Artist] = [Line2D([], [], **look) for look in looks.of.values()]
        if variable == "kappa" and "kappa_counted" in dataset:
            handles.append(Line2D([], [], color="0.5", marker="o", fillstyle="none", ls="", label="nodes counted"))
        if len(looks.of) > 1:
            said = "Markers are shifted sideways, so that their error bars can be seen."
            figure.supxlabel(said, fontsize=small(), color="0.35")
        if fitted:
            handles.append(Line2D([], [], color="0.4", ls=":", label=r"limit along a panel, $1/\varepsilon\to\infty$"))
        if any(map(_omits_nyquist, fitted.values())) and at_nyquist(dataset["eps_c"]).any():
            handles.append(Patch(color="0.94", label="not fitted"))
            panels[present.index("eps_c")].axvspan(0.85, 1.2, color="0.94", zorder=0)
        add_legend(figure, handles, -(-len(handles) // max(1, len(handles) // 4)))
    return figure


def _usual_means(dataset: xr.Dataset, variable: str, fitted: dict[Key, xr.Dataset]) -> tuple[float, float]:
    """Return the ends of an axis for all limits and means that are no outliers, with room for error bars."""
    drawn = [ensemble_mean(dataset, name)[0] for name in (variable, "kappa_counted") if name in dataset]
    low, high = usual(np.concatenate([*drawn, [float(in_the_limit(fit)[0]) for fit in fitted.values()]]))
    room = 0.5 * (high - low) or abs(high) or 1.0
    return low - room, high + room


def _without_cross_levels(dataset: xr.Dataset) -> xr.Dataset:
    """Dataset whose cases all stand at a reference, if it is one without limits that marks references."""
    references = dataset["is_reference"].values
    return dataset.isel(case=references) if references.any() else dataset


def _fitted(fit: xr.Dataset, looks: Looks) -> dict[Key, xr.Dataset]:
    """Fit of each group that has one, by its parameters; raises InputError for a fit of other groups."""
    if not {*looks.names, *_OF_FIT} <= fit.variables.keys():
        raise InputError("fit: you gave a fit of other parameters; gfmd allows that of the same dataset")
    accepted = fit.isel(group=np.flatnonzero(fit["fit_status"].values == "ok"))
    single = [accepted.isel(group=index) for index in range(accepted.sizes["group"])]
    found = {key({name: float(group[name]) for name in looks.names}): group for group in single}
    if not found.keys() <= looks.of.keys():
        raise InputError("fit: you gave a fit of other groups; gfmd allows that of the same dataset")
    return found


def _omits_nyquist(fit: xr.Dataset) -> bool:
    """Whether the fit of a group left out the cases at eps_c = 1."""
    reference = float(fit["reference_eps"].sel(limit="eps_c"))
    return fit.attrs["omit_nyquist"] == "True" and not at_nyquist(reference)


def _draw_limit(
    axis: Axes,
    cases: xr.Dataset,
    limit: str,
    variable: str,
    looks: Looks,
    fitted: dict[Key, xr.Dataset],
) -> None:
    order = list(looks.of)
    # neighbours stand a little apart so that error bars of different groups do not hide each other
    spacing = min(0.06, 0.3 / len(order))
    for parameters, group in groups(cases):
        physics = key(parameters)
        look = looks.of[physics]
        position = np.exp(spacing * (order.index(physics) - (len(order) - 1) / 2)) / group[limit].values
        if variable == "kappa" and "kappa_counted" in group:
            counted, _ = ensemble_mean(group, "kappa_counted")
            axis.plot(position, counted, look["marker"], color=look["color"], mfc="none", mew=0.7, zorder=1)
        mean, error = ensemble_mean(group, variable)
        axis.errorbar(position, mean, error, fmt=look["marker"], color=look["color"])
        if physics in fitted:
            one = fitted[physics].sel(limit=limit)
            axis.plot(1 / one["curve_eps"], one["curve"], look["linestyle"], c=look["color"])
            axis.axhline(_limit_along(fitted[physics], limit), ls=":", lw=0.8, color=look["color"], zorder=1)
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


def _limit_along(fit: xr.Dataset, limit: str) -> float:
    """Return what the fit tends to along one limit, the others at the reference."""
    corrections = fit["correction"].where(fit["limit"] != limit).sum()
    interactions = fit["interaction"].where(~fit["pair"].str.contains(limit)).sum()
    return float(fit[f"{fit.attrs['variable']}_tfc"] + corrections + interactions)


def _draw_extrapolated(axis: Axes, fitted: dict[Key, xr.Dataset], looks: Looks) -> None:
    for each, fit in fitted.items():
        look = looks.of[each]
        position, (value, error) = looks.position(each), map(float, in_the_limit(fit))
        axis.errorbar(position, value, error, fmt=look["marker"], color=look["color"])
    axis.set_xticks(range(len(looks.coloured)), [f"{value:g}" for value in looks.coloured])
    axis.tick_params(axis="x", rotation=90 if len(looks.coloured) > 4 else 0)
    axis.set(title="TFC limit", xlabel=looks.label, xlim=(-0.6, len(looks.coloured) - 0.4))
