"""Anderson's method for the fixed point of a map, from its last states and steps."""

from collections.abc import Sequence

import numpy as np

from gfmd_numba.arrays import Reals


def mixed(found: Sequence[Reals], steps: Sequence[Reals], weight: Reals | float = 1.0) -> Reals:
    """Return the next state from flat states x_k that a map has `found`, and the `steps` s_k that led to them.

    With the differences dx_k and ds_k of successive ones, it is x - sum_k c_k dx_k, where c minimises
    |s - sum_k c_k ds_k| under the `weight` `[place]`. It takes two states at least (J. ACM 12:547, 1965; Walker and Ni,
    SIAM J. Numer. Anal. 49:1715, 2011).
    """
    moves, turns = (np.diff(np.array(each), axis=0) for each in (found, steps))
    coefficients = np.linalg.lstsq((weight * turns).T, weight * steps[-1], rcond=1e-12)[0]
    return np.asarray(found[-1] - coefficients @ moves)
