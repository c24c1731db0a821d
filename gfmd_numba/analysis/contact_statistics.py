"""Distributions of pressure and gap, sizes of contacts and Persson's theory for them, of solved contacts."""

from collections.abc import Callable
from typing import Annotated

import numpy as np
import numpy.typing as npt
import scipy  # its modules load with their first use
import xarray as xr

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.channels import sizes
from gfmd_numba.analysis.forms import CONTACT, check_fields, goes_around
from gfmd_numba.arrays import Flags, Reals
from gfmd_numba.arrays.regions import on_wall, regions
from gfmd_numba.text.recorded_scene import asked, has_form
from gfmd_numba.theory import persson

_BINS = 60


@checked
def contact_statistics(dataset: Annotated[xr.Dataset, CONTACT]) -> xr.Dataset:
    """Return distributions over the nodes of solved contacts, `[..., pressure | gap | length or area]`.

    The dataset is what `gfmd solve` leaves. Pressures are in units of their rms fluctuation in full contact (g E*/2 for
    a half-space), gaps in rms heights of the punch, and lengths in L_x. `pressure_density` integrates to the fraction
    of nodes that touch, `gap_density` to the fraction that does not. `pressure_density_persson` is (4.9), and
    `contact_area_fraction_persson`, which estimates `contact_area_fraction`, is (4.16). The relaxed body under
    `relaxed_pressure` stands for one that creeps, exactly so while contact only grows. On profiles, `segments` counts
    the stretches of contact whose number of nodes lies between two powers of 2, at their geometric mean. On maps,
    `clusters` counts groups of nodes that share sides in the same way, over their `area`. `perimeter` is the length of
    the edges of all clusters, by Crofton's formula with the directions of edges: within 1 % from three nodes across on,
    and up to a quarter too small for single nodes. `mean_gap` is in rms heights. Of a punch with a form there are
    neither `mean_gap` nor Persson's estimates. Dimensions other than `y` and `x`, like `step` or one along which
    results were concatenated, stay. Raises UnusableDataError for a dataset without these fields, or of a run that is
    not ok.
    """
    creeps = "relaxed_pressure" in dataset
    nodes = check_fields(dataset, (*_NEEDED, *["relaxed_pressure"] * creeps))
    touching = on_wall(dataset["gap"])
    rms_height = dataset["height"].std(nodes)
    full_contact = dataset["full_contact_rms_pressure"]
    if creeps:  # of the modulus with which the body has crept so far
        stiffer = dataset["mean_pressure"] / dataset["relaxed_pressure"].mean(nodes)
        full_contact = full_contact * stiffer.where(stiffer > 0.0, 1.0)
    pressure, gap = dataset["pressure"] / full_contact, dataset["gap"] / rms_height
    lowest = min(0.0, float(pressure.where(touching).min()))  # an adhesive law may pull on touching nodes
    highest = float(pressure.max())  # below 0 where an adhesive law pulls and nothing touches
    pressures = np.linspace(lowest, highest if highest > lowest else lowest + 1.0, _BINS + 1)
    deepest, widest = min(0.0, float(gap.min())), float(gap.max())  # below 0 where a law lets surfaces overlap
    gaps = np.linspace(deepest, widest if widest > deepest else deepest + 1.0, _BINS + 1)
    result = xr.Dataset(attrs={"title": "statistics of a rough contact", **asked(dataset.attrs)})
    result["pressure_density"] = _histogram(pressure.where(touching), nodes, "pressure", pressures, _density)
    result["gap_density"] = _histogram(gap.where(~touching), nodes, "gap", gaps, _density)
    counted, size, of_edges = _CONTACTS[len(nodes)]
    total = np.prod([dataset.sizes[dim] for dim in nodes])
    octaves = 2.0 ** np.arange(np.log2(total) + 1)
    around = goes_around(dataset)
    result[counted] = _histogram(touching, nodes, size, octaves, _clusters, around=around)
    result["pressure"] = ("pressure", 0.5 * (pressures[1:] + pressures[:-1]))
    result["gap"] = ("gap", 0.5 * (gaps[1:] + gaps[:-1]))
    result[size] = (size, np.sqrt(octaves[1:] * octaves[:-1]) / total)
    if not has_form(dataset.attrs.get("scene", "{}")):
        result["mean_gap"] = gap.mean(nodes)
        # a hard wall bears no tension, of which Persson's formulas would make a negative contact area
        reduced = (dataset["mean_pressure"] / full_contact).clip(min=0.0)
        result["pressure_density_persson"] = xr.apply_ufunc(
            persson.pressure_density, result["pressure"], reduced, 1.0
        ).transpose(*result["pressure_density"].dims, missing_dims="ignore")
        result["contact_area_fraction_persson"] = xr.apply_ufunc(persson.contact_area_fraction, reduced, 1.0)
    if "contact_area_fraction" in dataset:
        result["contact_area_fraction"] = dataset["contact_area_fraction"]
    for name, measure in of_edges.items():
        result[name] = xr.apply_ufunc(
            measure, touching, kwargs={"around": around}, input_core_dims=[nodes], vectorize=True
        )
    for name in map(str, result.variables):
        if name in _LONG_NAMES:
            result[name].attrs = {"long_name": _LONG_NAMES[name], "units": "1"}
    return result


_SMOOTHED = 1.5  # nodes: straight edges at any angle are then right to 0.3 %, and discs of 3 nodes and more to 1 %
_NEEDED = ("height", "pressure", "gap", "mean_pressure", "full_contact_rms_pressure")
_LONG_NAMES = {
    "pressure": "pressure over its rms fluctuation in full contact",
    "gap": "gap over the rms height of the punch",
    "length": "length of a stretch of contact over L_x",
    "area": "area of a contact cluster over L_x^2",
    "pressure_density": "density of the pressures of touching nodes, per node of the interface",
    "pressure_density_persson": "density of the pressures in contact by Persson's theory",
    "gap_density": "density of the gaps outside the contact, per node of the interface",
    "segments": "number of stretches of contact of about that length",
    "clusters": "number of contact clusters of about that area",
    "perimeter": "length of the edges of all contact clusters over L_x",
    "mean_gap": "mean gap over the rms height of the punch",
    "contact_area_fraction_persson": "contact area fraction by Persson's theory",
}


def _histogram(
    values: xr.DataArray,
    nodes: list[str],
    dim: str,
    edges: Reals,
    function: Callable[..., Reals],
    **options: tuple[bool, ...],
) -> xr.DataArray:
    result: xr.DataArray = xr.apply_ufunc(
        function,
        values,
        kwargs={"edges": edges} | options,
        input_core_dims=[nodes],
        output_core_dims=[[dim]],
        vectorize=True,
    )
    return result


def _density(values: npt.NDArray[np.generic], edges: Reals) -> Reals:
    return np.asarray(np.histogram(values, edges)[0] / (values.size * np.diff(edges)))


def _clusters(touching: Flags, edges: Reals, around: tuple[bool, ...]) -> Reals:
    """Number of clusters by their number of nodes, also `around` the ends of a period; full contact is one of them."""
    return np.asarray(np.histogram(sizes(regions(touching, around)), edges)[0])


def _perimeter(touching: Flags, around: tuple[bool, ...]) -> float:
    """Length of the edges over L_x, from their crossings with lines through the nodes in four directions.

    Diagonal lines are sqrt(2) times as dense, and count 1 / sqrt(2): an edge with the normal (c, s), c, s >= 0, has c +
    s + sqrt(2) max(c, s) crossings a spacing. The gradient of the smoothed contact tells the normal. Where nothing goes
    `around` the map, nothing touches beyond its ends.
    """
    nx = touching.shape[1]
    touching = np.pad(touching, [(0, 0) if joined else (1, 1) for joined in around])
    modes = ["wrap" if joined else "constant" for joined in around]
    smooth = touching.astype(np.float32)
    slopes = [scipy.ndimage.gaussian_filter(smooth, _SMOOTHED, order, mode=modes) for order in ((0, 1), (1, 0))]
    length = 0.0
    for step in ((0, 1), (1, 0), (1, 1), (1, -1)):
        crossed = touching != np.roll(touching, step, (0, 1))
        c, s = (abs(slope + np.roll(slope, step, (0, 1)))[crossed] for slope in slopes)
        crossings = c + s + np.sqrt(2.0) * np.maximum(c, s)
        shares = np.divide(np.hypot(c, s), crossings, out=np.full(c.shape, np.pi / 8.0), where=crossings > 0.0)
        length += float(shares.sum() / np.hypot(*step))
    return float(length / nx)


# of profiles and of maps: how contacts are counted, and over what, and what is measured of their edges
_CONTACTS: dict[int, tuple[str, str, dict[str, Callable[..., float]]]] = {
    1: ("segments", "length", {}),
    2: ("clusters", "area", {"perimeter": _perimeter}),
}
