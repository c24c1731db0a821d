"""Points of a work-precision study: what a setting costs, and how far off what it measures is."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import isnan, nan

import numpy as np
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.dataset import cf_attributes

Values = Mapping[str, Reals]  # measures [realisation] or, along a path, [realisation, step]
KAPPA, AREA = "kappa", "contact_area_fraction"
OF_PATHS = ("hysteresis", "pull_off_pressure")


@dataclass(frozen=True)
class Point:
    """One setting: its relative error in kappa and the seconds a surface takes.

    `study` is what is varied, `curve` what else differs, `setting` its value; `failed` surfaces did not end ok. Where
    no step has a mean pressure above 0, and so a kappa, the `variable` is the contact area. Along a path the error is
    that of the step where it is largest, and what the path has as a whole has errors of its own.
    `next_order` is what the next order in the slope of rough bodies would add to a displacement (L_x). Errors that the
    contact does not have are nan.
    """

    study: str
    curve: str
    setting: float
    error: float
    seconds: float
    transforms: float
    failed: int
    variable: str = KAPPA
    hysteresis_error: float = nan
    pull_off_pressure_error: float = nan
    next_order: float = nan


_NAMES = {
    "study": ("what is varied", "1"),
    "curve": ("what else differs within the study", "1"),
    "setting": ("value of what is varied", "1"),
    "error": ("relative error of the variable, along a path where it is largest", "1"),
    "variable": ("what the error is about", "1"),
    "seconds": ("processor time of one surface", "s"),
    "transforms": ("Fourier transforms of one surface", "1"),
    "failed": ("surfaces that did not end ok", "1"),
}
OF_SOME = {  # columns that not every contact has
    "hysteresis_error": ("relative error of the hysteresis", "1"),
    "pull_off_pressure_error": ("relative error of the pull-off pressure", "1"),
    "next_order": ("what the next order in the slope would add to a displacement, over L_x", "1"),
}


def dataset(points: Iterable[Point]) -> xr.Dataset:
    """Studies as a dataset over (point), for netCDF, without columns that no point has."""
    rows = list(points)
    found = xr.Dataset()
    for name, (long_name, units) in (_NAMES | OF_SOME).items():
        values = [getattr(point, name) for point in rows]
        if name not in OF_SOME or not all(map(isnan, values)):
            found[name] = ("point", values, cf_attributes(long_name, units))
    return found


def relative_error(values: Reals, exact: Reals, *, of_means: bool = False) -> float:
    """Rms error of the surfaces that ended ok or, where it is a bias that counts, of their mean; nan if unknown.

    Of values [realisation, step] it is the largest over the steps at which most surfaces are known.
    """
    if exact.ndim == 2:
        steps = _known_steps(exact)
        return _largest(relative_error(values[:, i], exact[:, i], of_means=of_means) for i in steps)
    known = np.isfinite(exact)
    if not known.any() or exact[known].mean() == 0.0:
        return nan
    mean = abs(exact[known].mean())
    difference = values / mean - exact / mean
    good = np.isfinite(difference)
    if not good.any():
        return nan
    return float(abs(difference[good].mean()) if of_means else np.sqrt((difference[good] ** 2).mean()))


def sampling_error(values: Reals, number: int) -> float:
    """Relative standard error of the mean of a number of surfaces, along a path the largest; nan if unknown."""
    if values.ndim == 2:
        return _largest(sampling_error(values[:, i], number) for i in _known_steps(values))
    known = values[np.isfinite(values)]
    if len(known) < 2 or known.mean() == 0.0:
        return nan
    return float(np.std(known, ddof=1) / np.sqrt(number) / abs(known.mean()))


def errors_of_paths(values: Values, exact: Values, *, of_means: bool = False) -> dict[str, float]:
    """Errors of what a path has as a whole, by the field of `Point`."""
    return {
        f"{name}_error": relative_error(values[name], exact[name], of_means=of_means)
        for name in OF_PATHS
        if name in exact
    }


def _known_steps(values: Reals) -> list[int]:
    known = np.isfinite(values).sum(axis=0)
    return [] if known.max() == 0 else np.flatnonzero(known == known.max()).tolist()


def _largest(errors: Iterable[float]) -> float:
    return max((error for error in errors if not isnan(error)), default=nan)
