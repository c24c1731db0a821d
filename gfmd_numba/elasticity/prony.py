"""The relaxation of a generalised Maxwell body, whose modulus decays in time as a Prony series,

    E(t) = E (1 + sum_i m_i exp(-t / tau_i)),

with E the relaxed modulus. Its Poisson's ratio is constant, so that one factor holds for the stiffness of every wave.
Each branch i is a spring of modulus m_i behind a dashpot. Where a displacement u is linear in a step of duration dt,
x = dt / tau_i, the stretch w_i of the spring of a branch becomes, exactly,

    w_i' = decay_i w_i + ramp_factor_i (u' - u),    decay_i = exp(-x),    ramp_factor_i = (1 - exp(-x)) / x.

The compliances of two bodies that bear the same tractions add up, and are again that of a Maxwell body: with s times
the Laplace transforms, E(s) = 1 + sum_i m_i s tau_i / (1 + s tau_i) and 1/E(s) = J(s) = 1 - sum_k j_k s theta_k / (1 +
s theta_k), the retardation times theta are the eigenvalues of diag(tau) + v v^T, v_i = (m_i tau_i)^(1/2).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from gfmd_numba.arrays import Complexes, Reals

_NOTHING = 1e-13  # of the glassy modulus
_SMALL = 1e-2  # duration over relaxation time below which differences of exponentials are a series


@dataclass(frozen=True)
class PronySeries:
    """Moduli of the branches over the relaxed modulus, and their relaxation times, in any one unit."""

    moduli: tuple[float, ...]
    times: tuple[float, ...]

    def modulus(self, time: float) -> float:
        """Modulus at a time after a sudden displacement, over the relaxed one."""
        return 1.0 + float(np.array(self.moduli) @ np.exp(-time / np.array(self.times)))

    @property
    def longest_retardation(self) -> float:
        """Time after which the slowest part of the creep under a constant stress has fallen to 1/e."""
        times = np.array(self.times)
        return float(_updated(times, np.sqrt(np.array(self.moduli) * times))[0].max())

    def lags(self, frequency: Reals) -> Complexes:
        """Complex stretch of the spring of each branch over the displacement `[branch, ...]` at angular frequencies."""
        phase = 1j * np.multiply.outer(np.array(self.times), frequency)
        return np.asarray(phase / (1.0 + phase))

    def complex_modulus(self, frequency: Reals) -> Complexes:
        """Complex modulus E' + i E'' at angular frequencies, over the relaxed modulus."""
        return np.asarray(1.0 + np.tensordot(self.moduli, self.lags(frequency), 1))

    def factor(self, duration: float) -> float:
        """Factor on the stiffness against what a step of a duration adds to the displacement."""
        return 1.0 + float(np.array(self.moduli) @ self.update_coefficients(duration)[1])

    def update_coefficients(self, duration: float) -> tuple[Reals, Reals]:
        """Return `decay` and `ramp_factor` `[branch]` of a step of a duration, as at the head of this file."""
        return _update_coefficients(self.times, duration)

    def losses(self, duration: float) -> Reals:
        """Coefficients `[3, branch]` of the energy that dashpots dissipate in a step, bilinear in stress and stretch.

        They multiply the products of old stress and old stretch, of an old value and a change in the step, and of the
        two changes. Each is an integral over t / tau_i.
        """
        x = duration / np.array(self.times)
        gone = -np.expm1(-x)
        twice = -0.5 * np.expm1(-2.0 * x)
        safe = np.maximum(x, _SMALL)
        exact = (x - 2.0 * gone + twice) / safe**2
        series = x * (1.0 / 3.0 - x * (1.0 / 4.0 - x * (7.0 / 60.0 - x / 24.0)))
        both = np.where(x < _SMALL, series, exact)
        return np.array([twice, 0.5 * gone * self.update_coefficients(duration)[1], both])


def in_series(parts: Sequence[tuple[float, PronySeries]]) -> PronySeries:
    """Series of bodies that bear the same tractions, each with its fraction of the relaxed compliance and its series.

    Exact but for rounding: a branch with a smaller modulus than the rounding is left out. An elastic body has none.
    """
    whole = sum(fraction for fraction, _ in parts)
    delayed_fractions, retardation = [np.zeros(0)], [np.zeros(0)]
    for fraction, series in parts:
        times = np.array(series.times)
        found, delayed = _updated(times, np.sqrt(np.array(series.moduli) * times))
        delayed_fractions, retardation = [*delayed_fractions, fraction / whole * delayed], [*retardation, found]
    delayed, rates = np.concatenate(delayed_fractions), 1.0 / np.concatenate(retardation)
    glassy = 1.0 / (1.0 - delayed.sum())  # modulus
    relaxing, moduli = _updated(rates, np.sqrt(glassy * delayed * rates))
    moduli = glassy * moduli
    bears = moduli > _NOTHING * glassy
    return PronySeries(tuple(moduli[bears].tolist()), tuple((1.0 / relaxing[bears]).tolist()))


def _updated(diagonal: Reals, column: Reals) -> tuple[Reals, Reals]:
    """Eigenvalues of diag(d) + v v^T, and (v^T q)^2 over them, q the eigenvectors.

    Found from singular values, whose squares are right over twice as many decades as those of the matrix itself.
    """
    vectors, roots, _ = np.linalg.svd(np.column_stack((np.diag(np.sqrt(diagonal)), column)), full_matrices=False)
    return roots**2, (column @ vectors / roots) ** 2


@lru_cache(maxsize=64)
def _update_coefficients(times: tuple[float, ...], duration: float) -> tuple[Reals, Reals]:
    x = duration / np.array(times)
    ramp_factor = np.divide(-np.expm1(-x), x, out=np.ones_like(x), where=x > 0.0)
    return np.exp(-x), ramp_factor
