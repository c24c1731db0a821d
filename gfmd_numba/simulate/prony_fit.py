"""The relaxation of a body from a table of dynamic mechanical analysis (DMA): frequency, storage and loss modulus."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity.prony import PronySeries
from gfmd_numba.roughness import surface_text
from gfmd_numba.scene.units import PRESSURE, rounded
from gfmd_numba.text.input_error import InputError, brief

_NOTHING = 1e-9  # of the glassy modulus
_A_DECADE = 2  # branches that may have a modulus
_FEWEST = 3  # frequencies
_LARGEST = 1e30  # frequency or modulus


class Relaxation(NamedTuple):
    """Relaxed modulus in Pa, branches over it with times in s, and the rms relative misfit of both moduli."""

    youngs_modulus: float
    series: PronySeries
    misfit: float


def read_table(path: Path, unit: str = "Pa") -> tuple[Reals, Reals, Reals]:
    """Frequencies in Hz, storage and loss moduli in Pa `[row]` of a text file of three columns.

    Moduli have a unit of pressure there. Separators, decimal commas and headers are those of measured surfaces. Raises
    InputError for what is no such table.
    """
    try:
        scale = PRESSURE.si_value(f"1 {unit}")
    except ValueError:
        scale = None
    if scale is None:
        raise InputError.of("unit", brief(unit), "a unit of pressure, like MPa")
    try:
        values = surface_text.read_table(path).values
    except ValueError as error:
        raise InputError.of(path, error, "a text file of three columns") from None
    allowed = "three numbers above 0: frequency in Hz, storage and loss modulus"
    if values.shape[1] != 3:
        raise InputError.of(path, f"rows of {values.shape[1]} numbers", allowed)
    bad = np.flatnonzero(~((values > 0.0) & (values < _LARGEST)).all(axis=1))
    if bad.size:
        row = " ".join(f"{value:g}" for value in values[bad[0]])
        raise InputError.of(path, f"{row} in row {bad[0] + 1} of numbers", allowed)
    if np.unique(values[:, 0]).size < _FEWEST:
        raise InputError.of(path, f"{len(values)} rows of numbers", f"at least {_FEWEST} different frequencies")
    frequency, storage, loss = values[np.argsort(values[:, 0], kind="stable")].T
    return frequency, scale * storage, scale * loss


def fit_relaxation(frequency: Reals, storage: Reals, loss: Reals) -> Relaxation:
    """Prony series with moduli of at least 0 that is nearest to moduli (Pa) at frequencies (Hz), all `[row]`.

    Its times are two to a decade, over the range of the frequencies. Raises InputError where no relaxed modulus is
    left, as frequencies do not reach down to it.
    """
    longest, shortest = 1.0 / (2.0 * np.pi * frequency.min()), 1.0 / (2.0 * np.pi * frequency.max())
    count = 1 + int(np.ceil(_A_DECADE * np.log10(longest / shortest)))
    times = np.geomspace(shortest, longest, count)
    lags = PronySeries((1.0,) * count, tuple(times)).lags(2.0 * np.pi * frequency).T
    matrix = np.hstack([np.ones((frequency.size, 1)), lags.real]), np.hstack([np.zeros((frequency.size, 1)), lags.imag])
    weighted = np.vstack([part / moduli[:, np.newaxis] for part, moduli in zip(matrix, (storage, loss), strict=True)])
    moduli, deviation = nnls(weighted, np.ones(2 * frequency.size))
    if moduli[0] <= _NOTHING * moduli.sum():
        raise InputError.of(
            "table",
            f"a storage modulus that still falls at {frequency.min():g} Hz",
            "one with lower frequencies, at which a relaxed modulus shows",
        )
    branches = [(rounded(m / moduli[0]), rounded(tau)) for m, tau in zip(moduli[1:], times, strict=True) if m > 0.0]
    if not branches:
        raise InputError.of("table", "moduli that do not relax", "those of a viscoelastic body")
    series = PronySeries(*zip(*branches, strict=True))
    return Relaxation(float(moduli[0]), series, float(deviation / np.sqrt(2 * frequency.size)))
