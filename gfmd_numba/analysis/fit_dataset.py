"""What a fit finds, and the same as a dataset: the table of what it holds, and how each of it is called."""

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np
import xarray as xr

from gfmd_numba.analysis.selection import LIMITS, Group, axes
from gfmd_numba.arrays import Reals

PAIRS = tuple(combinations(LIMITS, 2))
SOURCES = (*LIMITS, "interaction", "sampling", "extrapolation", "rivals", "residual")  # of the error of a TFC limit
STEPS = 48  # of the curve through the levels of a limit
UNKNOWN = 0.5  # relative error, beyond which a limit is 0 within two standard errors


# what a fit finds of one group, by the names of `_VARIABLES`; what is not there is unknown
GroupFit = dict[str, Any]

_COLUMNS: dict[str, int | slice] = {  # of a table of the parameters of a fit
    "{variable}_tfc": 0,
    "correction": slice(1, 4),  # C x (limit) at the reference discretisation
    "C": slice(4, 7),  # (limit)
    "alpha": slice(7, 10),  # (limit), of other laws than powers that of the tangent at the reference
    "interaction": slice(10, 13),  # C_ij x_i x_j (pair) at the reference discretisation
}
N_PARAMETERS = 1 + 3 * len(LIMITS) + len(PAIRS)  # columns of that table


def named(table: Reals, ending: str = "") -> GroupFit:
    """Return views (...), (..., limit) or (..., pair) of parameters, or their errors, by name with an ending."""
    return {f"{name}{ending}": table[..., columns] for name, columns in _COLUMNS.items()}


_OF_THE_VARIABLE = "unit of the variable that is fitted"
_G, _L, _P = ("group",), ("group", "limit"), ("group", "pair")

_VARIABLES = {  # dims, unit and long name
    "{variable}_tfc": (_G, _OF_THE_VARIABLE, "{variable} in the thermodynamic, fractal and continuum limit"),
    "{variable}_tfc_error": (_G, _OF_THE_VARIABLE, "standard error: surfaces, laws of the limits, interactions"),
    "{variable}_tfc_low": (_G, _OF_THE_VARIABLE, "lower end of the 90 % interval of {variable}_tfc"),
    "{variable}_tfc_high": (_G, _OF_THE_VARIABLE, "upper end of the 90 % interval of {variable}_tfc"),
    "C": (_L, _OF_THE_VARIABLE, "coefficient of eps^alpha"),
    "C_error": (_L, _OF_THE_VARIABLE, "standard error of the coefficient of eps^alpha"),
    "alpha": (_L, "1", "exponent"),
    "alpha_error": (_L, "1", "standard error of the exponent"),
    "alpha_low": (_L, "1", "lower end of the exponents that were given"),
    "alpha_high": (_L, "1", "upper end of the exponents that were given"),
    "correction": (_L, _OF_THE_VARIABLE, "correction of {variable} by the limit at the reference discretisation"),
    "correction_error": (_L, _OF_THE_VARIABLE, "standard error of the correction"),
    "interaction": (_P, _OF_THE_VARIABLE, "what two corrections together differ by from their sum, at the reference"),
    "interaction_error": (_P, _OF_THE_VARIABLE, "standard error of the interaction"),
    "extrapolated": (_L, _OF_THE_VARIABLE, "fit at the finest level of the limit less the limit"),
    "extrapolation_error": (_L, _OF_THE_VARIABLE, "standard error of {variable}_tfc by this distance"),
    "contradiction": (
        _L,
        _OF_THE_VARIABLE,
        "{variable}_tfc with a range for an exponent that is given exactly, less {variable}_tfc, beyond chance",
    ),
    "finest_eps": (_L, "1", "finest level of the limit"),
    "curve_eps": ((*_L, "step"), "1", "discretisation along each limit"),
    "curve": ((*_L, "step"), _OF_THE_VARIABLE, "{variable} by the fit along each limit, the others at the reference"),
    "rms_residual": (_G, _OF_THE_VARIABLE, "rms difference of case means and fit"),
    "chi2": (_G, "1", "sum of squared residuals weighted by the shrunk covariance, of the likeliest laws"),
    "freedom": (_G, "1", "means that are fitted less coefficients of the fit"),
    "law": (_L, "1", "law of the limit"),
    "misfit": (_G, "1", "factor on the errors of the means without which no law describes them"),
    "fit_status": (_G, "1", "ok, or refused where an exponent is not identified"),
    "message": (_G, "1", "what is to be known of the fit, a line for each thing"),
    "reference": (_G, _OF_THE_VARIABLE, "mean of {variable} at the reference discretisation"),
    "reference_error": (_G, _OF_THE_VARIABLE, "standard error of the mean"),
    "reference_eps": (_L, "1", "reference discretisation"),
    "n_cases": (_G, "1", "cases fitted"),
    "n_realisations": (_G, "1", "realisations that are good in every case fitted"),
    "n_stretches": (_G, "1", "mean stretches of contact in a period where there are most; nan if mostly closed"),
    "n_excluded": (_G, "1", "results left out: not finite or status not ok"),
    "error_budget": (
        ("group", "source"),
        _OF_THE_VARIABLE,
        "error of {variable}_tfc by the laws of the limits, interactions, sampling, and at most by the solver's "
        "residual",
    ),
    "seconds": (_G, "s", "processor time of the cases fitted; groups that share a problem each count it"),
}
_DIMS = {
    "group": "group of cases that differ only in discretisation",
    "limit": "discretisation that goes to 0",
    "pair": "discretisations that go to 0 together",
    "source": "source of the error",
    "step": "point of the curve along a limit",
}


def fit_dataset(dataset: xr.Dataset, variable: str, groups: Sequence[Group], fits: Sequence[GroupFit]) -> xr.Dataset:
    """Dataset of a fit over `group`, `limit` and `source`, whose groups' parameters keep their attributes."""
    levels: dict[str, Any] = {
        "group": np.arange(len(groups)),
        "limit": list(LIMITS),
        "pair": [" ".join(pair) for pair in PAIRS],
        "source": list(SOURCES),
        "step": np.arange(STEPS),
    }
    own_unit = dataset[variable].attrs.get("units", "1")
    whole: list[GroupFit] = [
        fit
        | {
            "finest_eps": [float(group.levels[name].min()) if name in group.levels else np.nan for name in LIMITS],
            "reference": group.reference_mean,
            "reference_error": group.reference_error,
            "reference_eps": list(group.reference.values()),
            "n_cases": group.n_cases,
            "n_realisations": group.n_realisations,
            "n_stretches": group.n_stretches,
            "n_excluded": group.n_excluded,
            "seconds": group.seconds,
        }
        for group, fit in zip(groups, fits, strict=True)
    ]
    variables: dict[str, Any] = {}
    for name, (dims, unit, long_name) in _VARIABLES.items():
        unknown = np.full([len(levels[dim]) for dim in dims[1:]], np.nan)
        values = [each.get(name, unknown) for each in whole]
        attributes = {
            "long_name": long_name.format(variable=variable),
            "units": own_unit if unit == _OF_THE_VARIABLE else unit,
        }
        variables[name.format(variable=variable)] = (dims, np.array(values), attributes)
    parameters = {
        name: ("group", [group.parameters[name] for group in groups], dataset[name].attrs) for name in axes(dataset)
    }
    described = {dim: (dim, levels[dim], {"long_name": text, "units": "1"}) for dim, text in _DIMS.items()}
    return xr.Dataset(variables, parameters | described)


def in_the_limit(fit: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
    """Return the variable that was fitted in the TFC limit, and its standard error, both over `group`."""
    name = f"{fit.attrs['variable']}_tfc"
    return fit[name], fit[f"{name}_error"]
