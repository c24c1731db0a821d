"""A smooth function of the parameters of a campaign through its limits, with an error everywhere.

A Gaussian process goes through the limits within their errors (Rasmussen & Williams 2006, chapter 2). Its functions
have two derivatives (Matern 5/2), as smoother ones are too sure where a function bends between limits. Contact areas
bend where contact becomes full, and so the process has their ratio to Persson's. The table is so fine that any program
may interpolate it linearly.
"""

import warnings
from typing import Annotated

import numpy as np
import scipy  # its modules load with their first use
import xarray as xr

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.fit_dataset import in_the_limit
from gfmd_numba.analysis.forms import FIT, UnusableDataError
from gfmd_numba.analysis.selection import axes
from gfmd_numba.arrays import Reals
from gfmd_numba.theory.exponent_ranges import AREAS_OVER_LOAD, AT_ONE_LOAD
from gfmd_numba.theory.persson import contact_area_fraction

_FEWEST = 3  # values of each parameter
_MOST_POINTS = 40_000  # of the table
_FINEST = 65  # values of each parameter in the table
_LOGARITHMIC = 10.0  # ratio of the ends of a positive parameter from which its logarithm is taken
_SEARCHES = 5  # for the lengths over which the function changes
# Lengths over which the errors of limits may be alike, where a parameter goes from 0 to 1: from none to all of them
_ALIKE = (1e-6, 0.1, 0.2, 0.5, 1.0, 1e6)


@checked
def smooth_function(fit: Annotated[xr.Dataset, FIT]) -> xr.Dataset:
    """Return the limits of a fit as a smooth function of the parameters that vary, with its standard error, as a table.

    The dims are the parameters. Groups may share surfaces and laws, so that errors of limits may be alike, and nobody
    knows over which distance: the error of the function takes the worst. Over `point`, the limits themselves: `limit`,
    `limit_error`, the parameters under their names with `point_` before, and `held_out`, what each limit differs by
    from the function without it, with its error. UnusableDataError for fewer than three values of a parameter, or
    none that varies; ModuleNotFoundError without scikit-learn.
    """
    variable = str(fit.attrs["variable"])
    limits, errors = in_the_limit(fit)
    known = ((fit["fit_status"] == "ok") & np.isfinite(limits) & (errors > 0)).values
    names = [name for name in axes(fit) if np.unique(fit[name].values[known]).size > 1]
    _check(fit.isel(group=known), names)
    value, error = limits.values[known], errors.values[known]
    scales = {name: _Scale(fit[name].values[known].astype(float)) for name in names}
    points = np.column_stack([scale.positions(scale.values) for scale in scales.values()])
    of_points = _persson(variable, {name: scale.values for name, scale in scales.items()})
    process = _Process(points, value / of_points, error / of_points)
    steps = min(_FINEST, int(_MOST_POINTS ** (1 / len(names))))
    grid = {name: scale.grid(steps) for name, scale in scales.items()}
    mesh = np.meshgrid(*(scale.positions(grid[name]) for name, scale in scales.items()), indexing="ij")
    table, band = process.at(np.stack([axis.ravel() for axis in mesh], axis=-1))
    of_table = _persson(variable, dict(zip(names, np.meshgrid(*grid.values(), indexing="ij"), strict=True)))
    table, band = (of_table * each.reshape(mesh[0].shape) for each in (table, band))
    held_out, held_out_error = (of_points * each for each in process.held_out())
    name = f"{variable}_tfc"
    found = xr.Dataset(
        {
            name: (names, table),
            f"{name}_error": (names, band),
            "limit": ("point", value),
            "limit_error": ("point", error),
            "held_out": ("point", held_out),
            "held_out_error": ("point", held_out_error),
            **{f"point_{each}": ("point", scale.values) for each, scale in scales.items()},
        },
        {each: (each, values, fit[each].attrs) for each, values in grid.items()},
        {"variable": variable, "logarithmic": " ".join(each for each in names if scales[each].is_logarithmic)},
    )
    for each, described in _NAMES.items():
        found[each.format(variable=variable)].attrs = {
            "long_name": described.format(variable=variable),
            "units": limits.attrs.get("units", "1"),
        }
    return found


_NAMES = {
    "{variable}_tfc": "{variable} in the thermodynamic, fractal and continuum limit, as a smooth function",
    "{variable}_tfc_error": "standard error of the function",
    "limit": "{variable} in the limit, which the function goes through within its error",
    "limit_error": "standard error of the limit",
    "held_out": "limit less the function without it",
    "held_out_error": "standard error of this difference",
}


def _persson(variable: str, parameters: dict[str, Reals]) -> Reals | float:
    """What Persson's theory has for a contact area or a kappa at some parameters, 1 of everything else."""
    load = parameters.get("reduced_pressure")
    if load is None or variable not in (*AREAS_OVER_LOAD, *AT_ONE_LOAD, "kappa_r"):
        return 1.0
    area = contact_area_fraction(load, 0.5)
    return area if variable in AT_ONE_LOAD else area / load


def _check(fit: xr.Dataset, names: list[str]) -> None:
    if not fit.sizes["group"]:
        raise UnusableDataError("you gave a fit without a limit that is known; gfmd allows one with several")
    if not names:
        raise UnusableDataError("you gave a fit of which no parameter varies; gfmd allows one over a `grid`")
    for name in names:
        values = np.unique(fit[name].values.astype(float))
        if not np.isfinite(values).all() or values.size < _FEWEST:
            raise UnusableDataError(
                f"you gave a fit with {name} = {', '.join(f'{each:g}' for each in values)}; gfmd allows {_FEWEST} or "
                "more finite values of each parameter that varies, whose limits are known"
            )


class _Scale:
    """A parameter, which the function takes from 0 to 1, in its logarithm if it has many."""

    def __init__(self, values: Reals) -> None:
        self.values = values
        self.low, self.high = float(values.min()), float(values.max())
        self.is_logarithmic = self.low > 0 and self.high >= _LOGARITHMIC * self.low

    def positions(self, values: Reals) -> Reals:
        """Return positions between 0 and 1."""
        low, high, each = (np.log(part) if self.is_logarithmic else part for part in (self.low, self.high, values))
        return np.asarray((each - low) / (high - low))

    def grid(self, steps: int) -> Reals:
        """Return values at even positions."""
        return (np.geomspace if self.is_logarithmic else np.linspace)(self.low, self.high, steps)


class _Process:
    """A Gaussian process through values with errors at points (point, parameter)."""

    def __init__(self, points: Reals, values: Reals, errors: Reals) -> None:
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern

        self.points, self.errors = points, errors
        self.middle, self.size = values.mean(), values.std()
        self.values = (values - self.middle) / self.size
        lengths = Matern(np.ones(points.shape[1]), (0.2, 10.0), nu=2.5)
        variances = (errors / self.size) ** 2
        search = GaussianProcessRegressor(
            ConstantKernel(4.0, (1e-2, 1e3)) * lengths, alpha=variances, n_restarts_optimizer=_SEARCHES, random_state=0
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)  # lengths at the end of their range are fine
            search.fit(points, self.values)
        self.kernel = search.kernel_
        self.factor = scipy.linalg.cho_factor(self.kernel(points) + np.diag(variances))

    def at(self, places: Reals) -> tuple[Reals, Reals]:
        """Return the function and its error at places (place, parameter)."""
        between = self.kernel(places, self.points)
        weights = scipy.linalg.cho_solve(self.factor, between.T).T
        by_limits = weights * self.errors
        apart = ((self.points[:, None] - self.points) ** 2).sum(axis=-1)
        alike = (np.exp(-apart / (2.0 * length**2)) for length in _ALIKE)  # correlations of the errors of limits
        of_limits = [((by_limits @ each) * by_limits).sum(axis=1) for each in alike]
        variance = (self.kernel.diag(places) - (weights * between).sum(axis=1)) * self.size**2  # errors independent
        between_limits = (variance - (by_limits**2).sum(axis=1)).clip(0.0)
        error = np.sqrt(between_limits + np.max(of_limits, axis=0))
        return self.middle + self.size * (weights @ self.values), error

    def held_out(self) -> tuple[Reals, Reals]:
        """Return what each value differs by from the function without it, and the error of that (5.10-5.12)."""
        inverse = scipy.linalg.cho_solve(self.factor, np.eye(len(self.values)))
        precision = np.diag(inverse)
        return self.size * (inverse @ self.values) / precision, self.size / np.sqrt(precision)
