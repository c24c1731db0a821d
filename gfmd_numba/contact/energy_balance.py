"""The energy of one contact, and the forces that do work on it along a path."""

from dataclasses import dataclass
from math import isfinite

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.evaluation import elastic_energy, gap
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import Contact
from gfmd_numba.interface import vector_slip


@dataclass(frozen=True)
class Balance:
    """What the balance of energy takes of one contact, per nominal area, in g L_x and g E*.

    `force` is what the load is conjugate to, the mean pressure or minus the mean displacement. `sliding` and the mean
    tangential `traction` are `[component]`. `potential` is the stored energy, less the work of a prescribed pressure.
    `lossless` is the pressure of what only repels, the hard wall or a law, and `gap` the gap, over the nodes. `rubbing`
    tells of the nodes that a finite friction drags, None without one.
    """

    load: float
    force: float
    sliding: Reals
    traction: Reals
    potential: float
    lossless: Reals
    gap: Reals
    rubbing: "Rubbing | None" = None

    @classmethod
    def of(cls, problem: Problem, contact: Contact) -> "Balance":
        """Balance of flat bodies, whose displacements are relative to each other.

        Those that prescribed tractions caused before are no part of them: by reciprocity, these tractions do the work
        on what the punch adds that the elastic energy of both together has more than that of each.
        """
        found, laws = contact.equilibrium, problem.interface
        u, pressure = (np.asarray(each[0], dtype=np.float64) for each in (found.displacement, found.pressure))
        apart, slip = gap(contact)[0], np.zeros(u.shape)
        sliding = traction = np.zeros(len(u.shape))
        rubbing = None
        potential = float(elastic_energy(contact)[0])  # of all waves but the mean
        if found.tangential is not None:
            sliding = np.ravel(found.tangential.sliding)
            traction = components(found.tangential.traction, u).mean(axis=1)
            sideways = components(found.tangential.displacement, u)
            if contact.approach is None:
                potential += 0.5 * float(traction @ sideways.mean(axis=1))
            if laws.friction is not None and isfinite(laws.friction):
                rubbing = Rubbing.of(problem, contact)
            slip = vector_slip.length(sliding[:, np.newaxis] - sideways).reshape(u.shape)
        repels = laws.normal_law is not None and laws.normal_law.softening == 0.0
        if laws.normal_law is not None and not repels:
            potential += float(laws.normal_law.energy(apart).mean())
        if laws.cohesive is not None:
            potential += float(laws.cohesive.energy(apart, slip).mean())
        lossless = pressure if repels else wall_pressure(problem, contact, slip)
        load, mean, force = problem.load, float(u.mean()), float(pressure.mean())
        if contact.approach is not None:  # the elastic energy is all there is, and the load works on the approach
            sunk = float(np.ravel(contact.approach)[0])
            work, conjugate = (0.0, force) if problem.mean_pressure is None else (load * sunk, sunk)
        else:
            work, conjugate = (0.5 * force * mean, force) if problem.mean_pressure is None else (load * mean, -mean)
        return cls(load, conjugate, sliding, traction, potential - work, lossless, apart, rubbing)

    def lost(self, before: "Balance") -> float:
        """Work since an earlier contact, forces linear between the two, less what the potential has gained.

        What only repels loses nothing: a hard wall does no work, and a contact never jumps over a law that repels.
        Their work, if pressure and gap of each node were linear between the two contacts, is therefore taken off. What
        slips loses its friction instead of what tractions linear between the two would take.
        """
        work = 0.5 * (before.force + self.force) * (self.load - before.load)
        work += 0.5 * float((before.traction + self.traction) @ (self.sliding - before.sliding))
        work += 0.5 * float(((before.lossless + self.lossless) * (self.gap - before.gap)).mean())
        if self.rubbing is not None and before.rubbing is not None:
            work += self.rubbing.lost(before.rubbing) - self.rubbing.linear(before.rubbing)
        return work - (self.potential - before.potential)


@dataclass(frozen=True)
class Rubbing:
    """Nodes under friction: what it holds on them `[node]`, `traction` and `slip` `[component, node]`."""

    held: Reals
    traction: Reals
    slip: Reals

    @classmethod
    def of(cls, problem: Problem, contact: Contact) -> "Rubbing":
        """Nodes of the first realisation of a contact, with all that has moved them."""
        found = contact.equilibrium.tangential
        assert found is not None  # of contacts under friction
        assert contact.sideways is not None
        wall = wall_pressure(problem, contact)
        slip = np.ravel(found.sliding)[:, np.newaxis] - components(contact.sideways, wall)
        held = friction_limit(problem, contact, wall).ravel()
        return cls(held, components(found.traction, wall), slip)

    def linear(self, before: "Rubbing") -> float:
        """What tractions linear between an earlier contact and this one take, per nominal area."""
        return 0.5 * float(((before.traction + self.traction) * (self.slip - before.slip)).sum(axis=0).mean())

    def lost(self, before: "Rubbing") -> float:
        """What friction takes since an earlier contact, per nominal area.

        A node that slips begins under the traction that it had, but at least under the smaller of the two that
        friction holds: where slip has turned round, the tractions of the two contacts would cancel. It ends under the
        traction that it has; one that opens, under none.
        """
        slipped = self.slip - before.slip
        first, last = ((each.traction * slipped).sum(axis=0) for each in (before, self))
        share = np.divide(np.minimum(before.held, self.held), self.held, out=np.zeros_like(last), where=self.held > 0.0)
        return 0.5 * float((np.maximum(first, share * last) + last).mean())


def friction_limit(problem: Problem, contact: Contact, wall: Reals) -> Reals:
    """Largest tangential traction `[(y,) x]` in g E* by the pressure of the wall and the last slip."""
    found, step = contact.equilibrium.tangential, contact.step
    assert found is not None  # of contacts under friction
    assert step is not None
    return problem.interface.lasting(step.duration).friction_limit(wall, vector_slip.length(found.slip[0]))


def wall_pressure(problem: Problem, contact: Contact, slip: Reals | None = None) -> Reals:
    """Pressure of the hard wall `[(y,) x]` in g E*, of the first realisation: that of the contact without a law's.

    A law of gap and slip has to know the `slip` `[(y,) x]` over the nodes.
    """
    found, laws = contact.equilibrium, problem.interface
    apart: Reals = gap(contact)[0]
    wall: Reals = found.pressure[0]
    if laws.normal_law is not None:
        return np.asarray(wall + laws.normal_law.traction(apart))
    if laws.cohesive is not None and slip is not None:
        return np.asarray(wall + laws.cohesive.normal_traction(apart, slip))
    return wall


def components(sideways: Reals, field: Reals) -> Reals:
    """Tangential components `[component, node]` of the first realisation, for a field `[(y,) x]`."""
    return np.asarray(sideways[0].reshape(-1, field.size))
