"""Where the next round begins, of several that approach a fixed point: extrapolated where they do so slowly.

Anderson's method (J. ACM 12:547, 1965), as in Walker and Ni (SIAM J. Numer. Anal. 49:1715, 2011).
"""

import numpy as np

from gfmd_numba.arrays import Reals

_PLAIN = 8  # rounds after which plain ones count as slow
_DEPTH = 5  # differences of rounds that are kept


class Rounds:
    """Rounds that each take a state of some arrays to another one, until both are the same.

    Rounds that move apart on one side are not extrapolated: where a topography is too steep for its order, a solution
    that all of them leave behind would mean nothing. Those that jump to and fro have it between them.
    """

    def __init__(self) -> None:
        self._count, self._approaches = 0, True
        self._found: list[Reals] = []
        self._change: list[Reals] = []

    def following(self, given: tuple[Reals, ...], found: tuple[Reals, ...]) -> tuple[Reals, ...]:
        """State that the next round begins with, from what the last one was given and has found."""
        before, after = (np.concatenate([part.ravel() for part in state]) for state in (given, found))
        self._count += 1
        self._found = [*self._found[-_DEPTH:], after]
        self._change = [*self._change[-_DEPTH:], after - before]
        if self._count == _PLAIN:
            back = float(self._change[-1] @ self._change[-2]) < 0.0
            self._approaches = back or bool(abs(self._change[-1]).max() < abs(self._change[-3]).max())
        if self._count <= _PLAIN or not self._approaches:
            return found
        changes, moves = (np.diff(np.array(each), axis=0).T for each in (self._change, self._found))
        weights = np.linalg.lstsq(changes, self._change[-1], rcond=1e-12)[0]
        parts = np.split(after - moves @ weights, np.cumsum([part.size for part in found])[:-1])
        return tuple(part.reshape(each.shape) for part, each in zip(parts, found, strict=True))
