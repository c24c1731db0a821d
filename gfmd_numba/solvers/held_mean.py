"""A mean displacement that has to vanish, held by a large stiffness until the mean pressure takes over.

The mean pressure is the multiplier of the condition (Hestenes, J. Optim. Theory Appl. 4:303, 1969).
"""

from dataclasses import replace

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.solvers.certificate import RigidMean
from gfmd_numba.solvers.iteration import Batch

_HELD = 10.0  # that stiffness over the largest of the body


def condition(batch: Batch, stiffness: Reals) -> RigidMean | None:
    """Condition of the mean displacement, None where it may be any; a hard wall alone may leave no room for it."""
    found = RigidMean.of(batch.punch, stiffness)
    if found is None or batch.interface.hard_wall:
        return found
    return replace(found, impossible=np.zeros_like(found.impossible))


def held(stiffness: Reals, rigid_mean: RigidMean | None) -> Reals:
    """Normal stiffness `[(ny,) nx // 2 + 1]` in which a mean that has to vanish is no more than very stiff."""
    if rigid_mean is None:
        return stiffness
    finite = stiffness.copy()
    finite.flat[0] = _HELD * rigid_mean.stiffest
    return finite


def taken_over(displacement: Reals, rigid_mean: RigidMean) -> float:
    """Mean pressure, in E*, that holds a displacement `[node]` in place of that stiffness."""
    return -_HELD * rigid_mean.stiffest * float(displacement.mean())
