"""Time step and damping of the position Stormer-Verlet scheme."""

import math


def critical_damping(stiffness: float, time_step: float) -> float:
    """Damping eta at which a mode of this stiffness is critically damped (6.41), unit mass."""
    return 2.0 * math.sqrt(stiffness) / time_step - stiffness


def stability_limit(softest: float, stiffest: float, damping: float) -> float:
    """Largest stable time step if eta is `damping` times the critical damping of the softest mode, unit mass.

    A mode is stable for K dt^2 + 2 eta dt^2 <= 4 (the thesis's K dt^2 <= 4 ignores the damping); with eta from
    (6.41) that is a quadratic in dt for the stiffest mode.
    """
    a = stiffest - 2.0 * damping * softest
    b = 2.0 * damping * math.sqrt(softest)
    # positive root of a dt^2 + 2 b dt - 4 = 0, in the form that is safe for a -> 0; a < 0 has no upper limit there
    return 4.0 / (b + math.sqrt(max(b * b + 4.0 * a, 0.0)))
