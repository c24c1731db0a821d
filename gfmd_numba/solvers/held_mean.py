"""A mean displacement that has to vanish, held by a large stiffness until the mean pressure takes over.

The mean pressure is the multiplier of the condition (Hestenes, J. Optim. Theory Appl. 4:303, 1969).
"""

from dataclasses import dataclass, replace

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.solvers.certificate import RigidMean
from gfmd_numba.solvers.iteration import Batch

_HELD = 10.0  # that stiffness over the largest of the body, where no law softens


@dataclass(frozen=True)
class HeldMean:
    """The condition that the mean displacement vanishes, and the stiffness that holds it, in E*/L_x.

    Where a law softens faster than that stiffness lets the volume of a single node change, a contact would jump open
    and shut again as the mean pressure follows.
    """

    condition: RigidMean
    stiffness: float

    @classmethod
    def of(cls, batch: Batch) -> "HeldMean | None":
        """Return what holds the mean of a batch, None where the mean is free; only a hard wall may leave it no room."""
        condition = RigidMean.of(batch.punch, batch.response)
        if condition is None:
            return None
        if not batch.interface.hard_wall:
            condition = replace(condition, impossible=np.zeros_like(condition.impossible))
        softening = batch.interface.softening * batch.punch[0].size
        return cls(condition, _HELD * condition.stiffest + softening)

    def pressure(self, displacement: Reals) -> float:
        """Mean pressure, in E*, that holds a displacement `[node]` in place of that stiffness."""
        return -self.stiffness * float(displacement.mean())
