"""Active-set Newton method for a hard wall that slides steadily over bodies that creep.

The response of such bodies is not symmetric, as the surface is higher in front of a load than behind it. Pressure and
gap are those of a linear complementarity problem of a positive definite matrix, and so there is one solution. It is
found by guessing the contact, as on elastic bodies. The more a body lags behind, the less a guess determines the next
one, and guesses may go round in circles. A proximal term then outweighs most of the lag:

    gap = wall + C p + w Re(C) (p - p'),

with the last pressure p' and a weight w. Whatever the weights, such pressures approach that of the problem without the
term (Rockafellar, SIAM J. Control Optim. 14:877, 1976). The last weight is 0.
"""

from dataclasses import replace

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from gfmd_numba.arrays import Complexes, Flags, Indices, Reals
from gfmd_numba.solvers.iteration import Batch, Start
from gfmd_numba.solvers.pressures import PressureIterate
from gfmd_numba.solvers.table import Options

_PATIENCE = 6  # guesses that change no fewer nodes than earlier ones before they are taken to go round in circles
_LESS, _MORE = 0.25, 3.0  # factors on the weight after guesses that came to an end, and after others
_LEAST = 0.05  # weight below which it is 0
_FIRST = 0.3  # weight that is of any help
_LAG = 2.0  # imaginary over real part of a compliance up to which guesses mostly come to an end without a weight
_AHEAD = 0.1  # error of the pressure on a guessed contact, over the share of its nodes that the last guess changed
_ROUGH = 1e-3  # error of the pressure of a solution under a weight, and share of its nodes that may still change
_COARSEST, _COARSER = 256, 2  # nodes up to which the first guess is full contact, and nodes over those of its grid
_COARSE_STEPS = 10  # solutions on the coarser grid, at most
_KEPT, _RESTARTS = 60, 3  # directions that the inner solver keeps, and how often it begins


class SlidingNewton(PressureIterate):
    """Pressure of a batch that slides steadily; an iteration is one solution under a weight.

    The pressure on a guessed contact is found by GMRES, preconditioned by the stiffness on its nodes. Nodes under
    tension leave, overlapping ones join. The first guess is the contact on a grid half as fine.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        super().__init__(batch)
        along = self.compliance.real > 0.0
        self._lag = float(np.max(abs(self.compliance.imag[along]) / self.compliance.real[along]))
        self._weights = np.full(len(batch.punch), 0.0 if self._lag <= _LAG else self._lag)
        self._targets = np.full(len(batch.punch), options.residual)
        self._solved = np.zeros(len(batch.punch), dtype=np.bool_)
        start = batch.start.displacement
        if not np.array_equal(start, Start.at_rest(batch.punch).displacement):
            self._begin_at(start.reshape(len(start), -1))
        elif self.field.n > _COARSEST:
            self._guess(batch, options)

    def advance(self, active: Indices) -> None:
        """Solve the problem of each active row under its weight, and choose the next weight."""
        for row in active.reshape(-1, 1):
            i = row[0]
            weight, last = float(self._weights[i]), self.pressure[i].copy()
            if not weight:
                self._targets[i] *= _AHEAD
            solved = self._solve(row, weight)
            self._solved[i] = solved and not weight
            if solved:
                self._weights[i] = _LESS * weight if _LESS * weight > _LEAST else 0.0
            else:
                self.pressure[i] = last
                self._weights[i] = max(_MORE * weight, _FIRST, self._lag / _LAG)

    def _guess(self, batch: Batch, options: Options) -> None:
        """Begin with the pressure on a coarser grid."""
        shape = tuple(-(-nodes // _COARSER) for nodes in self.field.shape)
        coarse = type(self)(batch.coarsened(shape), replace(options, residual=_ROUGH))
        for _ in range(_COARSE_STEPS):
            coarse.advance(np.flatnonzero(~coarse._solved))
        self._weights[:] = coarse._weights
        self.begin_at(coarse)

    def _begin_at(self, displacement: Reals) -> None:
        """Begin with the pressure that displacements `[realisation, node]` take where they touch the wall."""
        n, rows = self.field.n, np.arange(len(displacement))
        self.displacement[:, :n] = displacement
        self.field.apply(self._stiffness, rows, source=2)
        pressing = self.load[:, np.newaxis] - self.field.result[:, :n]
        pressing[displacement < self.wall[:, :n]] = 0.0
        for p, found in zip(self.pressure[:, :n], np.maximum(pressing, 0.0), strict=True):
            p[:] = found if found.any() else p

    def _solve(self, row: Indices, weight: float) -> bool:
        """Guess contacts under a weight until one leads to itself, or for so long that none will; whether one did."""
        i, n = row[0], self.field.n
        p, gap, wall = self.pressure[i, :n], self.gap[i, :n], self.wall[i, :n].copy()
        proximal = weight * self.compliance.real
        if weight:
            wall -= self._product(row, proximal, p)
        compliance = self.compliance + proximal
        contact, tolerance, least = p > 0.0, _AHEAD, _ROUGH if weight else float(self._targets[i])
        fewest, patience = int(p.size), _PATIENCE
        while patience:
            nodes = np.flatnonzero(contact)
            self._bear(i, contact)
            gap[:] = wall + self._product(row, compliance, p)
            p[nodes] += self._change(row, compliance, nodes, tolerance * float(np.linalg.norm(p)))
            gap[:] = wall + self._product(row, compliance, p)
            if self.free_mean:
                gap -= gap[nodes].mean()
            revised: Flags = np.where(contact, p > 0.0, gap < -self.rounding[i])
            changed = int(np.count_nonzero(revised != contact))
            if tolerance <= least and changed <= (_ROUGH * nodes.size if weight else 0):
                return True
            if changed < fewest:
                fewest, patience, tolerance = changed, _PATIENCE, _AHEAD * min(changed / nodes.size, 1.0)
            else:
                patience, tolerance = patience - 1, _AHEAD * tolerance
            tolerance = max(tolerance, least)
            contact = revised if revised.any() else contact
        return False

    def _bear(self, i: int, contact: Flags) -> None:
        """Let a guessed contact alone bear pressure, and the whole load."""
        p = self.pressure[i, : self.field.n]
        p[:] = np.where(contact, np.maximum(p, 0.0), 0.0)
        if self.free_mean:
            if not p.any():
                p[contact] = 1.0
            p *= self.load[i] * p.size / p.sum()

    def _change(self, row: Indices, compliance: Reals | Complexes, nodes: Indices, error: float) -> Reals:
        """Change of the pressure on nodes `[node]`, up to an error, that closes the gap there."""
        stiffness = np.divide(1.0, compliance, out=np.zeros_like(compliance), where=compliance != 0.0)
        stiffness /= self.field.n**2  # symbols have the 1/n of a transform
        whole = np.zeros(self.field.n)

        def product(symbol: Reals | Complexes, some: Reals) -> Reals:
            whole[nodes] = some - some.mean() if self.free_mean else some
            found = self._product(row, symbol, whole)[nodes]
            return found - found.mean() if self.free_mean else found

        def preconditioned(change: Reals) -> Reals:
            return product(stiffness, product(compliance, change))

        matrix = LinearOperator((nodes.size, nodes.size), matvec=preconditioned, dtype=np.float64)
        wanted = product(stiffness, -self.gap[row[0], nodes])
        kept = min(_KEPT, nodes.size)
        change, _ = gmres(matrix, wanted, rtol=0.0, atol=error, restart=kept, maxiter=_RESTARTS)
        return np.asarray(change - change.mean() if self.free_mean else change)

    def _product(self, row: Indices, symbol: Complexes | Reals, field: Reals) -> Reals:
        """Product of a symbol with a field `[node]`, which the next one overwrites."""
        self.direction[row[0], : self.field.n] = field
        self.field.apply(symbol, row, source=1)
        return self.field.result[row[0], : self.field.n]
