"""Time step and damping of the position Stormer-Verlet scheme, for modes of unit mass (thesis 6.2, 6.3).

The scheme is u[n+1] = u[n] + (1 - eta dt^2) (u[n] - u[n-1]) + dt^2 F[n], so that the damping eta is c / dt with the
damping rate c of u'' = F - c u'. `solvers/dynamics.py` takes the fraction `numerics.time_step` (0.95) of the largest
stable step, and the fraction `numerics.damping` (0.5) of the damping at which the softest mode that is restored is
critically damped.
"""

import math
from typing import TypeVar

from gfmd_numba.arrays import Reals

Stiffness = TypeVar("Stiffness", float, Reals)


def critical_damping(stiffness: Stiffness, time_step: float) -> Stiffness:
    """Damping eta at which a mode of this stiffness is critically damped (6.41), for each of several stiffnesses.

    Both roots are 1 - dt sqrt(K): from K dt^2 = 1 on, eta falls with K, and at the stability limit it is zero.
    """
    root: Stiffness = stiffness**0.5
    return 2.0 * root / time_step - stiffness


def stability_limit(softest: float, stiffest: float, damping: float) -> float:
    """Largest stable time step if eta is `damping` times the critical damping of the softest mode, unit mass.

    A mode is stable for K dt^2 + 2 eta dt^2 <= 4 (the thesis's K dt^2 <= 4 ignores the damping); with eta from
    (6.41) that is a quadratic in dt for the stiffest mode.
    """
    a = stiffest - 2.0 * damping * softest
    b = 2.0 * damping * math.sqrt(softest)
    # smaller positive root of a dt^2 + 2 b dt - 4 = 0, in the form that is safe for a -> 0 and right for a < 0;
    # b^2 + 4 a = 4 (Kmax - Kmin) + 4 Kmin (damping - 1)^2 is negative by rounding only
    return 4.0 / (b + math.sqrt(max(b * b + 4.0 * a, 0.0)))
