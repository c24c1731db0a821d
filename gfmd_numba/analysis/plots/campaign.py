"""Figures of campaigns and of single contacts, drawn without pyplot so that no state is shared."""

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import NullLocator
from numpy.typing import NDArray

from gfmd_numba.analysis.selection import (
    GROUP,
    LIMITS,
    UnusableDataError,
    at_nyquist,
    ensemble_mean,
    good,
    groups,
    key,
    select_limit,
)

# Okabe and Ito: told apart with any colour vision
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
_MARKERS = ("o", "s", "^", "D", "v", "P")
_DASHES = ("-", "--", ":", "-.")
STYLE: dict[Any, Any] = {
    "font.size": 11,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
}
_AXES = {
    "eps_c": ("Continuum limit", r"$1/\varepsilon_c = \lambda_s/2\Delta x$"),
    "eps_f": ("Fractal limit", r"$1/\varepsilon_f = \lambda_l/\lambda_s$"),
    "eps_t": ("Thermodynamic limit", r"$1/\varepsilon_t = L_x/\lambda_l$"),
}
_SYMBOLS = dict(zip(GROUP, ("H", r"\nu", "a", r"\bar{p}^*", r"\bar{g}", r"\gamma"), strict=True))
_KAPPA = r"$\kappa = a_r\,E^*\bar{g}\,/\,\bar{p}$"
_PREFIXES = (
    (1e9, "G"),
    (1e6, "M"),
    (1e3, "k"),
    (1.0, ""),
    (1e-3, "m"),
    (1e-6, "µ"),
    (1e-9, "n"),
    (1e-12, "p"),
)

_Look = dict[str, Any]
_LINE = 0.34  # inches of a line of the legend


def plot_campaign(dataset: xr.Dataset, fit: xr.Dataset | None = None, variable: str = "kappa") -> Figure:
    """Draw case means with standard errors against 1/eps, one panel per varied limit, with a fit.

    The fit is the output of fit_tfc; open markers are kappa from counted contact nodes; ValueError for an
    unknown variable, a fit of another variable, or a dataset in which no discretisation is varied.
    """
    good(dataset, variable)
    present = [limit for limit in LIMITS if np.unique(select_limit(dataset, limit)[limit]).size > 1]
    if not present:
        raise UnusableDataError("given results in which no discretisation is varied; allowed: results with limits")
    if fit is not None and fit.attrs["variable"] != variable:
        raise ValueError(f"the fit is of {fit.attrs['variable']!r}, the figure of {variable!r}")
    fitted = dict(_fitted(fit)) if fit is not None else {}
    looks = _looks(dataset)
    widths = [3.0] * len(present) + [1.3] * bool(fitted)
    with mpl.rc_context(STYLE):
        figure = Figure((max(sum(widths), 5.0) + 0.6, 4.6), dpi=150, layout="constrained")
        axes = figure.subplots(1, len(widths), sharey=True, squeeze=False, width_ratios=widths)[0]
        for axis, limit in zip(axes, present, strict=False):
            _draw_limit(axis, select_limit(dataset, limit), limit, variable, looks, fitted)
        if fitted:
            _draw_extrapolated(axes[-1], fitted, looks)
        long_name = dataset[variable].attrs.get("long_name", variable)
        axes[0].set_ylabel(_KAPPA if variable == "kappa" else _with_unit(long_name, dataset[variable]))
        for axis in axes:
            axis.grid(axis="y", color="0.9", linewidth=0.8)
        handles: list[Artist] = [Line2D([], [], **look) for look in looks.values()]
        if variable == "kappa" and "kappa_counted" in dataset:
            handles.append(Line2D([], [], color="0.5", marker="o", fillstyle="none", ls="", label="nodes counted"))
        if any(map(_omits_nyquist, fitted.values())) and at_nyquist(dataset["eps_c"]).any():
            handles.append(Patch(color="0.94", label="not fitted"))
            axes[present.index("eps_c")].axvspan(0.85, 1.2, color="0.94", zorder=0)
        longest = max(len(str(handle.get_label()).replace("\\", "")) for handle in handles)
        fitting = max(1, int(figure.get_figwidth() / (0.6 + 0.085 * longest)))  # inches of a column of the legend
        rows = -(-len(handles) // fitting)
        figure.set_figheight(4.6 + _LINE * max(0, rows - 3))  # the panels keep their height
        figure.legend(handles=handles, loc="outside upper center", ncols=-(-len(handles) // rows))
    return figure


def _looks(dataset: xr.Dataset) -> dict[tuple[float, ...], _Look]:
    """Return each group's look: a colour per Hurst exponent, a marker and dashes per set of the others."""
    keys = [key(parameters) for parameters, _ in groups(dataset)]
    hursts = sorted({each[0] for each in keys})
    others = sorted({each[1:] for each in keys})
    varied = [i for i in range(len(GROUP)) if i == 0 or len({each[i] for each in keys}) > 1]
    looks: dict[tuple[float, ...], _Look] = {}
    for each in sorted(keys):
        style = others.index(each[1:])
        values = [rf"{_SYMBOLS[GROUP[i]]} = {each[i]:g}".replace("inf", r"\infty") for i in varied]
        looks[each] = {
            "color": COLOURS[hursts.index(each[0]) % len(COLOURS)],
            "marker": _MARKERS[style % len(_MARKERS)],
            "linestyle": _DASHES[style % len(_DASHES)],
            "label": f"${', '.join(values)}$",
        }
    return looks


def _fitted(fit: xr.Dataset) -> list[tuple[tuple[float, ...], xr.Dataset]]:
    accepted = fit.isel(group=np.flatnonzero(fit["fit_status"].values == "ok"))
    single = [accepted.isel(group=index) for index in range(accepted.sizes["group"])]
    return [(key({name: float(group[name]) for name in GROUP}), group) for group in single]


def _omits_nyquist(fit: xr.Dataset) -> bool:
    """Whether the fit of a group left out the cases at eps_c = 1."""
    reference = float(fit["reference_eps"].sel(limit="eps_c"))
    return fit.attrs["omit_nyquist"] == "True" and not at_nyquist(reference)


def _draw_limit(
    axis: Axes,
    cases: xr.Dataset,
    limit: str,
    variable: str,
    looks: dict[tuple[float, ...], _Look],
    fitted: dict[tuple[float, ...], xr.Dataset],
) -> None:
    order = list(looks)
    # neighbours stand a little apart so that error bars of different groups do not hide each other
    spacing = min(0.06, 0.3 / len(order))
    for parameters, group in groups(cases):
        physics = key(parameters)
        look = looks[physics]
        position = np.exp(spacing * (order.index(physics) - (len(order) - 1) / 2)) / group[limit].values
        if variable == "kappa" and "kappa_counted" in group:
            counted, _ = ensemble_mean(group, "kappa_counted")
            axis.plot(position, counted, look["marker"], color=look["color"], mfc="none", ms=6, alpha=0.45)
        mean, error = ensemble_mean(group, variable)
        axis.errorbar(position, mean, error, fmt=look["marker"], color=look["color"], ms=5.5, capsize=2.5, lw=1.3)
        if physics in fitted:
            _draw_curve(axis, fitted[physics], limit, group[limit].values, look)
    title, label = _AXES[limit]
    levels = np.unique(1 / cases[limit].values)
    axis.set_xscale("log")
    axis.set_xticks(levels, [f"{level:g}" for level in levels])
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set(title=title, xlabel=label)


def _draw_curve(axis: Axes, fit: xr.Dataset, limit: str, levels: NDArray[np.float64], look: _Look) -> None:
    if limit == "eps_c" and _omits_nyquist(fit):
        levels = levels[~at_nyquist(levels)]
    eps = np.geomspace(levels.max() * 1.1, levels.min() / 1.25, 100)
    others = float(fit["kappa_tfc"] + fit["correction"].drop_sel(limit=limit).sum())
    one = fit.sel(limit=limit)
    axis.plot(1 / eps, others + float(one["C"]) * eps ** float(one["alpha"]), look["linestyle"], c=look["color"])


def _draw_extrapolated(
    axis: Axes, fitted: dict[tuple[float, ...], xr.Dataset], looks: dict[tuple[float, ...], _Look]
) -> None:
    hursts = sorted({each[0] for each in looks})
    others = sorted({each[1:] for each in looks})
    for each, fit in fitted.items():
        look = looks[each]
        shift = 0.5 * (others.index(each[1:]) - (len(others) - 1) / 2) / len(others)
        position, value, error = (
            hursts.index(each[0]) + shift,
            float(fit["kappa_tfc"]),
            float(fit["kappa_tfc_error"]),
        )
        axis.errorbar(position, value, error, fmt=look["marker"], color=look["color"], ms=6.5, capsize=3, lw=1.3)
    axis.set_xticks(range(len(hursts)), [f"{hurst:g}" for hurst in hursts])
    axis.set(title="TFC limit", xlabel="Hurst $H$", xlim=(-0.6, len(hursts) - 0.4))


def plot_contact(dataset: xr.Dataset) -> Figure:
    """Draw one contact in the dataset's units: punch and body over x, pressure below; or maps of gap and pressure.

    Of a path of loadings the last one is drawn; UnusableDataError for a dataset without these fields.
    """
    if not {"x", "displacement", "gap", "pressure"} <= dataset.variables.keys():
        raise UnusableDataError("given no results of a contact; allowed: what `gfmd solve` leaves of one")
    dataset = dataset.isel(step=-1) if "step" in dataset.dims else dataset
    if "y" in dataset.dims:
        return _plot_map(dataset)
    x, x_label = scaled(dataset["x"], "Position $x$", "L_x")
    body = dataset["displacement"] + dataset.get("body_height", 0.0)
    body.attrs = dataset["displacement"].attrs
    punch = body + dataset["gap"]
    above_it = "other body" if "counter_body_height" in dataset else "rigid punch"
    factor, unit = _prefix(body, "L_x")
    low, high = factor * body.values, factor * punch.values
    pressure, pressure_label = scaled(dataset["pressure"], "Pressure $p$", "E^*")
    with mpl.rc_context(STYLE):
        figure = Figure((9.0, 5.4), dpi=150, layout="constrained")
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 2])
        # valleys of the punch rise far above the contact: the view follows the body
        span = max(np.ptp(low), 1e-3 * np.ptp(high)) or 1.0
        bottom, top = low.min() - 0.25 * span, min(high.max() + 0.1 * span, low.max() + 0.6 * span)
        above.fill_between(x, high, max(top, high.max()), color="0.82", lw=0, label=above_it)
        above.fill_between(x, bottom, low, color="#BBD9EC", lw=0, label="elastic body")
        above.plot(x, high, color="0.35", lw=1.0)
        above.plot(x, low, color=COLOURS[0], lw=1.2)
        above.set(ylabel=f"Height ({unit})", ylim=(bottom, top), xlim=(x[0], x[-1]))
        below.fill_between(x, pressure, color=COLOURS[1], alpha=0.35, lw=0)
        below.plot(x, pressure, color=COLOURS[1], lw=0.9)
        below.axhline(pressure.mean(), color="0.25", lw=1.0, ls="--", label=r"mean $\bar{p}$")
        below.set(xlabel=x_label, ylabel=pressure_label)
        if pressure.min() >= 0:
            below.set_ylim(bottom=0)
        handles = [*above.get_legend_handles_labels()[0], *below.get_legend_handles_labels()[0]]
        figure.legend(handles=handles, loc="outside upper right", ncols=3)
    return figure


def _plot_map(dataset: xr.Dataset) -> Figure:
    """Gap and pressure over the interface, as far as most of either goes."""
    (x, x_label), (y, y_label) = (scaled(dataset[dim], f"Position ${dim}$", "L_x") for dim in ("x", "y"))
    with mpl.rc_context(STYLE):
        figure = Figure((9.6, 4.4), dpi=150, layout="constrained")
        drawn = (("gap", "Gap", "L_x", "Blues_r"), ("pressure", "Pressure $p$", "E^*", "inferno"))
        for axis, (name, text, natural, colours) in zip(figure.subplots(1, 2, sharey=True), drawn, strict=True):
            values, label = scaled(dataset[name], text, natural)
            most = float(np.quantile(values[values > 0.0], 0.98)) if (values > 0.0).any() else None
            mesh = axis.imshow(
                values, colours, origin="lower", vmin=0.0, vmax=most, extent=(0.0, x[-1] + x[1], 0.0, y[-1] + y[1])
            )
            axis.set(xlabel=x_label)
            figure.colorbar(mesh, ax=axis, label=label, extend="max", shrink=0.9)
        figure.axes[0].set(ylabel=y_label)
    return figure


def _with_unit(text: str, variable: xr.DataArray) -> str:
    unit = variable.attrs.get("units", "1")
    return text if unit == "1" else f"{text} ({unit})"


def scaled(variable: xr.DataArray, text: str, natural: str) -> tuple[NDArray[np.float64], str]:
    """Values in the SI prefix that suits them, and their label; `natural` stands for the unit 1."""
    factor, unit = _prefix(variable, natural)
    return factor * variable.values, f"{text} ({unit})"


def _prefix(variable: xr.DataArray, natural: str) -> tuple[float, str]:
    """Return factor and label of the SI prefix that suits the values; natural stands for the unit 1."""
    unit = variable.attrs.get("units", "1")
    largest = float(abs(variable).max())
    if unit == "1":
        power = int(np.floor(np.log10(largest))) if largest else 0
        return (1.0, f"${natural}$") if -2 <= power <= 3 else (10.0**-power, rf"$10^{{{power}}}\,{natural}$")
    if unit not in ("m", "Pa"):
        return 1.0, unit
    scale, prefix = next(((s, p) for s, p in _PREFIXES if largest >= s), _PREFIXES[-1] if largest else (1.0, ""))
    return 1 / scale, prefix + unit
