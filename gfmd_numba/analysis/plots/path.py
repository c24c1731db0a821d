"""Figure of a loading path, of one contact or a campaign: what each step prescribed, what came of it, what was lost."""

from functools import partial
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from gfmd_numba.analysis.forms import CAMPAIGN, UnusableDataError
from gfmd_numba.analysis.plots.campaign import Looks, draw_values, looks_of, most_varied
from gfmd_numba.analysis.plots.style import Width, add_legend, drawn, few_ticks, prefix, sheet, small
from gfmd_numba.analysis.selection import axes, ensemble_mean, good, groups, key
from gfmd_numba.arrays import Reals
from gfmd_numba.text.numbers import typical

_ARROWS = 5  # along a loop
_JUMP = 0.2  # least part of all that happens along a path
_OF_PATH = {"hysteresis": ("Energy lost per area", "E^*L_x"), "pull_off_pressure": ("Pull-off pressure", "E^*")}

_OVER = {
    "step": ("Step", ""),
    "step_sliding": ("Sliding of the punch", "L_x"),
    "step_sliding_y": ("Sliding of the punch along $y$", "L_x"),
}
_AREA = "contact_area_fraction", "Contact area fraction", ""
_LOADS = ("punch_displacement", "line_load", "force", "prescribed_pressure", "reduced_pressure")  # of one contact
_OF_STEPS = (
    *("mean_pressure", "contact_area_fraction", "mean_tangential_traction", "mean_tangential_traction_y"),
    *("mean_worn_depth", "stick_fraction", "energy_lost", "status"),
)


class _Panel(NamedTuple):
    """One variable over another along the path, with labels and what stands for their unit 1; "" for a pure number."""

    x: str
    y: str
    label: str
    natural: str


@drawn
def plot_path(dataset: xr.Dataset, width: Width | None = None) -> Figure:
    """Draw a contact or a campaign along a path: what came of each step, and of the path against a parameter.

    Of a campaign these are means over the realisations, and of cases that differ in their grid alone the finest
    reference is drawn. Raises UnusableDataError for a dataset of no path, or of none that is ok.
    """
    if "case" not in dataset.dims and "step" in dataset.dims and set(_LOADS) & set(map(str, dataset.coords)):
        dataset = _as_campaign(dataset)
    else:
        dataset = CAMPAIGN.checked(dataset, "dataset")
    if not {"step_load", "mean_pressure", "contact_area_fraction"} <= dataset.variables.keys():
        raise UnusableDataError("you gave no loading path; gfmd allows what `gfmd solve` or `gfmd run` leaves of one")
    if not (dataset["status"] == 0).any():
        raise UnusableDataError("you gave no path that is ok; gfmd allows one with runs that are ok")
    references = dataset.isel(case=dataset["is_reference"].values)
    finest = [group["case"].values[int(group["nx"].values.argmax())] for _, group in groups(references)]
    dataset = references.sel(case=finest)
    varied, looks = most_varied(dataset), looks_of(_of_varied(dataset))
    panels = _along(dataset)
    of_path = [name for name in _OF_PATH if varied and name in dataset and good(dataset, name).any()]
    count = len(panels) + len(of_path)
    with sheet(count, 3 if count == 3 and width else 2, (5.0, 3.6), width) as (figure, drawn):
        for axis, panel in zip(drawn, panels, strict=False):
            _draw(axis, dataset, panel, looks)
        for axis, name in zip(drawn[len(panels) :], of_path, strict=False):
            label, natural = _OF_PATH[name]
            drawn_values = dataset[name].where(good(dataset, name)).mean("realisation", keep_attrs=True)
            factor, unit = prefix(drawn_values, natural, typical)
            others = looks_of(dataset.drop_vars(varied or ""))
            values_of = partial(ensemble_mean, variable=name)
            draw_values(axis, dataset.assign({name: factor * dataset[name]}), values_of, varied or "", others)
            axis.set(ylabel=f"{label} ({unit})")
        for axis in drawn:
            axis.grid()
        if len(looks.of) > 1:
            add_legend(figure, [Line2D([], [], **look) for look in looks.of.values()], 4)
    return figure


def _as_campaign(contact: xr.Dataset) -> xr.Dataset:
    """Return the path of one contact as that of a campaign with one case and one realisation."""
    load = next(name for name in _LOADS if name in contact.coords)
    kept = contact.reset_coords(drop=True)[[name for name in _OF_STEPS if name in contact]]
    prescribed = {"step_load": contact[load]} | {
        f"step_{name}": contact[name] for name in ("sliding", "sliding_y") if name in contact.coords
    }
    physics = {"long_name": "case", "units": "1", "axis": "physics"}
    return kept.expand_dims(["case", "realisation"]).assign_coords(
        {name: (("case", "step"), each.values[np.newaxis], each.attrs) for name, each in prescribed.items()}
        | {"case": [0], "is_reference": ("case", [True]), "nx": ("case", [1]), "contact": ("case", [0.0], physics)}
        | ({"punch_displacement": contact[load]} if load == "punch_displacement" else {})
    )


def _of_varied(dataset: xr.Dataset) -> xr.Dataset:
    """Dataset without the parameters that all cases share, as long as one is left."""
    shared = [name for name in axes(dataset) if np.unique(dataset[name]).size == 1]
    return dataset.drop_vars(shared if len(shared) < len(axes(dataset)) else shared[1:])


def _along(dataset: xr.Dataset) -> list[_Panel]:
    """What is drawn over the steps: nothing of a load that does not change, or of an effect that the scene has not."""
    panels = []
    if float(np.ptp(dataset["step_load"].values, axis=1).max()) > 0.0:
        by_displacement = "punch_displacement" in dataset.variables
        panels.append(_Panel("step_load", *(("mean_pressure", "Mean pressure", "E^*") if by_displacement else _AREA)))
    for y, along in (("", ""), ("_y", " along $y$")):
        x, traction = f"step_sliding{y}", f"mean_tangential_traction{y}"
        if x in dataset.variables and dataset[x].any():
            if traction in dataset:
                panels.append(_Panel(x, traction, f"Mean tangential traction{along}", "E^*"))
            if "mean_worn_depth" in dataset:
                panels.append(_Panel(x, "mean_worn_depth", "Mean worn depth", "L_x"))
                panels.append(_Panel(x, *_AREA))
    if "stick_fraction" in dataset:
        panels.append(_Panel("step", "stick_fraction", "Sticking share of the contact", ""))
    if "energy_lost" in dataset and dataset["energy_lost"].any():
        panels.append(_Panel("step", "energy_lost", "Energy lost so far per area", "E^*L_x"))
    return panels or [_Panel("step", *_AREA)]


def _draw(axis: Axes, dataset: xr.Dataset, panel: _Panel, looks: Looks) -> None:
    """Draw one variable over another, a line for each case with its look."""
    x = dataset[panel.x]
    mean = dataset[panel.y].where(dataset["status"] == 0).mean("realisation")
    if panel.y == "energy_lost":
        mean = mean.cumsum("step", skipna=False)
    mean.attrs = dataset[panel.y].attrs
    load = ("Prescribed load", "E^*") if x.attrs.get("units", "1") != "1" else ("Reduced pressure $p^*$", "")
    if "punch_displacement" in dataset.variables:
        load = "Punch displacement", "L_x"
    label, natural = _OVER.get(panel.x, load)
    across, unit_across = prefix(x, natural, typical) if natural else (1.0, "")
    up, unit_up = prefix(mean, panel.natural, typical) if panel.natural else (1.0, "")
    for parameters, group in groups(
        _of_varied(dataset).assign_coords(_place=("case", np.arange(dataset.sizes["case"])))
    ):
        place = int(group["_place"][0])
        look = {name: value for name, value in looks.of[key(parameters)].items() if name != "label"}
        values = x.values if panel.x == "step" else x.values[place]
        axis.plot(across * values, up * mean.values[place], ms=0.7 * mpl.rcParams["lines.markersize"], **look)
        if panel.x != "step":
            _mark_way(axis, across * values, up * mean.values[place], look["color"])
        if panel.x == "step_load":
            lost = dataset["energy_lost"][place].mean("realisation").values if "energy_lost" in dataset else None
            _mark_jumps(axis, across * values, up * mean.values[place], lost)
    if panel.x == "step":
        axis.xaxis.set_major_locator(MaxNLocator("auto", integer=True))
    else:
        few_ticks(axis.xaxis)
    axis.set_xlabel(f"{label} ({unit_across})" if unit_across else label)
    axis.set_ylabel(f"{panel.label} ({unit_up})" if unit_up else panel.label)


def _mark_way(axis: Axes, x: Reals, y: Reals, colour: str) -> None:
    """Draw arrows at equal distances along a loop."""
    steps = np.stack([np.diff(each) for each in (x, y)])
    lengths = np.hypot(*(each / (np.ptp(drawn) or 1.0) for each, drawn in zip(steps, (x, y), strict=True)))
    ends = np.nancumsum(lengths)
    for share in (np.arange(_ARROWS) + 0.5) / _ARROWS:
        i = int(np.searchsorted(ends, share * ends[-1]))
        if lengths[i] > 0.0:
            tail, head = ((x[i] + t * steps[0, i], y[i] + t * steps[1, i]) for t in (0.45, 0.55))
            look = {"arrowstyle": "-|>", "color": colour, "mutation_scale": 1.6 * small()}
            axis.annotate("", head, tail, arrowprops=look | {"shrinkA": 0.0, "shrinkB": 0.0})


def _mark_jumps(axis: Axes, x: Reals, y: Reals, lost: Reals | None) -> None:
    """Name the steps in which a contact jumps: they lose energy, and far more happens than in both neighbours."""
    size = abs(np.diff(y))
    before, after = np.r_[np.inf, size[:-1]], np.r_[size[1:], np.inf]
    jumps = (size > _JUMP * np.ptp(y)) & (size > 3.0 * np.maximum(before, after))
    for i in np.flatnonzero(jumps if lost is None else jumps & (lost[1:] > 0.0)):
        axis.plot(x[i : i + 2], y[i : i + 2], ":", color="white", marker="")
        said = axis.annotate("jump", (x[i + 1], 0.5 * (y[i] + y[i + 1])), (12, 0), textcoords="offset points")
        said.set(fontsize=small(), path_effects=[withStroke(linewidth=2.0, foreground="white")])
