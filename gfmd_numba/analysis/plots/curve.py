"""Figures of curves: area, mean gap and peak pressure over the load, the time or the sliding speed."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gfmd_numba.analysis.forms import CURVES, UnusableDataError
from gfmd_numba.analysis.plots.style import COLOURS, Width, add_legend, drawn, least_span, log_ticks, prefix, sheet
from gfmd_numba.arrays import Reals
from gfmd_numba.text.numbers import typical
from gfmd_numba.text.recorded_scene import described, hardness

# variable, label, unit where the scene leaves E* or L_x open, whether it is drawn on a logarithmic axis
_Panel = tuple[str, str, str, bool]
_PANELS: tuple[_Panel, ...] = (
    ("contact_area_fraction", "Contact area fraction", "", True),
    ("mean_gap", r"Mean gap $\bar{u}$", "L_x", False),
    ("contact_stiffness", r"Stiffness $-d\bar{p}\,/\,d\bar{u}$", "E^*/L_x", True),
    ("peak_pressure", "Peak pressure", "E^*", True),
)
_OF_FORM: tuple[_Panel, ...] = (  # without a period
    ("contact_radius", "Contact radius", "L_x", True),
    ("approach", r"Approach $\delta$", "L_x", True),
    ("contact_stiffness", r"Stiffness $d\bar{p}\,/\,d\delta$", "E^*/L_x", True),
    _PANELS[3],
)
_PLASTIC = ("largest_plastic_strain", "Largest plastic strain", "", False)
_YIELDED = "plastic_area_fraction"
_LOADS = {"displacement": ("Punch displacement", "L_x"), "force": ("Force", ""), "line_load": ("Line load", "")}
_OVER_SPEED = (("hysteretic_friction", "Friction by hysteresis", "", False), *_PANELS[:2], _PANELS[3])
_IN_TIME = (*_PANELS[:2], ("n_segments", "Separate contacts", "", False), _PANELS[3])

_OVER = {"time": ("Time", "", _IN_TIME), "speed": ("Sliding speed", "L_x", _OVER_SPEED)}  # label, unit, panels


@drawn
def plot_curve(dataset: xr.Dataset, width: Width | None = None) -> Figure:
    """Draw a curve of `gfmd curve`: over the mean pressure or the load that was prescribed, the time, or the speed.

    Points that are not ok are left out, and those with a warning are hollow. Bands are standard errors over
    realisations. Raises UnusableDataError for a dataset that is no curve, or has no point with a result.
    """
    dim = next((each for each in CURVES if each in getattr(dataset, "variables", ())), "prescribed_load")
    dataset, variable = CURVES[dim].checked(dataset, "dataset"), dim
    if dim in _OVER:
        label, free, panels = _OVER[dim]
    else:
        panels = _OF_FORM if {"contact_radius", "approach"} <= dataset.variables.keys() else _PANELS
        label, free = _LOADS.get(dataset.attrs["prescribed"], ("", ""))
        if not label:
            variable, label, free = "mean_pressure", r"Mean pressure $\bar{p}$", "E^*"
    if _PLASTIC[0] in dataset:
        panels = (*panels, _PLASTIC)
    dataset = dataset.isel({dim: dataset["n_realisations"].values > 0})
    if not dataset.sizes[dim]:
        what = dim.removeprefix("prescribed_")
        raise UnusableDataError(f"you gave no {what} with a result; gfmd allows a curve with runs that are ok")
    over = dataset[variable]
    factor, unit = prefix(over, free, typical)
    counts = dataset["n_realisations"]
    least, most = int(counts.min()), int(counts.max())
    surfaces = f"{most}" if least == most else f"{least} to {most}"
    title = described(dataset.attrs.get("scene", "{}"), load=dim in _OVER)
    title = f"{title[:1].upper()}{title[1:]}"
    if most > 1:
        title = f"{title}\nMean of {surfaces} surfaces, band: standard error".lstrip()
    with sheet(len(panels), 2, (4.8, 3.2), width, title=title, sharex=True) as (figure, axes):
        for i, (axis, (name, text, natural, logarithmic)) in enumerate(zip(axes, panels, strict=True)):
            drawn = _draw(axis, dataset, name, text, natural, factor * over.values)
            if logarithmic and drawn.size and 0.0 < 10.0 * drawn.min() < drawn.max():
                axis.set_yscale("log")
                log_ticks(axis.yaxis)
            elif drawn.size:
                least_span(axis.yaxis)
            else:
                axis.text(0.5, 0.5, "infinite", transform=axis.transAxes, ha="center")
            if (over > 0).all() and float(over.max()) > 10.0 * float(over.min()):
                axis.set_xscale("log")
                log_ticks(axis.xaxis)
            if i + axis.get_gridspec().ncols >= len(axes):  # type: ignore[union-attr]
                axis.set_xlabel(f"{label} ({unit})")
                axis.tick_params(labelbottom=True)
        figure.align_ylabels()
        handles = {str(handle.get_label()): handle for axis in axes for handle in axis.get_legend_handles_labels()[0]}
        if handles:
            add_legend(figure, [*handles.values()], 2, "outside lower center")
    return figure


def _draw(axis: Axes, dataset: xr.Dataset, name: str, text: str, natural: str, x: Reals) -> Reals:
    """Draw one variable with its error; gives the values that are drawn."""
    known = np.isfinite(dataset[name].values)  # full contact is infinitely stiff
    finite = dataset[name][known]
    factor, unit = prefix(finite, natural, typical) if finite.size and natural else (1.0, "")
    values = factor * finite.values
    axis.plot(x[known], values, "o-", color=COLOURS[0])
    if "n_warned" in dataset and (warned := dataset["n_warned"].values[known] > 0).any():
        axis.plot(x[known][warned], values[warned], "o", color=COLOURS[0], mfc="white", label="with a warning")
    if f"{name}_standard_error" in dataset:
        error = factor * dataset[f"{name}_standard_error"].values[known]
        axis.fill_between(x[known], values - error, values + error, color=COLOURS[0], alpha=0.25, lw=0)
    if name == "contact_area_fraction" and _YIELDED in dataset:
        part = dataset[_YIELDED].where(dataset[_YIELDED] > 0.0)
        axis.plot(x, part, "s--", color=COLOURS[1], label="area at the hardness")
    if name == "peak_pressure" and (limit := hardness(dataset.attrs.get("scene", "{}"))) is not None:
        axis.axhline(factor * limit, color="0.25", ls=":", label="hardness")
    if name == "contact_stiffness":
        text = "Stiffness" if _YIELDED in dataset else text  # the gap is not all of the way where a punch is flattened
        # with E* or L_x where the scene leaves but one of them open
        pressure, gap = (dataset[each].attrs.get("units", "1") for each in ("mean_pressure", "mean_gap"))
        if (pressure == "1") != (gap == "1"):
            unit = f"{unit}$/L_x$" if gap == "1" else "$E^*$/m"
    axis.set_ylabel(f"{text} ({unit})" if unit else text)
    axis.grid()
    return values
