"""The error that numbers of realisations are going to give, predicted from the results so far."""

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import xarray as xr
from scipy.special import chdtri

from gfmd_numba.analysis.arguments import Counts, Fixed, Variable, checked
from gfmd_numba.analysis.ensembles import Ensemble, ensembles, level_of_case, relative_errors
from gfmd_numba.analysis.forms import CAMPAIGN
from gfmd_numba.text.input_error import InputError

_WELL_KNOWN = 1e8  # one over the variance of an interaction, in units of its likely scatter
_CONFIDENCE = 0.9  # with which the true error of a fit is no larger than the one it says times the factor


@dataclass(frozen=True)
class Prediction:
    """Relative error of the TFC limit to expect of one group, times the `factor`.

    `exponents` and `interactions` are the parts of it, in quadrature, that would go if these were known. The factor is
    the one on a fit's error that allows for its own uncertainty. `caution` is how much larger the error is that
    `cheapest_design` promises: a design is chosen once, where a run can go on.
    """

    error: float
    exponents: float
    interactions: float
    factor: float
    caution: float


@checked
def predictions(
    results: Annotated[xr.Dataset, CAMPAIGN],
    counts: Counts,
    variable: Variable = "kappa",
    fixed: Fixed | None = None,
) -> list[Prediction]:
    """Predict the error of each group for `counts` (case) of realisations from the results of as many or fewer.

    UnusableDataError for results that do not tell.
    """
    number = level_of_case(results)
    if len(counts) != len(number):
        raise InputError(f"counts: you gave {len(counts)} numbers; gfmd allows one for each of {len(number)} cases")
    of_level = np.zeros(number.max() + 1)
    np.maximum.at(of_level, number, np.asarray(counts, dtype=float))
    found = []
    for ensemble in ensembles(results, variable, fixed or {}):
        factor = float(np.sqrt(ensemble.freedom / chdtri(ensemble.freedom, _CONFIDENCE)))
        # the doubt is about the scatter of surfaces, not about what is known before
        sober = replace(ensemble, doubt=factor**2)
        error, of_surfaces = relative_errors(sober, of_level)
        caution = relative_errors(ensemble, of_level)[0] / error
        additive = relative_errors(_additive(sober), of_level)[0]
        exponents, interactions = (float(np.sqrt(max(0.0, error**2 - less**2))) for less in (of_surfaces, additive))
        found.append(Prediction(error, exponents, interactions, factor, caution))
    return found


def _additive(ensemble: Ensemble) -> Ensemble:
    """Return the same, with the interactions known."""
    known = ensemble.known.copy()
    coefficients = known[: ensemble.columns.shape[1]]
    coefficients[coefficients > 0] = _WELL_KNOWN
    return replace(ensemble, known=known)
