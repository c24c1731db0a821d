"""The relaxation of a body that is nearest to its storage and loss moduli."""

from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from gfmd_numba.elasticity.prony import PronySeries
from gfmd_numba.scene.units import rounded
from gfmd_numba.simulate.dma_table import Moduli
from gfmd_numba.text.input_error import InputError

_NOTHING = 1e-9  # of the glassy modulus
_A_DECADE = 2  # branches that may have a modulus
_LARGEST_MISFIT = 0.1


class MeasuredRelaxation(NamedTuple):
    """Relaxed modulus in Pa, branches over it with times in s, and the rms relative misfit of both moduli.

    `warning` is a sentence about a large misfit, or nothing.
    """

    youngs_modulus: float
    series: PronySeries
    misfit: float
    warning: str = ""


def fit_relaxation(table: Moduli) -> MeasuredRelaxation:
    """Prony series with moduli of at least 0 that is nearest to the moduli of a table.

    Its times are two to a decade, over the range of the frequencies. Raises InputError where no relaxed modulus is
    left, as frequencies do not reach down to it.
    """
    frequency, storage, loss = table[:3]
    longest, shortest = 1.0 / (2.0 * np.pi * frequency.min()), 1.0 / (2.0 * np.pi * frequency.max())
    count = 1 + int(np.ceil(_A_DECADE * np.log10(longest / shortest)))
    times = np.geomspace(shortest, longest, count)
    lags = PronySeries((1.0,) * count, tuple(times)).lags(2.0 * np.pi * frequency).T
    matrix = np.hstack([np.ones((frequency.size, 1)), lags.real]), np.hstack([np.zeros((frequency.size, 1)), lags.imag])
    weighted = np.vstack([part / moduli[:, np.newaxis] for part, moduli in zip(matrix, (storage, loss), strict=True)])
    moduli, deviation = nnls(weighted, np.ones(2 * frequency.size))
    if moduli[0] <= _NOTHING * moduli.sum():
        raise InputError.of(
            table.source,
            f"a storage modulus that still falls at {frequency.min():g} Hz",
            "one with lower frequencies, at which a relaxed modulus shows",
        )
    branches = [(rounded(m / moduli[0]), rounded(tau)) for m, tau in zip(moduli[1:], times, strict=True) if m > 0.0]
    if not branches:
        raise InputError.of(table.source, "moduli that do not relax", "those of a viscoelastic body")
    series = PronySeries(*zip(*branches, strict=True))
    misfit, warning = float(deviation / np.sqrt(2 * frequency.size)), ""
    if misfit > _LARGEST_MISFIT:
        off = abs(weighted @ moduli - 1.0).reshape(2, -1).max(axis=0)
        worst = int(off.argmax())
        warning = (
            f"{table.source}: the branches are off by {misfit:.0%} (rms), most by {off[worst]:.0%} at "
            f"{table.at(worst)}: is this one sweep, of a linear body, with its columns and units as read above?"
        )
    return MeasuredRelaxation(float(moduli[0]), series, misfit, warning)
