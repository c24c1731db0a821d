"""Corrections of first order in the slope to the contact of flat bodies, from the tractions of the last round.

The pressure acts along the normal of the touching surface, so that a node bears a traction along the plane: the
pressure times the slope of the surface it touches. Friction acts along the surface, and so has a part out of the plane,
friction times slope. A node that has moved along the plane meets another place of the facing surface. All three are of
first order in the slope, and follow from the displacements of the last round. The facing surface is a rigid punch, or
the deformed surface of the counter body. Tractions belong to the nodes of `body`, and the counter body bears them at
the places that these nodes meet. Lengths in L_x, stresses in E*.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.evaluation import gap
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.rough_surfaces import RoughBody
from gfmd_numba.contact.state import Contact, LoadStep, State, StepModification
from gfmd_numba.elasticity import topography
from gfmd_numba.elasticity.topography import Response
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.displaced_nodes import DisplacedNodes
from gfmd_numba.roughness.statistics import rms_gradient

_RESOLVED = 3 / 8  # wave index over nodes, up to which splines between the nodes are right


@dataclass(frozen=True)
class Moved:
    """Displacement of a surface, along the plane `[component, (y,) x]` and out of the body `[(y,) x]`.

    `level_along` and `level` are the same without slopes: displacements of the flat body under the tractions on the
    nodes of `body`.
    """

    along: Reals
    out: Reals
    level_along: Reals
    level: Reals


@dataclass(frozen=True)
class Pairing:
    """Where the nodes of `body` meet the surface above them.

    `way` `[component, (y,) x]` is how far each has moved along the plane against it, `slope` its slope there. Beyond
    what level surfaces would do under the same tractions, both are closer by `raised` `[(y,) x]`, and the nodes have
    moved along the plane against what they meet by `shifted`, of the shape of `way`. `across` `[component, component,
    (y,) x]` is what a law that holds both across a gap counts in addition, None without one.
    """

    way: Reals
    slope: Reals
    raised: Reals
    shifted: Reals
    across: Reals | None = None

    @classmethod
    def before_contact(cls, shape: tuple[int, ...]) -> "Pairing":
        """Pairing of nodes that have not moved, and do not press."""
        none = np.zeros((len(shape), *shape))
        return cls(none, none, np.zeros(shape), none)

    def tractions(self, along: Reals | None, pressure: Reals, side: int) -> tuple[Reals, Reals]:
        """Traction along the plane, of the shape of `way`, and pressure on the lower body (side 1) or the upper one.

        `along` and `pressure` are along the surface and its normal, on the nodes of `body`.
        """
        rub = np.zeros_like(self.way) if along is None else np.reshape(along, self.way.shape)
        sideways, normal = rub + pressure * self.slope, pressure - np.sum(rub * self.slope, axis=0)
        if self.across is not None:
            sideways = sideways - np.einsum("i...,ij...->j...", rub, self.across)
        if side > 0:
            return sideways, normal
        places = DisplacedNodes(self.way)
        return -np.stack([places.handed_back(each) for each in sideways]), places.handed_back(normal)

    def held_across(self, gap: Reals) -> "Pairing":
        """The same under a law of gap and slip that counts both along the surface, at gaps `[(y,) x]` along z.

        Surfaces that part along z also slip along an inclined surface, by the gap times the slope: `shifted` says so.
        A node that moves along the plane then slips by less where slope and gap change on its way (`across`), so that
        forces are the derivatives of one energy.
        """
        bend = np.stack([_gradient(each) for each in self.slope])
        across = bend * gap + self.slope[:, np.newaxis] * self.slope
        return replace(self, shifted=self.shifted - self.slope * gap, across=across)

    def difference(self, other: "Pairing") -> float:
        """Largest change of a place from one pairing to another."""
        return max(float(abs(self.way - other.way).max()), float(abs(self.raised - other.raised).max()))


def pair(
    bodies: Sequence[RoughBody], punch: Reals | None, sliding: Reals, moved: Sequence[Moved], last: Pairing
) -> Pairing:
    """Pairing of surfaces that have `moved`; the way to the places of the counter body is that of the `last` one.

    `punch` are the heights `[(y,) x]` of a rigid one, peaks towards the body, None for a level one; `sliding`
    `[component]` is how far it, or the base of the counter body, has moved along the plane.
    """
    own = moved[0]
    slid = np.reshape(sliding, (-1, *(1 for _ in own.out.shape)))
    raised, shifted = own.out - own.level, own.along - own.level_along
    if len(bodies) == 1:
        facing = np.zeros_like(own.out) if punch is None else punch
        way = own.along - slid
        places = DisplacedNodes(way)
        slope = np.stack([places.values(each) for each in -_gradient(facing)])
        return Pairing(way, slope, raised + places.values(facing) - facing, shifted)
    other, heights = moved[1], bodies[1].heights
    places = DisplacedNodes(last.way)
    raised += places.values(heights) - heights + _resolved(places.values(other.out) - other.level)
    met = np.stack([places.values(each) for each in other.along])
    more = met - other.level_along
    shifted -= np.stack([_resolved(each) for each in more])
    below = _seen_in_space(_gradient(bodies[0].heights + own.out), own.along)
    above = -_seen_in_space(_gradient(heights + other.out), other.along)
    above = np.stack([places.values(each) for each in above])
    slope = bodies[1].compliance_fraction * below + bodies[0].compliance_fraction * above
    return Pairing(own.along - met - slid, slope, raised, shifted)


def _resolved(field: Reals) -> Reals:
    """Field without the waves that nodes between those of the grid do not know, near Nyquist: these stay at order 0."""
    waves = grid.coefficients(field, field.ndim)
    for index, n in zip(grid.wave_indices(field.shape), field.shape, strict=True):
        waves = np.where(abs(index) <= _RESOLVED * n, waves, 0.0)
    return grid.signal(waves, *field.shape)


def _gradient(field: Reals) -> Reals:
    """Gradient `[component, (y,) x]` of a field, along x first, without the Nyquist waves."""
    shape = field.shape
    waves = grid.without_nyquist(grid.coefficients(field, len(shape)), shape)
    vectors = grid.wavevectors(shape, (1.0,) * len(shape))[::-1]
    return np.stack([grid.signal(1j * q * waves, *shape) for q in vectors])


def _seen_in_space(gradient: Reals, along: Reals) -> Reals:
    """Gradient over the places that nodes have moved to, of one over their labels."""
    stretch = np.stack([_gradient(each) for each in along])  # [component, of the derivative, (y,) x]
    matrix = np.moveaxis(stretch, (1, 0), (-2, -1)) + np.eye(len(along))
    found = np.asarray(np.linalg.solve(matrix, np.moveaxis(gradient, 0, -1)[..., np.newaxis]), dtype=np.float64)
    return np.stack([found[..., i, 0] for i in range(len(along))])


Responses = tuple[Response, ...]


@dataclass(frozen=True)
class SlopeCorrection:
    """What slopes add to the contact of flat bodies (g L_x, g E*).

    Slopes bring the surfaces closer by `raised` `[(y,) x]`, and shift the nodes along the facing surface by `shifted`
    `[component, (y,) x]`, 0 without tangential interaction. Slip counts from an earlier shift, `since`. Tangential
    tractions carry `lifted` of the mean pressure. `pairing` has the places where inclined surfaces touch at orders
    above 0; None for level surfaces.
    """

    raised: Reals
    shifted: Reals
    since: Reals
    lifted: float = 0.0
    pairing: Pairing | None = None

    def state(self, gradient: float) -> tuple[Reals, ...]:
        """What the next round begins with, as displacements (g L_x)."""
        level = self.raised, self.shifted
        if self.pairing is None:
            return level
        spacing = 1.0 / self.raised.shape[-1]
        return *level, self.pairing.way / gradient, self.pairing.slope * (spacing / gradient)

    def of_state(self, state: tuple[Reals, ...], gradient: float) -> "SlopeCorrection":
        """The same with another state."""
        raised, shifted, *met = state
        if self.pairing is None:
            return replace(self, raised=raised, shifted=shifted)
        way, slope = met[0] * gradient, met[1] * (gradient * self.raised.shape[-1])
        return replace(self, raised=raised, shifted=shifted, pairing=replace(self.pairing, way=way, slope=slope))

    def difference(self, other: "SlopeCorrection", gradient: float, contact: Contact) -> float:
        """Largest change of a displacement from one to the other (g L_x); a part of the load counts as one of these."""
        found = contact.equilibrium
        moved = max(float(abs(self.raised - other.raised).max()), float(abs(self.shifted - other.shifted).max()))
        if self.pairing is not None and other.pairing is not None:
            moved = max(moved, self.pairing.difference(other.pairing) / gradient)
        if self.lifted != other.lifted:
            share = abs(self.lifted - other.lifted) / float(abs(found.pressure).mean())
            moved = max(moved, share * float(abs(found.displacement).max()))
        return moved


@dataclass(frozen=True)
class Slopes:
    """Rough bodies in contact, followed to an order in the slope; heights of the problem are in units of `gradient`.

    `punch` are the heights `[(y,) x]` of a rough rigid one (L_x), None for a level one or none. It is a process that
    remembers a `SlopeCorrection`, which rounds bring to rest within each step (`two_step`).
    """

    problem: Problem
    bodies: tuple[RoughBody, ...]
    gradient: float
    order: int
    punch: Reals | None
    name: ClassVar[str] = "slopes"

    def begin(self, shape: tuple[int, ...]) -> SlopeCorrection:
        """What slopes add before there is a contact."""
        return self.untouched

    def change(self, state: State, step: LoadStep) -> StepModification:
        """Surfaces are closer, nodes are carried along, and tangential tractions bear a part of the load."""
        found: SlopeCorrection = state.memory[self.name]
        carried = (found.shifted - found.since)[np.newaxis] if self.rub else None
        return StepModification(wall=-found.raised[np.newaxis], anchor_shift=carried, lifted=found.lifted)

    def advance(self, state: State, solved: Contact, step: LoadStep) -> SlopeCorrection:
        """What the first round of the next step takes for granted: what the last round has, if it matters."""
        found: SlopeCorrection = state.memory[self.name]
        if not self.rub and found.pairing is None:
            return self.untouched
        return replace(found, since=(found if self.problem.interface.cohesive is None else self.untouched).shifted)

    @property
    def rub(self) -> bool:
        """Whether nodes that slopes carry along the plane slip, and how far they do counts."""
        return self.problem.interface.couples and self.order > 0

    @property
    def are_inclined(self) -> bool:
        """Whether the surfaces that touch are: all but those of a rough body under a level rigid punch."""
        return self.punch is not None or len(self.bodies) > 1

    @cached_property
    def untouched(self) -> SlopeCorrection:
        """What they add before there is a contact: what prescribed tractions do, which the punch then meets."""
        shape, tractions = self.problem.surface.shape, self.problem.tractions
        raised, shifted = np.zeros(shape), np.zeros((len(shape), *shape))
        if tractions is not None and self.order > 0:
            t, p = tractions.tangential, -tractions.normal
            parts = [self.gradient * each.compliance_fraction if each.side > 0 else 0.0 for each in self.bodies]
            responses = self._respond([(part * t, part * p) for part in parts], self.order)
            raised = self._raised(responses)
            shifted = self._shifted(responses) if self.rub else shifted
        if self.order == 0 or not self.are_inclined:
            return SlopeCorrection(raised, shifted, shifted)
        pairing = Pairing.before_contact(shape)
        return SlopeCorrection(raised, shifted, shifted, pairing=replace(pairing, shifted=self.gradient * shifted))

    def responses(self, contact: Contact, pairing: Pairing | None, order: int) -> Responses:
        """Response of each body to the tractions of a contact."""
        return self._respond([self._borne(body, contact, pairing) for body in self.bodies], order)

    def after(self, contact: Contact, responses: Responses, last: SlopeCorrection) -> SlopeCorrection:
        """What they add, found from a contact that what they added `last` has led to."""
        if last.pairing is None:
            shifted = self._shifted(responses) if self.rub else last.shifted
            return replace(last, raised=self._raised(responses), shifted=shifted)
        met = self._met(contact, responses, last.pairing)
        if self.problem.interface.cohesive is not None:
            met = met.held_across(self.gradient * gap(contact)[0])
        shifted, lifted = last.shifted, 0.0
        if self.rub:
            shifted = met.shifted / self.gradient
            if self.problem.mean_pressure is not None:
                lifted = float(contact.equilibrium.pressure[0].mean() - in_plane(contact, met)[1].mean())
        return SlopeCorrection(met.raised / self.gradient, shifted, last.since, lifted, met)

    def next_order(self, contact: Contact, responses: Responses, pairing: Pairing | None) -> float:
        """What the next order would add to any displacement (L_x); around a window displacements times slopes."""
        if any(self.problem.ends):
            steepest = max(float(rms_gradient(each.heights, (1.0,) * each.heights.ndim)) for each in self.bodies)
            return steepest * self.gradient * float(abs(contact.equilibrium.displacement).max())
        error = float(sum(each.highest_order for each in self.responses(contact, pairing, self.order + 1)))
        if pairing is not None and self.problem.interface.friction is not None:
            error += self._off_bound(contact, pairing)
        if self.order == 0 and self.are_inclined:
            level = Pairing.before_contact(self.problem.surface.shape)
            met = self._met(contact, responses, level)
            both = zip(*(self._moved(contact, responses, each) for each in (level, met)), strict=True)
            moves = (max(abs(a.along - b.along).max(), abs(a.out - b.out).max()) for a, b in both)
            error += float(max(*moves, abs(met.raised).max()))
        return error

    def _met(self, contact: Contact, responses: Responses, last: Pairing) -> Pairing:
        assert contact.step is not None
        sliding = self.gradient * np.asarray(contact.step.sliding)
        return pair(self.bodies, self.punch, sliding, self._moved(contact, responses, last), last)

    def _moved(self, contact: Contact, responses: Responses, pairing: Pairing) -> list[Moved]:
        """How the surface of each body has moved (L_x) under its tractions and by its topography, or if level."""
        found, shape = [], self.problem.surface.shape
        for body, response in zip(self.bodies, responses, strict=False):
            flat = body.elastic.response(shape)
            borne = (self._borne(body, contact, met) for met in (pairing, None))
            still = np.zeros((len(shape), *shape))
            own, level = (
                flat.apply(np.stack((*(still if along is None else along.reshape(still.shape)), -pressure)))
                for along, pressure in borne
            )
            sideways = own[:-1] if response.along is None else own[:-1] + response.along
            found.append(Moved(sideways, own[-1] + response.u3, level[:-1], level[-1]))
        return found

    def _borne(self, body: RoughBody, contact: Contact, pairing: Pairing | None) -> tuple[Reals | None, Reals]:
        return tractions_on(body, self.problem, contact, self.gradient, pairing)

    def _respond(self, borne: Sequence[tuple[Reals | None, Reals]], order: int) -> Responses:
        each = zip(self.bodies, borne, strict=False)
        return tuple(topography.respond(p, body.heights, body.elastic, order, t) for body, (t, p) in each)

    def _raised(self, responses: Responses) -> Reals:
        none = np.zeros(self.problem.surface.shape)
        return np.asarray(sum((response.u3 for response in responses), none) / self.gradient)

    def _shifted(self, responses: Responses) -> Reals:
        response = responses[0]  # of the lower body: a level punch does not move, nor what no traction is prescribed on
        assert response.along is not None  # where something rubs
        return response.along / self.gradient

    def _off_bound(self, contact: Contact, met: Pairing) -> float:
        """How far nodes of a map that slip across the slope move under what they bear beyond the bound in the plane.

        Coulomb's law compares forces on the surface. Those in the plane are bounded by the same ratio along the slope,
        and by a ratio larger by half the square of the slope across it, which no order knows.
        """
        found = contact.equilibrium
        assert found.tangential is not None  # as there is friction
        traction = found.tangential.traction[0]
        if len(traction) == 1:  # a profile knows no direction across
            return 0.0
        slipped = np.any(found.tangential.slip[0] != 0.0, axis=0)
        steepness, size = np.sum(met.slope**2, axis=0), np.sum(traction**2, axis=0)
        along = np.sum(traction * met.slope, axis=0) ** 2
        along = np.divide(along, size, out=np.zeros_like(size), where=size > 0.0)
        beyond = np.where(slipped, np.sqrt((1.0 + steepness) / (1.0 + along)) - 1.0, 0.0)
        more = np.stack((*(self.gradient * traction * beyond), np.zeros(size.shape)))
        moved = (body.elastic.response(size.shape).apply(body.compliance_fraction * more) for body in self.bodies)
        return float(sum(float(abs(each).max()) for each in moved))


def in_plane(contact: Contact, met: Pairing) -> tuple[Reals, Reals]:
    """Tractions of inclined surfaces along the plane, `[component, (y,) x]`, and the pressure out of it."""
    found = contact.equilibrium
    assert found.tangential is not None  # else the pressure is the same
    return met.tractions(found.tangential.traction[0], found.pressure[0], 1)


def tractions_on(
    body: RoughBody, problem: Problem, contact: Contact, gradient: float, pairing: Pairing | None = None
) -> tuple[Reals | None, Reals]:
    """Traction along the surface `[component, (y,) x]` and pressure `[(y,) x]` on a body, in its own E*.

    None stands for no traction along the surface. Prescribed tractions act on the lower body. On inclined surfaces,
    of which `pairing` tells, the tractions are those along the plane and out of it.
    """
    pressure, tangential = gradient * contact.equilibrium.pressure[0], contact.equilibrium.tangential
    along = None if tangential is None else gradient * tangential.traction[0]
    if pairing is None:
        along = None if along is None else body.side * along
    else:
        along, pressure = pairing.tractions(along, pressure, body.side)
    if problem.tractions is not None and body.side > 0:
        pressure = pressure - gradient * problem.tractions.normal
        along = gradient * problem.tractions.tangential + (0.0 if along is None else along)
    return None if along is None else body.compliance_fraction * along, body.compliance_fraction * pressure
