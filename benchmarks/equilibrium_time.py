"""Time that damped modes need to come to rest (thesis 6.2.2.2, 6.4, 6.5), for unit mass."""

import numpy as np
import numpy.typing as npt
import regimes
from scipy.special import lambertw

from gfmd_numba.arrays import Complexes, Indices, Reals


def time_constant(stiffness: Reals, damping: Reals, time_step: float) -> Reals:
    """Time in which the amplitude of a mode falls by e in the long run; infinite without damping, negative if it grows.

    -dt / ln |L| with the larger root of (6.35). (6.45), (6.91) and (6.95) print 2 / (dt (eta + K)), which takes the
    real part of L - 1 for ln |L| and the mean of the roots for the larger: right for dt sqrt(K) -> 0 unless
    over-damped. All under-damped modes decay alike, |L|^2 = 1 - eta dt^2, whatever their stiffness.
    """
    dt2 = time_step**2
    growth = regimes.growth(regimes.position_verlet.polynomial(stiffness * dt2, damping * dt2))
    with np.errstate(divide="ignore"):
        return np.asarray(time_step / (0.0 - np.log(growth)))


def critical_equilibrium_time(stiffness: Reals, time_step: float, fraction: float) -> Reals:
    """Time after which a critically damped mode released at rest stays below `fraction` of its start (6.46).

    The amplitude (1 + n z) (1 - z)^n with z = dt sqrt(K) < 1 solved for n dt; for dt -> 0 it is (1 + x) exp(-x) with
    x = t sqrt(K), for fraction = 1e-16 x = 40.6 and not the -ln(fraction) = 36.8 of (6.13).
    """
    z = time_step * np.sqrt(stiffness)
    log = np.log1p(-z)
    steps = lambertw(fraction * np.exp(log / z) * log / z, -1).real / log - 1.0 / z
    return np.asarray(time_step * steps)


def fastest_damping_ratio(fraction: float) -> float:
    """Damping over critical damping that brings one mode below `fraction` of its start for good in the least time.

    Just under-damped: the first overshoot, exp(-pi zeta / sqrt(1 - zeta^2)) for dt -> 0, equals `fraction`.
    """
    depth = -np.log(fraction)
    return float(depth / np.hypot(np.pi, depth))


def steps_to_equilibrium(
    stiffness: Reals, damping: Reals, time_step: float, start: npt.ArrayLike, tolerance: float, max_steps: int
) -> Indices:
    """Steps after which |u| <= tolerance for good, by making the steps (6.4) themselves, `[...]` without the last axis.

    Modes of `stiffness` `[..., d, d]` (symmetric, real) and `damping` eta `[..., d]` start at rest from `start`
    `[..., d]` (6.98); complex starts carry the phase between components. |u|^2 is summed over components (6.99).
    max_steps + 1 marks what did not come to rest, or was not yet seen to.
    """
    stiffness, damping = np.asarray(stiffness), np.asarray(damping)
    shape = np.broadcast_shapes(stiffness.shape[:-1], damping.shape, np.shape(start))
    new = np.array(np.broadcast_to(start, shape), dtype=np.complex128)
    old = new.copy()
    keep, slow = 2.0 - time_step**2 * damping, 1.0 - time_step**2 * damping
    # components weighted apart: a matrix product over so small matrices costs ten times as much
    springs = np.moveaxis(time_step**2 * stiffness, -1, 0)
    phase = np.sqrt(np.linalg.eigvalsh(stiffness)[..., 0]) * time_step
    last, bound = np.zeros(shape[:-1], dtype=np.int64), np.full(shape[:-1], np.inf)
    with np.errstate(over="ignore", invalid="ignore"):  # an unstable mode ends as nan, and its neighbours go on
        for step in range(1, max_steps + 1):
            moved = keep * new - slow * old
            for column, spring in enumerate(springs):
                moved -= spring * new[..., column, None]
            old, new = new, moved
            size = _norm(new)
            last[size > tolerance] = step
            if step % 64 == 0 or step == max_steps:
                # displacement, and velocity over the lowest frequency: together they bound what is to come
                bound = np.maximum(size, _norm(new - old) / phase)
                if ((bound < 1e-2 * tolerance) | np.isnan(bound)).all():
                    break
    last[~(bound <= 0.5 * tolerance)] = max_steps
    return last + 1


def _norm(u: Complexes) -> Reals:
    return np.asarray(np.sqrt((u.real**2 + u.imag**2).sum(axis=-1)))
