"""What a fit finds, and the same as a dataset: the table of what it holds, and how each of it is called."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Literal, Self

import numpy as np
import xarray as xr

from gfmd_numba.analysis.selection import LIMITS, Group, axes
from gfmd_numba.arrays import Reals

PAIRS = tuple(combinations(LIMITS, 2))
SOURCES = (*LIMITS, "interaction", "sampling", "extrapolation", "rivals", "residual")  # of the error of a TFC limit
STEPS = 48  # of the curve through the levels of a limit

_CORRECTION, _COEFFICIENT, _EXPONENT = (slice(1 + i * len(LIMITS), 1 + (i + 1) * len(LIMITS)) for i in range(3))
_INTERACTION = slice(1 + 3 * len(LIMITS), 1 + 3 * len(LIMITS) + len(PAIRS))


@dataclass(frozen=True)
class Estimates:
    """The parameters (..., parameter) of fits, or their errors; nan for those of limits that do not enter.

    Its properties are views: writing to them changes the table.
    """

    table: Reals

    @classmethod
    def unknown(cls, *shape: int) -> Self:
        """Return parameters (*shape, parameter) that are all nan."""
        return cls(np.full((*shape, _INTERACTION.stop), np.nan))

    @property
    def tfc(self) -> Reals:
        """Values (...) in the TFC limit."""
        return self.table[..., 0]

    @property
    def correction(self) -> Reals:
        """Values C x (..., limit) at the reference discretisation."""
        return self.table[..., _CORRECTION]

    @property
    def interaction(self) -> Reals:
        """Values C_ij x_i x_j (..., pair) at the reference discretisation."""
        return self.table[..., _INTERACTION]

    @property
    def coefficient(self) -> Reals:
        """Coefficients C (..., limit)."""
        return self.table[..., _COEFFICIENT]

    @property
    def exponent(self) -> Reals:
        """Exponents alpha (..., limit), of other laws than powers that of the tangent at the reference."""
        return self.table[..., _EXPONENT]


@dataclass(frozen=True)
class GroupFit:
    """What a fit says of one group: `budget` is the error of the TFC limit (source); nan where the fit is refused."""

    status: Literal["ok", "refused"]
    message: str
    estimate: Estimates
    error: Estimates
    low: float  # ends of the 90 % interval of the TFC limit
    high: float
    budget: Reals
    rms_residual: float
    chi2: float
    misfit: float  # factor on the errors of the means that makes the laws describe them, 1 where they do
    freedom: int  # means less coefficients
    laws: list[str]  # (limit)
    extrapolated: Reals  # fit at the finest level of each limit less the limit (limit)
    extrapolation_error: Reals  # what this distance adds to the error of the TFC limit (limit)
    contradiction: Reals  # what the TFC limit differs by where an asserted exponent may have its range (limit)
    curve: tuple[Reals, Reals]  # eps and values (limit, step) along each limit


_OF_THE_VARIABLE = "unit of the variable that is fitted"

_UNITS_AND_NAMES = {
    "{variable}_tfc": (_OF_THE_VARIABLE, "{variable} in the thermodynamic, fractal and continuum limit"),
    "{variable}_tfc_error": (_OF_THE_VARIABLE, "standard error: surfaces, laws of the limits, interactions"),
    "{variable}_tfc_low": (_OF_THE_VARIABLE, "lower end of the 90 % interval of {variable}_tfc"),
    "{variable}_tfc_high": (_OF_THE_VARIABLE, "upper end of the 90 % interval of {variable}_tfc"),
    "C": (_OF_THE_VARIABLE, "coefficient of eps^alpha"),
    "C_error": (_OF_THE_VARIABLE, "standard error of the coefficient of eps^alpha"),
    "alpha": ("1", "exponent"),
    "alpha_error": ("1", "standard error of the exponent"),
    "correction": (_OF_THE_VARIABLE, "correction of {variable} by the limit at the reference discretisation"),
    "correction_error": (_OF_THE_VARIABLE, "standard error of the correction"),
    "interaction": (_OF_THE_VARIABLE, "what two corrections together differ by from their sum, at the reference"),
    "interaction_error": (_OF_THE_VARIABLE, "standard error of the interaction"),
    "extrapolated": (_OF_THE_VARIABLE, "fit at the finest level of the limit less the limit"),
    "extrapolation_error": (_OF_THE_VARIABLE, "standard error of {variable}_tfc by this distance"),
    "contradiction": (
        _OF_THE_VARIABLE,
        "{variable}_tfc with a range for an exponent that is given exactly, less {variable}_tfc, beyond chance",
    ),
    "finest_eps": ("1", "finest level of the limit"),
    "curve_eps": ("1", "discretisation along each limit"),
    "curve": (_OF_THE_VARIABLE, "{variable} by the fit along each limit, the others at the reference"),
    "rms_residual": (_OF_THE_VARIABLE, "rms difference of case means and fit"),
    "chi2": ("1", "sum of squared residuals weighted by the shrunk covariance, of the likeliest laws"),
    "freedom": ("1", "means that are fitted less coefficients of the fit"),
    "law": ("1", "law of the limit"),
    "misfit": ("1", "factor on the errors of the means without which no law describes them"),
    "fit_status": ("1", "ok, or refused where an exponent is not identified"),
    "message": ("1", "what is to be known of the fit, a line for each thing"),
    "reference": (_OF_THE_VARIABLE, "mean of {variable} at the reference discretisation"),
    "reference_error": (_OF_THE_VARIABLE, "standard error of the mean"),
    "reference_eps": ("1", "reference discretisation"),
    "n_cases": ("1", "cases fitted"),
    "n_realisations": ("1", "realisations that are good in every case fitted"),
    "n_excluded": ("1", "results left out: not finite or status not ok"),
    "error_budget": (
        _OF_THE_VARIABLE,
        "error of {variable}_tfc by the laws of the limits, interactions, sampling, and at most by the solver's "
        "residual",
    ),
    "seconds": ("s", "processor time of the cases fitted; groups that share a problem each count it"),
    "group": ("1", "group of cases that differ only in discretisation"),
    "limit": ("1", "discretisation that goes to 0"),
    "pair": ("1", "discretisations that go to 0 together"),
    "source": ("1", "source of the error"),
    "step": ("1", "point of the curve along a limit"),
}


def fit_dataset(dataset: xr.Dataset, variable: str, groups: Sequence[Group], fits: Sequence[GroupFit]) -> xr.Dataset:
    """Dataset of a fit over `group`, `limit` and `source`, whose groups' parameters keep their attributes."""
    estimate = Estimates(np.array([fit.estimate.table for fit in fits]))
    error = Estimates(np.array([fit.error.table for fit in fits]))
    variables: dict[str, Any] = {
        f"{variable}_tfc": ("group", estimate.tfc),
        f"{variable}_tfc_error": ("group", error.tfc),
    }
    for end in ("low", "high"):
        variables[f"{variable}_tfc_{end}"] = ("group", [getattr(fit, end) for fit in fits])
    for name, parameter in (("C", "coefficient"), ("alpha", "exponent"), ("correction", "correction")):
        variables[name] = (("group", "limit"), getattr(estimate, parameter))
        variables[f"{name}_error"] = (("group", "limit"), getattr(error, parameter))
    for name, table in (("interaction", estimate), ("interaction_error", error)):
        variables[name] = (("group", "pair"), table.interaction)
    for name in ("rms_residual", "chi2", "freedom", "misfit", "message"):
        variables[name] = ("group", [getattr(fit, name) for fit in fits])
    for name, part in (("curve_eps", 0), ("curve", 1)):
        variables[name] = (("group", "limit", "step"), [fit.curve[part] for fit in fits])
    for name, rows in (
        ("extrapolated", [fit.extrapolated for fit in fits]),
        ("extrapolation_error", [fit.extrapolation_error for fit in fits]),
        ("contradiction", [fit.contradiction for fit in fits]),
        ("finest_eps", [_finest(group) for group in groups]),
    ):
        variables[name] = (("group", "limit"), np.array(rows).reshape(len(fits), -1))
    variables["law"] = (("group", "limit"), [fit.laws for fit in fits])
    variables["fit_status"] = ("group", [fit.status for fit in fits])
    variables["reference"] = ("group", [group.reference_mean for group in groups])
    variables["reference_error"] = ("group", [group.reference_error for group in groups])
    levels = np.array([list(group.reference.values()) for group in groups]).reshape(len(groups), -1)
    variables["reference_eps"] = (("group", "limit"), levels)
    variables["n_cases"] = ("group", [group.n_cases for group in groups])
    variables["n_realisations"] = ("group", [group.n_realisations for group in groups])
    variables["n_excluded"] = ("group", [group.n_excluded for group in groups])
    budget = np.array([fit.budget for fit in fits]).reshape(len(fits), -1)
    variables["error_budget"] = (("group", "source"), budget)
    variables["seconds"] = ("group", [group.seconds for group in groups])
    parameters = {
        name: ("group", [group.parameters[name] for group in groups], dataset[name].attrs) for name in axes(dataset)
    }
    dimensions = {
        "group": np.arange(len(groups)),
        "limit": list(LIMITS),
        "pair": [" ".join(pair) for pair in PAIRS],
        "source": list(SOURCES),
        "step": np.arange(STEPS),
    }
    result = xr.Dataset(variables, parameters | dimensions)
    own_unit = dataset[variable].attrs.get("units", "1")
    for name, (unit, long_name) in _UNITS_AND_NAMES.items():
        described = {"long_name": long_name, "units": own_unit if unit == _OF_THE_VARIABLE else unit}
        result[name.format(variable=variable)].attrs = {
            key: text.format(variable=variable) for key, text in described.items()
        }
    return result


def in_the_limit(fit: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
    """Return the variable that was fitted in the TFC limit, and its standard error, both over `group`."""
    name = f"{fit.attrs['variable']}_tfc"
    return fit[name], fit[f"{name}_error"]


def _finest(group: Group) -> list[float]:
    """Return the finest level of each limit (limit), nan of those that are not varied."""
    return [float(group.levels[name].min()) if name in group.levels else np.nan for name in LIMITS]
