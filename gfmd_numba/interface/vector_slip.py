"""Laws of gap and slip, where the slip is a vector, on profiles of one component: they resist every direction alike.

The energy of a law is that of the length r of the slip s = r e, so that it drags along e.
"""

from functools import reduce

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw


def length(slip: Reals) -> Reals:
    """Length of a slip `[component, ...]`."""
    return reduce(np.hypot, slip, np.zeros(()))


def tangential_traction(law: XuNeedlemanLaw, gap: Reals, slip: Reals) -> Reals:
    """Traction `[component, ...]` that drags the body along with the punch."""
    r = length(slip)
    return law.tangential_traction(gap, r) * np.divide(slip, r, out=np.zeros_like(slip), where=r > 0.0)
