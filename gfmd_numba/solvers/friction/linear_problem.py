"""Linear problem of a guess of the contact: which nodes touch, which of them stick, and in which direction others slip.

The unknowns are

- the pressure p of each touching node, and with a law of the gap minus the traction of the law on each open node;
- the tangential traction of each sticking node;
- on maps, the traction t of each slipping node across its direction of slip e;
- if friction depends on the slip rate, the change of the traction of each slipping node along e.

A slipping node bears the friction limit -f(p) e along e: -mu p, or a shear strength that may rise with p. Across e, the
traction turns by the same angle as the slip s, t / f = -ds / s, so that the node gives way by t s / f (Alart & Curnier,
Comput. Methods Appl. Mech. Eng. 92:353, 1991). Friction that depends on the slip rate is linearised about the last
slip: the change of the traction along e is minus the change of the slip times the slope of the limit by the slip.

The problem is solved by generalised minimal residuals, preconditioned by an approximate inverse of the compliance of
each component on the nodes in contact.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.friction.friction_guess import FrictionGuess, FrictionLimits, Tangent
from gfmd_numba.solvers.preconditioners import PRECONDITIONERS, as_stiffness


class NearTractions:
    """Preconditioner: tractions on some nodes that approximately cause displacements there, component by component.

    On profiles it inverts the compliance of each component (`ProfileInverse`). On maps it applies the stiffness between
    near neighbours (`StencilPreconditioner`), the mean of their stiffnesses for both tangential components. The
    coupling of the components is left out. `normal_of_a_node` and `tangential_of_a_node` are the stiffnesses of a node
    if all others are held. `takes_law`: nodes may have a compliance of their own in addition, of either sign.
    """

    def __init__(self, response: SpectralResponse, shape: tuple[int, ...]) -> None:
        elements, self._kind = response.inverse(), PRECONDITIONERS[len(shape)]
        tangential, normal = self._kind.tangential(elements), elements[-1]
        self._tangential, self._normal = (self._kind.of_component(each, shape) for each in (tangential, normal))
        weight = grid.multiplicity(shape[-1]) / np.prod(shape)
        self.tangential_of_a_node = float((as_stiffness(tangential) * weight).sum())
        self.normal_of_a_node = float((as_stiffness(normal) * weight).sum())
        # the exponential sum has no rigid mean: an attraction would move it
        self.takes_law = self._normal.takes_own and not response.is_rigid
        self._order: Indices | slice = slice(None)

    @property
    def transforms(self) -> float:
        """Transforms made so far."""
        return self._tangential.transforms + self._normal.transforms

    def factor(self, nodes: Indices, dragged: Indices, own: Reals | None = None) -> None:
        """Prepare `solve` for some nodes, and for those of them with tangential tractions of their own.

        `own` `[node]` are compliances that each node has in addition, which count where a law is taken.
        """
        if nodes.size:
            self._normal.factor(nodes, nodes.size, own if self.takes_law else None)
        if dragged.size:
            self._order = np.argsort(dragged) if self._kind.in_order else slice(None)
            self._tangential.factor(nodes[dragged[self._order]], dragged.size)

    def solve(self, normal: Reals, tangential: Reals) -> tuple[Reals, Reals]:
        """Return the pressure `[node]` and tractions `[component, dragged]` that about cause displacements."""
        pressure, traction = np.empty_like(normal), np.empty_like(tangential)
        if normal.size:
            self._normal.solve(normal, pressure)
        if tangential.size:
            for u, t in zip(tangential, traction, strict=True):
                found = np.empty_like(t)
                self._tangential.solve(u[self._order], found)
                t[self._order] = found
        return pressure, traction


def minimal_residual(product: Callable[[Reals], Reals], residual: Reals, aim: float, most: int) -> tuple[Reals, Reals]:
    """Return directions d_k `[k, unknown]` and coefficients c_k, so that |residual - product(sum c_k d_k)| <= aim.

    `product` is called once for each direction, in their order, so that a caller can keep the products and add them up
    for the solution. At most `most` directions are tried.
    """
    size = float(np.linalg.norm(residual))
    basis = np.empty((most + 1, residual.size))
    hessenberg = np.zeros((most + 1, most))
    coefficients: Reals = np.zeros(0)
    if not size > aim:
        return basis[:0], coefficients
    basis[0] = residual / size
    rotations: list[tuple[float, float]] = []  # that make the matrix triangular
    left = size
    for k in range(most):
        new = product(basis[k])
        for _ in range(2):  # once leaves rounding errors in the angles
            along = basis[: k + 1] @ new
            hessenberg[: k + 1, k] += along
            new -= along @ basis[: k + 1]
        hessenberg[k + 1, k] = norm = math.sqrt(new @ new)
        if not math.isfinite(norm):
            return basis[: k + 1], np.full(k + 1, np.nan)
        above, *below = hessenberg[: k + 1, k].tolist()
        for (cosine, sine), each in zip(rotations, below, strict=True):
            above = cosine * each - sine * above
        length = math.hypot(above, norm)
        rotations.append((above / length, norm / length) if length > 0.0 else (1.0, 0.0))
        left *= rotations[-1][1]
        if left <= aim or norm == 0.0:
            break
        basis[k + 1] = new / norm
    target = np.zeros(k + 2)
    target[0] = size
    coefficients = np.linalg.lstsq(hessenberg[: k + 2, : k + 1], target, rcond=None)[0].astype(np.float64)
    return basis[: k + 1], coefficients


_ACROSS = np.array([[-1.0], [1.0]])  # turns a direction (x, y), read from its end, by a right angle
_LEAST_GROWTH = 1e-12  # slope of friction by slip, over the stiffness of a node, below which it is as good as 0
# slope of a repulsion times the compliance of a node from which on it is told by its inverse, where not every law is
_STIFF = 0.3


class CoupledBody(NamedTuple):
    """The body of one row, which all its linear problems have in common.

    `deflect` turns tractions on the body into displacements, both `[component, n]`; `near` is an approximate inverse.
    `total` is the sum of the tractions that the load prescribes, None under a prescribed displacement. `drifts`: no
    traction restores the mean tangential displacement, so that the tangential tractions add up to zero.
    """

    deflect: Callable[[Reals], Reals]
    near: NearTractions
    friction: FrictionLimits
    total: float | None
    drifts: bool


class NormalRows(NamedTuple):
    """Equations of the nodes whose pressure is unknown: own * pressure - closing * displacement = asked `[row]`.

    The preconditioner is applied to the first `held` of the `nodes`, scaled by `scale` on either side. `touching` are
    the rows of nodes in contact. `known` `[n]` is the traction of the law on nodes where it is not unknown. Without a
    law, `own`, `closing`, `scale` and `known` are the same for all nodes, and no arrays.
    """

    nodes: Indices
    held: int
    touching: Indices
    asked: Reals
    own: Reals | None = None
    closing: Reals | float = 1.0
    scale: Reals | float = 1.0
    known: Reals | float = 0.0

    @classmethod
    def of(cls, guess: FrictionGuess, law: Tangent | None, near: NearTractions) -> "NormalRows":
        """Return the rows of a guess; those of a stiff repulsion are divided by its stiffness."""
        if law is None:
            nodes = _ordered(guess.contact)
            return cls(nodes, nodes.size, np.arange(nodes.size), -guess.normal[nodes])
        contact = guess.contact
        acts = ~contact & (law.slope != 0.0)
        stiff = acts if near.takes_law else acts & (-law.slope > _STIFF * near.normal_of_a_node)
        first = _ordered(contact | stiff)
        nodes = np.concatenate((first, np.flatnonzero(acts & ~stiff)))
        slope, touches = law.slope[nodes], contact[nodes]
        compliance = np.where(stiff[nodes], -1.0 / np.where(slope == 0.0, 1.0, slope), 1.0)
        own = np.where(touches, 0.0, compliance)
        closing = np.where(touches, 1.0, -slope * compliance)
        at = guess.normal[nodes]
        asked = np.where(touches, -at, -compliance * law.pull[nodes] - closing * at)
        scale = 1.0 if near.takes_law else 1.0 / np.sqrt(1.0 + own[: first.size] * near.normal_of_a_node)
        known = np.where(contact | ~acts, law.pull, 0.0)
        return cls(nodes, first.size, np.flatnonzero(touches), asked, own, closing, scale, known)


class StickSlip:
    """Equations of one guess, their left and right side, and an approximate inverse; `law` acts on open nodes."""

    def __init__(self, guess: FrictionGuess, law: Tangent | None, body: CoupledBody) -> None:
        self._body, self._shape, components = body, guess.tractions.shape, len(guess.direction)
        self._rows = rows = NormalRows.of(guess, law, body.near)
        slips = np.asarray(guess.direction.any(axis=0))
        at = rows.nodes[rows.touching]
        of_stuck = rows.touching[~(slips | guess.released)[at]]
        self._of_slipping = rows.touching[slips[at]]
        self.stuck, self.slipping = rows.nodes[of_stuck], rows.nodes[self._of_slipping]
        along = guess.direction[:, self.slipping]
        limit, drag, growth = body.friction.linearised(guess.tractions[-1, self.slipping], guess.slid[self.slipping])
        self._drag = -drag * along  # tangential traction over pressure
        self._limit = None if limit is None else -limit * along
        # directions of the unknown tractions of slipping nodes, compliances along these, and the slips they count from
        self._n_across = across = (components - 1) * self.slipping.size
        self._ways = (along[::-1] * _ACROSS[:components])[:, :across]
        self._slip_compliance, self._begun = guess.slip_compliance[self.slipping[:across]], np.zeros(across)
        if growth is not None:
            compliance = 1.0 / np.maximum(growth, _LEAST_GROWTH * body.near.tangential_of_a_node)
            self._ways = np.concatenate((self._ways, along), axis=1)
            self._slip_compliance = np.append(self._slip_compliance, compliance)
            self._begun = np.append(self._begun, guess.slid[self.slipping])
        self._turning = np.tile(self.slipping, components - 1 + (growth is not None))
        self._yield = 1.0 / np.sqrt(1.0 + self._slip_compliance * body.near.tangential_of_a_node)
        dragged = np.concatenate((of_stuck, self._of_slipping if self._turning.size else self._of_slipping[:0]))
        body.near.factor(rows.nodes[: rows.held], dragged, None if rows.own is None else rows.own[: rows.held])
        self._parts = rows.nodes.size, rows.nodes.size + components * self.stuck.size
        self._drifts = body.drifts and self.stuck.size + self._turning.size > 0
        self._constrain()

    def _constrain(self) -> None:
        """Prepare the prescribed sums of tractions, and the tractions of uniform displacements that correct them."""
        components = len(self._drag)
        sums, takers, prescribed = [], [], []
        turning, none = np.zeros(self._turning.size), np.zeros((components, self.stuck.size))
        if self._body.total is not None:
            one = np.ones(self._parts[0])
            sums.append(self._join(one, none, turning))
            takers.append(self._join(self._rows.closing * one, none, turning))
            prescribed.append(self._body.total + np.sum(self._rows.known))
        for component in range(components if self._drifts else 0):
            unit, dragged = none.copy(), np.zeros(self._parts[0])
            unit[component] = 1.0
            dragged[self._of_slipping] = self._drag[component]
            sums.append(self._join(dragged, unit, self._ways[component]))
            takers.append(self._join(np.zeros(self._parts[0]), unit, self._ways[component]))
            prescribed.append(0.0 if self._limit is None else -float(self._limit[component].sum()))
        shape = len(sums), self._parts[1] + self._turning.size
        self._sums = np.array(sums).reshape(shape)
        self._uniform = np.array([self._inverse(each) for each in takers]).reshape(shape)
        self._prescribed = np.array(prescribed, dtype=np.float64)
        # least squares: no uniform displacement that hardly changes any sum
        self._taken = np.linalg.pinv(self._sums @ self._uniform.T, rcond=1e-10)

    def unknowns(self, tractions: Reals) -> Reals:
        """Return the unknowns `[unknown]` with the prescribed sums that are nearest to tractions `[component, n]`."""
        own = self._along_ways(tractions)
        own[self._n_across :] = 0.0  # changes of the friction limit
        x = self._join(tractions[-1, self._rows.nodes], tractions[:-1, self.stuck], own)
        return np.asarray(x + (self._taken @ (self._prescribed - self._sums @ x)) @ self._uniform)

    def tractions(self, x: Reals) -> Reals:
        """Tangential tractions and pressures `[component, n]` of the unknowns, with those at their limit."""
        found = self._caused(x)
        if self._limit is not None:
            found[:-1, self.slipping] += self._limit
        return found

    def _caused(self, x: Reals) -> Reals:
        """Tractions `[component, n]` that are in proportion to the unknowns."""
        pressure, sticking, across = self._split(x)
        found = np.zeros(self._shape)
        found[-1, self._rows.nodes] = pressure
        found[:-1, self.slipping] = self._drag * pressure[self._of_slipping]
        found[:-1, self.stuck] = sticking
        if across.size:
            found[:-1, self.slipping] += self._of_ways(across)
        return found

    def deflected(self, x: Reals, known: bool = False) -> Reals:
        """Displacements `[component, n]` that the unknowns cause, on request with the tractions that are known."""
        tractions = self.tractions(x) if known else self._caused(x)
        if known:
            tractions[-1] -= self._rows.known
        return self._body.deflect(tractions)

    def prescribed(self, anchor: Reals) -> Reals:
        """Right-hand side of the linear problem `[unknown]`."""
        return self._join(self._rows.asked, anchor[:, self.stuck], self._along_ways(anchor) + self._begun)

    def restricted(self, u: Reals, x: Reals) -> Reals:
        """Left-hand side `[unknown]` of the unknowns, which cause displacements `[component, n]`."""
        rows, (pressure, _, turning) = self._rows, self._split(x)
        normal = -rows.closing * u[-1, rows.nodes]
        if rows.own is not None:
            normal += rows.own * pressure
        return self._join(normal, u[:-1, self.stuck], self._along_ways(u) + self._slip_compliance * turning)

    def correction(self, misfit: Reals) -> tuple[Reals, Reals]:
        """Return a change of the unknowns that approximately removes a misfit and keeps every sum.

        Also returns the uniform displacements left over, normal and tangential ones as far as these are free.
        """
        x = self._inverse(misfit)
        uniform = self._taken @ (self._sums @ x)
        x -= uniform @ self._uniform
        return x, np.asarray(uniform)

    def level(self, u: Reals, uniform: Reals) -> None:
        """Take uniform displacements left over off the displacements `[component, n]`."""
        if self._body.total is not None:
            u[-1] -= uniform[0]
        if self._drifts:
            u[:-1] += uniform[-len(u) + 1 :, np.newaxis]

    def _inverse(self, misfit: Reals) -> Reals:
        rows, (down, sideways, across) = self._rows, self._split(misfit)
        if across.size:
            sideways = np.concatenate((sideways, self._of_ways(self._yield * across)), axis=1)
        pressure, tractions = self._body.near.solve(rows.scale * down[: rows.held], sideways)
        found = np.empty_like(misfit)
        of_nodes, sticking, turning = self._split(found)
        of_nodes[: rows.held] = rows.scale * pressure
        of_nodes[rows.held :] = down[rows.held :]
        sticking[:] = tractions[:, : self.stuck.size]
        if across.size:
            own = tractions[:, self.stuck.size :]
            turning[:] = self._yield * (self._ways * np.tile(own, across.size // own.shape[1])).sum(axis=0)
        return found

    def _along_ways(self, values: Reals) -> Reals:
        """Parts along the ways of slipping nodes of quantities `[component, n]` that have tangential ones in front."""
        if not self._turning.size:
            return np.empty(0)
        return np.asarray((self._ways * values[: len(self._ways), self._turning]).sum(axis=0))

    def _of_ways(self, values: Reals) -> Reals:
        """Tangential vectors `[component, slipping]` of values along the ways of slipping nodes."""
        components, n = len(self._ways), self.slipping.size
        return np.asarray((self._ways * values).reshape(components, -1, n).sum(axis=1))

    def _split(self, x: Reals) -> tuple[Reals, Reals, Reals]:
        """Pressures, tractions `[component, stuck]` and tractions along the ways of slipping nodes."""
        first, second = self._parts
        return x[:first], x[first:second].reshape(len(self._drag), -1), x[second:]

    @staticmethod
    def _join(pressure: Reals, sticking: Reals, across: Reals) -> Reals:
        return np.concatenate((pressure, sticking.ravel(), across))


def _ordered(flags: Flags) -> Indices:
    """Nodes in their order around the period, from behind the widest gap."""
    nodes = np.empty(flags.size, dtype=np.int64)
    return nodes[: kernels.contact_nodes(flags, flags.size, nodes)]
