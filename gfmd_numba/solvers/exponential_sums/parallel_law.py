"""Displacements of a profile under tractions, with a law on some nodes: body and law in parallel, no transforms."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.kernels.exponential_sums import DECAYS_AT_ONCE
from gfmd_numba.solvers.exponential_sums.exponential_sum import STEEPEST, ExponentialSum

_FREE = 1e-2  # stiffness ascribed to a node that no law holds, over that of the softest wave
_CHANGE = 0.5  # of the compliance of any node, over itself, from which on the factors are made anew
_FEWEST = 16  # nodes
_SPACINGS = 0.0, 1.5, 1.8  # of the logarithms of rates at least: near rates may take off what others add to much of
_FAINT = 0.02  # decay over a period beyond which it is not felt across the cut: that of the slowest rate alone is


class ParallelLaw:
    """Displacements d with (K + D) d = r, nearly, of both components alone, for stiffnesses D >= 0 of the nodes.

    With the compliance C = 1/K as a sum of eight decays and A = 1/D, (K + D)^-1 = A - A (C + A)^-1 A, which takes a
    time linear in the nodes. Nodes that are held have A = 0. The coupling of the components, and nodes where the law
    softens, are left to the iteration.

    `compliances` `[nx // 2 + 1]` are those of the first and second component, whose values on the n nodes begin at 0
    and at `second` in rows of both.
    """

    @classmethod
    def of(cls, compliances: Reals, n: int, second: int) -> "ParallelLaw | None":
        """Return it for both components of a profile; None where no sum of decays is close, and for maps."""
        made = cls((compliances[0], compliances[1]), n, second) if len(compliances) == 2 else None
        return made if made is not None and made.is_safe else None

    def __init__(self, compliances: tuple[Reals, Reals], n: int, second: int) -> None:
        self._n, self._parts = n, (slice(0, n), slice(second, second + n))
        self.is_safe = False
        if n < _FEWEST:
            return
        spacing = np.log(STEEPEST * n / np.pi) / (DECAYS_AT_ONCE - 2.001)  # seven rates, and the images of the slowest
        for least in _SPACINGS:
            sums = [ExponentialSum(compliance, n, max(spacing, least), _FAINT) for compliance in compliances]
            self.is_safe = all(each.is_safe for each in sums)
            if self.is_safe:
                break
        missing = (0, DECAYS_AT_ONCE - sums[0].decays.rates.size)
        rates = np.pad(sums[0].decays.rates, missing)  # a matter of the nodes alone
        near = np.exp(-np.outer(np.arange(2), rates))
        self._weights = np.array([np.pad(each.decays.weights, missing) for each in sums])
        self._decays = [
            each.decays._replace(rates=rates, near=near, weights=weights)
            for each, weights in zip(sums, self._weights, strict=True)
        ]
        self._least = np.array([_FREE / compliance.max() for compliance in compliances])
        self._own, self._share, self._traction = np.zeros((3, 2, n))
        lower, decay, carried = (np.empty((nodes, DECAYS_AT_ONCE)) for nodes in (2 * n, n, DECAYS_AT_ONCE))
        self._factors = kernels.Factors(near[1:], lower, self._share, carried)
        self._of_each = [kernels.Factors(decay, lower[c * n : (c + 1) * n], self._share[c], carried) for c in range(2)]
        self._is_factored = False

    def factor(self, stiffness: Reals, moves: Reals) -> None:
        """Prepare `solve` for the stiffness of the law on each node, zero where it softens, and nodes that may move."""
        n = self._n
        for c, part in enumerate(self._parts):
            own = np.where(moves[part] > 0.0, 1.0 / np.maximum(stiffness[part], self._least[c]), 0.0)
            if self._is_factored and (np.abs(own - self._own[c]) <= _CHANGE * self._own[c]).all():
                continue
            self._own[c] = own
            kernels.exponential_sum_factor(self._decays[c], self._of_each[c], np.arange(n), n, n, own)
            np.reciprocal(self._share[c], out=self._share[c])
        self._is_factored = True

    def solve(self, r: Reals, d: Reals) -> None:
        """Fill the displacements that about balance the tractions r."""
        kernels.parallel_solve(r, self._parts[1].start, self._own, self._weights, self._factors, self._traction, d)
