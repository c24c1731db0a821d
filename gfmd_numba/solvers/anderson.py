"""Anderson's method for the fixed point of a map: where its last steps, mixed, would stand still."""

from collections.abc import Sequence

import numpy as np

from gfmd_numba.arrays import Reals


def mixed(found: Sequence[Reals], steps: Sequence[Reals], weight: Reals | float = 1.0) -> Reals:
    """Where to go on from flat states that a map has found, by the steps to them, as small as a mixture of these gets.

    Steps count by a weight `[place]`. Two pairs are the least (J. ACM 12:547, 1965; Walker and Ni, SIAM J. Numer.
    Anal. 49:1715, 2011).
    """
    moves, turns = (np.diff(np.array(each), axis=0) for each in (found, steps))
    shares = np.linalg.lstsq((weight * turns).T, weight * steps[-1], rcond=1e-12)[0]
    return np.asarray(found[-1] - shares @ moves)
