"""Approximate inverse of the compliance of a profile on some nodes, whichever of two can be used there."""

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.solvers.preconditioners.exponential_sum import ExponentialSum
from gfmd_numba.solvers.preconditioners.restricted_stiffness import RestrictedStiffness


class ProfileInverse:
    """An exponential sum or, where that is not positive definite on the nodes, the restricted stiffness.

    `compliance` is `[n // 2 + 1]`, zero at q = 0 if it does not count there.
    """

    def __init__(self, compliance: Reals, n: int) -> None:
        self._compliance, self._n = compliance, n
        self._sum = ExponentialSum(compliance, n)
        self._spare: RestrictedStiffness | None = None
        self._used: ExponentialSum | RestrictedStiffness = self._sum

    @property
    def transforms(self) -> float:
        """Transforms made so far."""
        return 0.0 if self._spare is None else self._spare.transforms

    @property
    def takes_own(self) -> bool:
        """Whether nodes may have a compliance of their own in addition."""
        return self._sum.is_safe

    def factor(self, nodes: Indices, count: int, own: Reals | None = None) -> None:
        """Prepare `solve` for the first `count` of the nodes, with what `takes_own` allows."""
        self._used = self._sum
        if own is not None:
            self._sum.factor(nodes, count, own)
            return
        self._sum.factor(nodes, count)
        if self._sum.is_positive:
            return
        if self._spare is None:
            stiffness = self._compliance.copy()
            stiffness[stiffness > 0.0] **= -1.0
            self._spare = RestrictedStiffness(stiffness, self._n)
        self._spare.factor(nodes, count)
        self._used = self._spare

    def solve(self, displacement: Reals, traction: Reals) -> None:
        """Fill the traction on the nodes that about causes the displacement there."""
        self._used.solve(displacement, traction)
