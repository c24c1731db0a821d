"""The compliance as a sum of exponential decays, which can be inverted on any set of nodes."""

from functools import cached_property

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals

_SPACING = 1.5  # between the logarithms of two rates: 1/q comes out within 5 %, 13 % for the longest wave
STEEPEST = 3.0  # rate per node beyond which a decay is no more than the node itself
_NEAR = 64  # distances below which decays are tabulated
_FAINT = 1e-9  # decay over a period beyond which only neighbours across the cut would feel it
_NOTHING = np.empty(0)


class ExponentialSum:
    """Inverse of sum_s weight_s exp(-rate_s |i - j|) + white delta_ij, close to a compliance, on some nodes.

    The bounds of the ratio of two symbols are those of the ratio of their energies, and remain so if both are
    restricted to some nodes: as a preconditioner of the restricted compliance its quality depends neither on
    the nodes nor on their number. Fast decays end where the period is cut, in the widest gap between nodes.

    `compliance` is `[n // 2 + 1]`, zero at q = 0 if the mean pressure is prescribed; nodes are n to a period.
    """

    transforms = 0.0  # it takes none

    def __init__(self, compliance: Reals, n: int, spacing: float = _SPACING, faint: float = _FAINT) -> None:
        if compliance[0] == 0.0:  # the mean is prescribed: any value does that keeps the sum positive definite
            compliance = np.concatenate((compliance[1:2] ** 2 / compliance[2:3], compliance[1:]))
        slowest = np.pi / n
        terms = int(np.ceil(np.log(STEEPEST / slowest) / spacing)) + 1
        rates = np.geomspace(slowest, STEEPEST, terms)
        weights, white = _fit(compliance, n, rates)
        # all images of a node, one period apart, add up to another decay and one that comes from the other side
        image = np.exp(-n * rates)
        weights /= 1.0 - image
        felt = image > faint
        rates, weights = np.concatenate((rates, -rates[felt])), np.concatenate((weights, (image * weights)[felt]))
        near = np.exp(-np.outer(np.arange(min(n, _NEAR)), rates))
        self.decays = kernels.Decays(rates, near, weights, white, 0.1 * float(compliance.min()))
        self._n, self._count = n, 0
        self._factors = self.room(0)

    def room(self, count: int) -> kernels.Factors:
        """Return memory for the factors on a number of nodes."""
        terms = self.decays.rates.size
        decay, lower = np.empty((2, count, terms))  # two arrays of their own might lie alike in pages, which is slow
        return kernels.Factors(decay, lower, np.empty(count), np.empty((terms, terms)))

    @property
    def is_positive(self) -> bool:
        """Whether the sum is positive definite on the nodes it was factored for.

        Where a compliance falls faster than 1/q^2, as below a stiff coating, decays of both signs cancel each other,
        but no longer where the period is cut: without a wide gap there pivots have to be lifted, and the factors may
        grow beyond all bounds.
        """
        return bool((self._factors.diagonal[: self._count] > self.decays.floor).all())

    @cached_property
    def is_safe(self) -> bool:
        """Whether the sum is positive definite on any nodes: sums of positive decays are, others are tried on all."""
        if (self.decays.weights > 0.0).all() and self.decays.white > 0.0:
            return True
        self.factor(np.arange(self._n), self._n)
        safe = self.is_positive
        self._factors = self.room(0)
        return safe

    def factor(self, nodes: Indices, count: int, own: Reals = _NOTHING) -> None:
        """Prepare `solve` for the first `count` of the nodes, each with a compliance of its `own` in addition.

        Where one of these is negative, pivots may be, and none is lifted.
        """
        if count > len(self._factors.diagonal):
            self._factors = self.room(count)
        decays = self.decays._replace(floor=-np.inf) if (own < 0.0).any() else self.decays
        kernels.exponential_sum_factor(decays, self._factors, nodes, count, self._n, own)
        self._count = count

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes that causes the displacement there."""
        kernels.exponential_sum_solve(displacement, self._count, self.decays.weights, self._factors, pressure)


def _fit(compliance: Reals, n: int, rates: Reals) -> tuple[Reals, float]:
    """Weights of the decays and of the node itself, by least squares of the relative error at all scales alike."""
    half = n // 2
    spread = np.geomspace(1, half, 4 * int(np.log(n) + 1))
    index = np.unique(np.concatenate([np.arange(min(9, half + 1)), np.round(spread)]).astype(np.int64))
    phase = np.pi * index[:, np.newaxis] / n
    symbols = np.sinh(rates) / (2.0 * (np.sinh(rates / 2.0) ** 2 + np.sin(phase) ** 2))
    ratios = np.column_stack([symbols, np.ones(len(index))]) / compliance[index, np.newaxis]
    scale = np.linalg.norm(ratios, axis=0)
    weights = np.linalg.lstsq(ratios / scale, np.ones(len(index)), rcond=1e-12)[0] / scale
    # single precision: the last digits may depend on where the arrays lie in memory
    weights = weights.astype(np.float32).astype(np.float64)
    return weights[:-1], float(weights[-1])
