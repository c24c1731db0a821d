"""Preconditioners for a hard wall: approximate inverses of a compliance on some nodes, by the dimension.

    dimension   normal displacement alone   one component among others   file
    1           ProfileInverse              ProfileInverse               exponential_sums/exponential_sum.py
    2           TwoLevelPreconditioner      StencilPreconditioner        two_level_preconditioner.py

The accelerators of active_set_newton run first where they can (`table.py`), and bring their own:
`exponential_sums/newton.py` an `ExponentialSum`, `tiles/newton.py` a `TiledTwoLevelPreconditioner`.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.solvers.exponential_sums.exponential_sum import ProfileInverse
from gfmd_numba.solvers.two_level_preconditioner import StencilPreconditioner, TwoLevelPreconditioner


class Preconditioner(NamedTuple):
    """How Newton's methods precondition on a grid.

    `of_contact` takes stiffness, compliance and shape of the normal displacement alone, `of_component` the compliance
    and shape of one component among others. `tangential` makes one compliance from the elements of the whole one.
    Nodes may have to be `in_order` around the period. Under friction the linear solver takes at most so many
    `directions`. `turns`: the slip of a node may turn its direction, as on maps. If it cannot, the problem of a correct
    guess is linear, the linear solver keeps the displacements of all its directions, and a coarser grid makes the
    first guess.
    """

    of_contact: Callable[[Reals, Reals, tuple[int, ...]], ProfileInverse | TwoLevelPreconditioner]
    of_component: Callable[[Reals, tuple[int, ...]], ProfileInverse | StencilPreconditioner]
    tangential: Callable[[Reals], Reals]
    in_order: bool
    directions: int
    turns: bool


def as_stiffness(compliance: Reals) -> Reals:
    """Stiffness; a mean displacement that is rigid has none, and one nearly so would reach over the whole map."""
    stiffness = _reciprocal(compliance)
    stiffness.flat[0] = min(stiffness.flat[0], stiffness.flat[1])
    return stiffness


def _reciprocal(compliance: Reals) -> Reals:
    return np.divide(1.0, compliance, out=np.zeros_like(compliance), where=compliance > 0.0)


def _alike_both_ways(elements: Reals) -> Reals:
    """Compliance of a map whose two tangential components have the mean of their stiffnesses."""
    xx, xy, yy = elements[:3]
    trace = 0.5 * (xx + yy)
    return np.asarray(np.divide(xx * yy - xy**2, trace, out=np.zeros_like(trace), where=trace > 0.0))


PRECONDITIONERS = {  # by the dimension
    1: Preconditioner(
        lambda stiffness, compliance, shape: ProfileInverse(
            stiffness, compliance.astype(np.float64) * shape[0], *shape
        ),
        lambda compliance, shape: ProfileInverse(_reciprocal(compliance), compliance, *shape),
        lambda elements: elements[0],
        in_order=True,
        directions=100,
        turns=False,
    ),
    2: Preconditioner(
        lambda stiffness, compliance, shape: TwoLevelPreconditioner(stiffness, shape),
        lambda compliance, shape: StencilPreconditioner(as_stiffness(compliance), shape),
        _alike_both_ways,
        in_order=False,
        directions=40,  # of maps fewer, as these are large
        turns=True,
    ),
}
