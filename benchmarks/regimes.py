"""Dynamic regimes of a damped oscillator under two Verlet schemes (thesis 6.2.2, Fig. 6.4).

One step multiplies a mode by the roots L of L^2 - sum L + product = 0, which depend on two numbers only,
x = K dt^2 and y = c dt = eta dt^2 (6.26).
"""

from collections.abc import Callable
from enum import StrEnum
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Complexes, Reals

Polynomial = tuple[Reals, Reals]


class Regime(StrEnum):
    """How a mode comes to rest, if it does (6.29)."""

    under_damped = "under-damped"
    over_damped = "over-damped"
    unstable = "unstable"


class Scheme(NamedTuple):
    """A scheme: sum and product of its roots from (x, y); y on the critical line and on the stability line from x."""

    polynomial: Callable[[Reals, Reals], Polynomial]
    critical: Callable[[Reals], Reals]
    stability: Callable[[Reals], Reals]


# (6.35), (6.42); the printed stability limit x <= 4 ignores the damping
position_verlet = Scheme(
    lambda x, y: (2.0 - x - y, 1.0 - y + 0.0 * x),
    lambda x: 2.0 * np.sqrt(x) - x,
    lambda x: 2.0 - 0.5 * x,
)
# (6.38), (6.39) with r[n+1] = 2 b r[n] - a r[n-1] + b dt^2 f[n]; stable for x <= 4 at any damping
gronbech_jensen = Scheme(
    lambda x, y: ((2.0 - x) / (1.0 + 0.5 * y), (1.0 - 0.5 * y) / (1.0 + 0.5 * y) + 0.0 * x),
    lambda x: np.sqrt(x * (4.0 - x)),
    lambda x: np.where(x <= 4.0, np.inf, -np.inf),
)


def roots(polynomial: Polynomial) -> tuple[Complexes, Complexes]:
    """Both roots of the characteristic polynomial (6.35); the first has the larger modulus."""
    total, product = polynomial
    half = 0.5 * np.asarray(total, dtype=np.complex128)
    root = np.sqrt(half * half - product)
    larger = np.where(half.real >= 0.0, half + root, half - root)
    # product over the larger root: the difference would cancel where the roots are far apart
    smaller = np.divide(product, larger, out=np.zeros_like(larger), where=larger != 0.0)
    return larger, smaller


def growth(polynomial: Polynomial) -> Reals:
    """Largest modulus of the roots: what a step multiplies the amplitude by in the long run; above 1 it is unstable."""
    total, product = polynomial
    square = 0.25 * total**2 - product
    real = 0.5 * np.abs(total) + np.sqrt(np.maximum(square, 0.0))
    return np.where(square < 0.0, np.sqrt(np.abs(product)), real)


def regime(polynomial: Polynomial) -> npt.NDArray[np.str_]:
    """Name of the regime (6.29) of each mode; a root of modulus 1 exactly (no damping, or the limit) counts as stable.

    The roots are complex inside the critical line and real outside; (6.37) prints xi < -2 for the unstable regime,
    which is where a root turns negative: a mode grows only for xi < -4.
    """
    total, product = polynomial
    # Jury's conditions; the roots themselves are ill conditioned where they coincide
    stable = (1.0 + total + product >= 0.0) & (1.0 - total + product >= 0.0) & (np.abs(product) <= 1.0)
    oscillates = total**2 < 4.0 * product
    return np.where(stable, np.where(oscillates, Regime.under_damped, Regime.over_damped), Regime.unstable)


def update_matrix(stiffness: Reals, damping: Reals, time_step: float) -> Reals:
    """Step matrix (6.62) of (u, v) for coupled components under position Stormer-Verlet `[..., 2d, 2d]`.

    `stiffness` is `[..., d, d]`, real symmetric: with -i u_3 for u_3 the matrix of (6.57) is [[M11, M13], [M13, M33]].
    `damping` is eta `[..., d]`, one for each component.
    """
    d = stiffness.shape[-1]
    eye = np.eye(d)
    damp = damping[..., :, None] * eye
    stiffness, damp = np.broadcast_arrays(stiffness, damp)
    dt = time_step
    return np.block([[eye - dt**2 * stiffness, dt * eye - dt**3 * damp], [-dt * stiffness, eye - dt**2 * damp]])


def spectral_radius(stiffness: Reals, damping: Reals, time_step: float) -> Reals:
    """Largest modulus of the eigenvalues of `update_matrix`, by a dense eigenvalue solver `[...]`."""
    radius: Reals = np.abs(np.linalg.eigvals(update_matrix(stiffness, damping, time_step))).max(axis=-1)
    return radius
