"""Distributions of pressure, gap and segment length of single contacts, Persson's theory beside them, and a picture."""

from collections.abc import Callable

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.figure import Figure

from gfmd_numba.analysis.plots.style import STYLE, ordered_colours
from gfmd_numba.analysis.selection import UnusableDataError
from gfmd_numba.arrays import Reals
from gfmd_numba.theory import persson

_BINS = 60


def contact_statistics(dataset: xr.Dataset) -> xr.Dataset:
    """Return distributions of pressure, gap and segment length over the nodes of line contacts.

    The dataset is what `gfmd solve` leaves. The results have the shapes `[..., pressure]`, `[..., gap]` and
    `[..., length]`. Pressures are in units of their rms fluctuation in full contact (g E*/2 for a half-space), gaps in
    rms heights of the punch, and lengths in L_x. `pressure_density` integrates to the fraction of nodes that touch,
    `gap_density` to the fraction that does not. `pressure_density_persson` is (4.9). `segments` counts the stretches of
    contact whose number of nodes lies between two powers of 2, at their geometric mean. Dimensions other than `x`, like
    `step` or one along which results were concatenated, stay. Raises UnusableDataError for a dataset without these
    fields, or of a run that is not ok.
    """
    needed = {"x", "height", "pressure", "gap", "mean_pressure", "full_contact_pressure", "status"}
    if not needed <= dataset.variables.keys() or "y" in dataset.dims:
        raise UnusableDataError("given no results of a line contact; allowed: what `gfmd solve` leaves of one")
    fields = [dataset[name] for name in ("height", "pressure", "gap")]
    numbers = all(dataset[name].dtype.kind in "fiu" for name in needed)
    over_x = dataset.sizes.get("x", 0) >= 4 and all(field.size and "x" in field.dims for field in fields)
    if not numbers or not over_x or any(set(dataset[name].dims) - set(fields[1].dims) for name in needed):
        raise UnusableDataError("given altered results; allowed: what `gfmd solve` leaves of a line contact")
    if (dataset["status"] != 0).any():
        raise UnusableDataError("given a run that is not ok; allowed: contacts in equilibrium, whose status is 0")
    touching = dataset["gap"] == 0.0
    pressure = dataset["pressure"] / dataset["full_contact_pressure"]
    gap = dataset["gap"] / dataset["height"].std("x")
    lowest = min(0.0, float(pressure.where(touching).min()))  # an adhesive law may pull on touching nodes
    pressures = np.linspace(lowest, float(pressure.max()) or 1.0, _BINS + 1)
    gaps = np.linspace(0.0, float(gap.max()) or 1.0, _BINS + 1)
    octaves = 2.0 ** np.arange(np.log2(dataset.sizes["x"]) + 1)
    result = xr.Dataset(attrs={"title": "statistics of a rough contact"})
    result["pressure_density"] = _histogram(pressure.where(touching), "pressure", pressures, _density)
    result["gap_density"] = _histogram(gap.where(~touching), "gap", gaps, _density)
    result["segments"] = _histogram(touching, "length", octaves, _segments)
    result["pressure"] = ("pressure", 0.5 * (pressures[1:] + pressures[:-1]))
    result["gap"] = ("gap", 0.5 * (gaps[1:] + gaps[:-1]))
    result["length"] = ("length", np.sqrt(octaves[1:] * octaves[:-1]) / dataset.sizes["x"])
    result["pressure_density_persson"] = xr.apply_ufunc(
        persson.pressure_density, result["pressure"], dataset["mean_pressure"] / dataset["full_contact_pressure"], 1.0
    ).transpose(*result["pressure_density"].dims, missing_dims="ignore")
    for name, long_name in _LONG_NAMES.items():
        result[name].attrs = {"long_name": long_name, "units": "1"}
    return result


_LONG_NAMES = {
    "pressure": "pressure over its rms fluctuation in full contact",
    "gap": "gap over the rms height of the punch",
    "length": "length of a stretch of contact over L_x",
    "pressure_density": "density of the pressures of touching nodes, per node of the interface",
    "pressure_density_persson": "density of the pressures in contact by Persson's theory",
    "gap_density": "density of the gaps beside the contact, per node of the interface",
    "segments": "number of stretches of contact of about that length",
}


def _histogram(
    nodes: xr.DataArray, dim: str, edges: Reals, function: Callable[[npt.NDArray[np.generic], Reals], Reals]
) -> xr.DataArray:
    result: xr.DataArray = xr.apply_ufunc(
        function, nodes, kwargs={"edges": edges}, input_core_dims=[["x"]], output_core_dims=[[dim]], vectorize=True
    )
    return result


def _density(row: npt.NDArray[np.generic], edges: Reals) -> Reals:
    return np.asarray(np.histogram(row, edges)[0] / (row.size * np.diff(edges)))


def _segments(row: npt.NDArray[np.generic], edges: Reals) -> Reals:
    """Number of stretches by their number of nodes; full contact is one of them."""
    if row.all():
        return np.asarray(np.histogram([row.size], edges)[0])
    begins_free = np.roll(row, -int(np.argmin(row)))  # so that no stretch is cut by the end of the period
    changes = np.flatnonzero(np.diff(begins_free.astype(np.int8), append=0))
    return np.asarray(np.histogram(changes[1::2] - changes[::2], edges)[0])


def plot_statistics(statistics: xr.Dataset) -> Figure:
    """Draw the distributions of `contact_statistics`, one colour a `step`, averaged over other dims."""
    others = set(map(str, statistics.dims)) - {"step", "pressure", "gap", "length"}
    mean = statistics.mean(others)
    steps = [mean.isel(step=i) for i in range(mean.sizes["step"])] if "step" in mean.dims else [mean]
    colours = ordered_colours(len(steps))
    with mpl.rc_context(STYLE):
        figure = Figure((12.0, 4.0), dpi=150, layout="constrained")
        pressure, gap, length = figure.subplots(1, 3)
        for i, step in enumerate(steps):
            colour = colours[i]
            label = rf"$\bar{{p}}^* = {float(step.reduced_pressure):g}$" if "reduced_pressure" in step else f"step {i}"
            pressure.stairs(step["pressure_density"], _edges(step["pressure"]), color=colour, label=label)
            pressure.plot(step["pressure"], step["pressure_density_persson"], "--", color=colour, lw=1.2)
            gap.stairs(step["gap_density"], _edges(step["gap"]), color=colour)
            length.plot(step["length"], step["segments"].where(step["segments"] > 0), "o-", ms=4, color=colour)
        pressure.plot([], [], "--", color="0.4", label="Persson")
        pressure.set(xlabel=r"$p\,/\,p_\mathrm{rms}$ of full contact", ylabel="Density", ylim=(0, None))
        gap.set(xlabel="Gap over rms height", ylabel="Density", yscale="log")
        length.set(xlabel=r"Segment length over $L_x$", ylabel="Segments", xscale="log", yscale="log")
        figure.legend(loc="outside upper center", ncols=len(steps) + 1)
    return figure


def _edges(centres: xr.DataArray) -> Reals:
    values = centres.values
    half = 0.5 * (values[1] - values[0])
    return np.append(values - half, values[-1] + half)
