"""What Newton's method guesses of a contact with friction and a law of the gap, and where the law is linear next."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from gfmd_numba.arrays import Flags, Reals
from gfmd_numba.interface.interactions import NormalLaw
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.truncated_newton import TruncatedNewton

_DESCENT = 60  # steps down the energy of the normal contact, at most


@dataclass
class LawGuess:
    """What is guessed of a row `[n]`, and the tractions found last.

    Nodes in contact; directions of slip `[component, n]`, 0 where they stick; `slip_compliance`, the slip over the
    friction of a slipping node. `tractions` `[component + 1, n]` are tangential ones, then the pressure on touching
    nodes and minus the law's traction on others, which is linear about the displacement `normal`. Nodes that
    are `released` bear no tangential traction: an infinite friction has pulled them off, and they stick where they
    touch down again.
    """

    contact: Flags
    direction: Reals
    slip_compliance: Reals
    tractions: Reals
    normal: Reals
    released: Flags

    @classmethod
    def sticking(cls, contact: Flags, tractions: Reals, normal: Reals) -> Self:
        """Return a guess in which all nodes in contact stick."""
        n = contact.size
        return cls(contact, np.zeros((len(tractions) - 1, n)), np.zeros(n), tractions, normal, np.zeros(n, np.bool_))


def descended(batch: Batch, settled: float) -> tuple[Reals, Reals, int]:
    """Displacement and pressure of the wall `[n]` of one frictionless row, and how many transforms they took.

    The energy descends until the residual is `settled`.
    """
    solver, row = TruncatedNewton(batch, Options("truncated_newton", residual=settled)), np.arange(1)
    for _ in range(_DESCENT):
        if not solver.residual(row)[0] > settled:
            break
        solver.advance(row)
    n = solver.field.n
    u, wall = solver.displacement[0, :n], batch.punch.ravel()
    pressure = np.where(u >= wall, np.maximum(solver.load[0] - solver.restoring[0, :n], 0.0), 0.0)
    return u, pressure, int(solver.n_transforms[0])


def next_normal(law: NormalLaw, last: Reals, wall: Reals, u: Reals, traction: Reals, free: Flags) -> Reals:
    """Displacement `[n]` about which the law is linear next, after a step to u in which it has found its traction.

    Where a repulsion rises on a free node that is where the law has the traction found: along its tangent a gap would
    close far beyond what the law allows.
    """
    pull, slope = law.traction(wall - last), -law.stiffness(wall - last)
    rises = free & (slope < 0.0) & (traction < pull) & (pull < 0.0)
    length = np.divide(pull, slope, out=np.zeros_like(pull), where=rises)
    with np.errstate(over="ignore"):
        ratio = np.divide(traction, pull, out=np.ones_like(pull), where=rises)
    return np.minimum(np.where(rises, last + length * np.log(ratio), u), wall)
