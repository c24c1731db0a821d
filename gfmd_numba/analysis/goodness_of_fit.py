"""Whether any law of the limits describes the means of a campaign."""

from collections.abc import Sequence

import numpy as np
from scipy.special import fdtri

from gfmd_numba.analysis.gauss_markov import scatter_of
from gfmd_numba.analysis.linear_fit import Means, known_before, misfit_form
from gfmd_numba.analysis.posterior import Choice
from gfmd_numba.analysis.selection import Group


def excess_misfit(groups: Sequence[Group], means: Sequence[Means], found: Sequence[Choice]) -> float:
    """Return chi^2 of the best laws over what one in twenty campaigns would exceed by chance, at least 1.

    It is that of the means alone: coefficients other than expected are no misfit of a law. How it is distributed
    follows from the scatter of the means, as the covariance that weighs them is only estimated (Satterthwaite 1946).
    """
    found_scatters = [scatter_of(group.values[group.complete]) for group in groups]
    scatters = [scatter for scatter in found_scatters if scatter is not None]
    freedom = min(group.n_realisations for group in groups) - 1
    if freedom < 1 or len(scatters) < len(groups):
        return 1.0
    ratios = []
    for choice in found:
        best = int(np.argmin(np.sum([fit.misfit for fit in choice.fits], axis=0)))
        chi2 = expected = squares = 0.0
        for each, scatter in zip(means, scatters, strict=True):
            weights = misfit_form(each, choice.laws, choice.nodes[best], known_before(each, choice.laws))
            chi2 += float(each.values @ weights @ each.values)
            form = weights @ scatter
            expected += float(np.trace(form))
            squares += float(np.trace(form @ form))
        if expected <= 0.0:
            continue
        contrasts = expected**2 / squares
        searched = sum(parameter.low < parameter.high for parameter in choice.parameters)
        expected *= max(1.0, contrasts - searched) / contrasts
        limit = expected * fdtri(max(1.0, contrasts - searched), freedom, 0.95)
        ratios.append(chi2 / limit)
    return max(1.0, min(ratios, default=1.0))
