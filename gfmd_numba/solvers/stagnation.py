"""Whether a run has stopped converging, because rounding, say, keeps the residual where it is."""

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals

_SMALL = 1e-3  # residual above which, in double precision, a run has not yet begun to converge
_BETTER = 0.9  # of the least residual so far: what is above is no progress
_RISEN = 100.0  # times the least residual: what is above has left it, as a contact that jumps, and begins anew
_LOOKS = 50  # without progress at least
_SHARE = 2.0  # looks without progress over those that it took to get there


class Stagnation:
    """Watch the residuals of some rows, and tell which of them have stopped falling.

    The residual of a row has stopped falling if its least value was reached in the first third of the run, has not
    fallen by a tenth since, and the residual has stayed near it. A run that converges as slowly as t^-0.1 still falls
    by more. Above the residual `small` a run has not yet begun to converge.
    """

    def __init__(self, rows: int, small: float = _SMALL) -> None:
        self._small = small
        self._least, self._reached, self._looks = np.full(rows, np.inf), np.zeros(rows, dtype=np.int64), 0

    def look(self, residual: Reals, active: Indices) -> Flags:
        """Return which of the active rows have stopped, by their residuals `[active]`; to be called once a look."""
        self._looks += 1
        least = self._least[active]
        with np.errstate(invalid="ignore"):
            moved = (residual < _BETTER * least) | (residual > _RISEN * least)
        self._least[active[moved]], self._reached[active[moved]] = residual[moved], self._looks
        reached = self._reached[active]
        stays = self._looks - reached >= np.maximum(_LOOKS, _SHARE * reached)
        return np.asarray(stays & (self._least[active] <= self._small))
