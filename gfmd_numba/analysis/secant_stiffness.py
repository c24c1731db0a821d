"""Contact stiffness: how much mean pressure brings the mean planes of two rough surfaces nearer."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated

import numpy as np
import xarray as xr

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.forms import CAMPAIGN, LOADS, UnusableDataError
from gfmd_numba.analysis.selection import axes, good, table

_LOAD = "reduced_pressure"
_SAME_LOAD = 1e-9  # relative difference of mean pressures that is rounding, as where a load dwells
_OTHER_LOADS = ("prescribed_pressure", "line_load", "force")  # which it follows from


@checked
def secant_stiffness(dataset: Annotated[xr.Dataset, LOADS]) -> xr.Dataset:
    """Return the secant stiffness K = -(difference of p) / (that of the mean gap) `[interval]` of neighbouring loads.

    The gap is that of the surfaces as they were made: a hardness flattens them, which brings them nearer, too.
    The surfaces are the same at both loads; the `contact_stiffness` of a load curve is the tangent.
    Takes a campaign of several `reduced_pressure`, whose cases are equal except for the load, or the `step` of load
    paths, perhaps of several realisations. Without a period the approach of the punch takes the place of the gap. K, in
    Pa/m (E*/L_x without units), leaves out the uniform compression of the bodies. It is the difference of the mean
    pressures over that of the mean gaps. Its standard error (nan for one surface) is that of these differences over the
    realisations that are ok at both loads, nan where these are the same. K stands at the logarithmic mean of the two
    loads, where it is exact if K is proportional to p, as at light loads (Akarapu, Sharp and Robbins, PRL 106, 204301,
    2011; Campana, Persson and Mueser, J. Phys.: Condens. Matter 23, 085001, 2011: K = p / (gamma h_rms)). Where K goes
    as p^a it is too large by the share a (1 - a) ln(p_2 / p_1)^2 / 24, which the standard error leaves out. If the
    dataset has heights over x, or an `rms_height`, `stiffness_reduced` is K h_rms / p, with the h_rms of each surface.
    Raises UnusableDataError for results without two loads of the same surfaces.
    """
    along = "case" if "case" in dataset.dims else "step"
    if along not in dataset.dims:
        raise UnusableDataError("you gave no results of several loads; gfmd allows a campaign's, or those of a path")
    if along == "case":
        dataset = CAMPAIGN.checked(dataset, "dataset")
    pairs = list(_cases(dataset) if along == "case" else pairwise(range(dataset.sizes["step"])))
    if not pairs:
        raise UnusableDataError("you gave one load of each surface; gfmd allows several reduced_pressure, or a path")
    ends = (xr.DataArray(list(positions), dims="interval") for positions in zip(*pairs, strict=True))
    lower, upper = (dataset.isel({along: positions}) for positions in ends)
    others = [str(dim) for dim in dataset["mean_gap"].dims if dim != along]
    usable = (lower["status"] == 0) & (upper["status"] == 0)
    usable = usable & np.isfinite(lower["mean_gap"]) & np.isfinite(upper["mean_gap"])
    rise = upper["mean_pressure"] - lower["mean_pressure"]
    usable = usable & (abs(rise) > _SAME_LOAD * abs(upper["mean_pressure"]))
    rise = rise.where(usable)
    approach = (nearness(upper) - nearness(lower)).where(usable)
    load = _logarithmic_mean(lower["mean_pressure"], upper["mean_pressure"]).where(usable)
    result = xr.Dataset(attrs={"title": "contact stiffness"})
    result["mean_pressure"] = load.mean(others)
    result["stiffness"], result["stiffness_error"] = _ratio(rise, approach, others)
    nodes = [dim for dim in ("y", "x") if dim in lower.dims]
    if "rms_height" in lower or ("height" in lower and nodes):
        heights = lower["rms_height"] if "rms_height" in lower else lower["height"].std(nodes)
        reduced = _ratio(rise / load, approach / heights, others)
        result["stiffness_reduced"], result["stiffness_reduced_error"] = reduced
    result["n_realisations"] = usable.astype(np.int64).sum(others)
    if _LOAD in dataset.coords:
        at = _logarithmic_mean(lower[_LOAD], upper[_LOAD])
        result = result.assign_coords({_LOAD: ("interval", at.values, dataset[_LOAD].attrs)})
    return _described(result, dataset)


def nearness(of: xr.Dataset) -> xr.DataArray:
    """How near the surfaces are, from any origin: the approach of the punch, or with a period that of the mean planes.

    A hardness flattens the punch. The gap is measured from there, and the planes are those of the surfaces as made.
    """
    return of["approach"] if "approach" in of else of.get("mean_plastic_depth", 0.0) - of["mean_gap"]


def _cases(dataset: xr.Dataset) -> Iterator[tuple[int, int]]:
    """Positions of cases that are neighbours in load and otherwise equal."""
    usable = good(dataset, "mean_gap").any("realisation").values
    if _LOAD not in dataset.coords:
        return
    same = (name for name in (*axes(dataset), *axes(dataset, "discretisation")) if name not in (_LOAD, *_OTHER_LOADS))
    rows = table(dataset, (*same, _LOAD))
    members: dict[bytes, list[int]] = {}
    for index in np.lexsort(rows.T):
        if usable[index] and np.isfinite(rows[index, -1]):
            members.setdefault(rows[index, :-1].tobytes(), []).append(int(index))
    for loads in members.values():
        yield from pairwise(loads)


def _logarithmic_mean(lower: xr.DataArray, upper: xr.DataArray) -> xr.DataArray:
    """(b - a) / ln(b / a), which lies between the loads; nan unless both are above 0 and not the same."""
    both: xr.DataArray = (lower > 0) & (upper > 0) & (lower != upper)
    a, b = lower.where(both), upper.where(both)
    mean: xr.DataArray = (b - a) / np.log(b / a)
    return mean


def _ratio(above: xr.DataArray, below: xr.DataArray, over: list[str]) -> tuple[xr.DataArray, xr.DataArray]:
    """Ratio of two means over paired realisations, and its standard error to first order."""
    ratio = above.mean(over) / below.mean(over)
    n = (above - ratio * below).count(over)
    variance: xr.DataArray = ((above - ratio * below) ** 2).sum(over) / (n - 1).where(n > 1) / n
    return ratio, variance**0.5 / abs(below.mean(over))


_LONG_NAMES = {
    "mean_pressure": "logarithmic mean of the two loads",
    "stiffness": "contact stiffness beyond uniform compression",
    "stiffness_error": "standard error of the contact stiffness over surfaces, without that of the difference of loads",
    "stiffness_reduced": "contact stiffness times rms height over pressure",
    "stiffness_reduced_error": "standard error of that",
    "n_realisations": "surfaces that are ok at both loads, which differ",
}


def _described(result: xr.Dataset, dataset: xr.Dataset) -> xr.Dataset:
    pressure, gap = (dataset[name].attrs.get("units", "1") for name in ("mean_pressure", "mean_gap"))
    per = {"1": pressure, "m": "m-1" if pressure == "1" else f"{pressure} m-1"}.get(gap, f"{pressure} / {gap}")
    unit = {"mean_pressure": pressure, "stiffness": per, "stiffness_error": per}
    for name in map(str, result.data_vars):
        result[name].attrs = {"long_name": _LONG_NAMES[name], "units": unit.get(name, "1")}
    return result
