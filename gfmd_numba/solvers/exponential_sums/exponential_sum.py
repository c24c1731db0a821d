"""The compliance of a profile as a sum of exponential decays, which can be inverted on any set of nodes."""

from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier.transform import Transform

_SPACING = 1.5  # between the logarithms of two rates: 1/q comes out within 5 %, 13 % for the longest wave
STEEPEST = 3.0  # rate per node beyond which a decay is no more than the node itself
_NEAR = 64  # distances below which decays are tabulated
_FAINT = 1e-9  # decay over a period beyond which only neighbours across the cut would feel it
_NOTHING = np.empty(0)


class Tuning(NamedTuple):
    """How an active-set Newton method goes on with a preconditioner.

    The contact is guessed on a grid with fewer nodes in each direction by the factor `coarsening`. `loose` is the
    relative error allowed in the first pressure on a new contact. After a step that changed the contact, the allowed
    error is multiplied by `tighten`, and is at most `ahead` times the fraction of nodes that changed sides.
    """

    coarsening: int
    loose: float
    tighten: float
    ahead: float


class ExponentialSum:
    """Inverse of sum_s weight_s exp(-rate_s |i - j|) + white delta_ij, close to a compliance, on some nodes.

    The ratio of the two symbols bounds the ratio of their energies, also if both are restricted to some nodes. So the
    quality of the sum as a preconditioner of the restricted compliance depends neither on the nodes nor on their
    number. Fast decays end where the period is cut, in the widest gap between nodes.

    `compliance` is `[n // 2 + 1]`, zero at q = 0 if the mean pressure is prescribed; nodes are n to a period.
    """

    iterations = 40  # of conjugate gradients at most

    def __init__(self, compliance: Reals, n: int, spacing: float = _SPACING, faint: float = _FAINT) -> None:
        if compliance[0] == 0.0:  # the mean is prescribed: any value does that keeps the sum positive definite
            compliance = np.concatenate((compliance[1:2] ** 2 / compliance[2:3], compliance[1:]))
        rates, waves, symbols = _decays(n, spacing)
        weights, white = _fit(compliance[waves], symbols)
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


@lru_cache(maxsize=64)  # grids: a body that creeps or wears has another compliance at each step
def _decays(n: int, spacing: float) -> tuple[Reals, Indices, Reals]:
    """Rates `[decay]` of a period, waves `[wave]` of all scales alike, transforms `[wave, decay]` there."""
    slowest = np.pi / n
    terms = int(np.ceil(np.log(STEEPEST / slowest) / spacing)) + 1
    rates = np.geomspace(slowest, STEEPEST, terms)
    half = n // 2
    spread = np.geomspace(1, half, 4 * int(np.log(n) + 1))
    waves = np.unique(np.concatenate([np.arange(min(9, half + 1)), np.round(spread)]).astype(np.int64))
    phase = np.pi * waves[:, np.newaxis] / n
    return rates, waves, np.sinh(rates) / (2.0 * (np.sinh(rates / 2.0) ** 2 + np.sin(phase) ** 2))


def _fit(compliance: Reals, symbols: Reals) -> tuple[Reals, float]:
    """Weights of the decays and of the node itself, by least squares of the relative error."""
    ratios = np.column_stack([symbols, np.ones(len(symbols))]) / compliance[:, np.newaxis]
    scale = np.linalg.norm(ratios, axis=0)
    weights = np.linalg.lstsq(ratios / scale, np.ones(len(symbols)), rcond=1e-12)[0] / scale
    # single precision: the last digits may depend on where the arrays lie in memory
    weights = weights.astype(np.float32).astype(np.float64)
    return weights[:-1], float(weights[-1])


_ONE = np.zeros(1, dtype=np.int64)


class RestrictedStiffness:
    """Preconditioner of the compliance on some nodes: the stiffness of all, applied to these and read there.

    It is positive definite whatever the stiffness does over q, exact in full contact, and costs two transforms.
    `stiffness` is `[n // 2 + 1]`; at q = 0 zero or infinite if it does not count.
    """

    iterations = 200  # of conjugate gradients at most: it is farther off

    def __init__(self, stiffness: Reals, n: int) -> None:
        symbol = stiffness.astype(np.float64)
        if not 0.0 < symbol[0] < np.inf:
            symbol[0] = symbol[1]
        self._field = Transform(1, n)
        self._symbol = self._field.symbol(symbol)
        self._nodes, self._count = np.empty(0, dtype=np.int64), 0

    @property
    def transforms(self) -> float:
        """Transforms made so far."""
        return float(self._field.n_transforms[0])

    def factor(self, nodes: Indices, count: int) -> None:
        """Prepare `solve` for the first `count` of the nodes."""
        self._nodes, self._count = nodes, count

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes that about causes the displacement there."""
        where = self._nodes[: self._count]
        source = self._field.sources[0][0]
        source[:] = 0.0
        source[where] = displacement[: self._count]
        self._field.apply(self._symbol, _ONE)
        pressure[: self._count] = self._field.result[0][where]


class ProfileInverse:
    """An exponential sum or, where that is not positive definite on the nodes, the restricted stiffness.

    `compliance` and `stiffness` are `[n // 2 + 1]`, the former zero at q = 0 if it does not count there.
    """

    tuning = Tuning(coarsening=4, loose=0.03, tighten=0.1, ahead=np.inf)

    def __init__(self, stiffness: Reals, compliance: Reals, n: int) -> None:
        self._stiffness, self._compliance, self._n = stiffness, compliance, n
        self._sum = ExponentialSum(compliance, n)
        self._spare: RestrictedStiffness | None = None
        self._used: ExponentialSum | RestrictedStiffness = self._sum

    @property
    def transforms(self) -> float:
        """Transforms made so far."""
        return 0.0 if self._spare is None else self._spare.transforms

    @property
    def iterations(self) -> int:
        """Conjugate gradients that it may take."""
        return self._used.iterations

    @property
    def takes_own(self) -> bool:
        """Whether nodes may have a compliance of their own in addition."""
        return self._sum.is_safe

    def factor(self, nodes: Indices, count: int, own: Reals | None = None) -> None:
        """Prepare `solve` for the first `count` of the nodes, with what `takes_own` allows."""
        self._used = self._sum
        self._sum.factor(nodes, count, _NOTHING if own is None else own)
        if own is not None or self._sum.is_positive or not self._needs_spare:
            return
        if self._spare is None:
            self._spare = RestrictedStiffness(self._stiffness, self._n)
        self._spare.factor(nodes, count)
        self._used = self._spare

    def solve(self, displacement: Reals, traction: Reals) -> None:
        """Fill the traction on the nodes that about causes the displacement there."""
        self._used.solve(displacement, traction)

    @cached_property
    def _needs_spare(self) -> bool:
        """Whether no sum of decays is close to the compliance, whatever that of the mean, which is one wave of many."""
        if self._compliance[0] == 0.0:
            return True
        decays = ExponentialSum(np.concatenate(([0.0], self._compliance[1:])), self._n)
        decays.factor(np.arange(self._n), self._n)
        return not decays.is_positive
