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
class EnergyBalance:
    """Potential and forces of one contact, per nominal area, in g L_x and g E*.

    `force` is conjugate to the `load`: the mean pressure of a prescribed displacement, or minus the mean displacement
    under a prescribed pressure. `sliding` and the mean tangential `traction` are `[component]`. `potential` is the
    stored energy, less the work of a prescribed pressure. `repulsion` `[(y,) x]` is the pressure of the hard wall, or
    of a law that only repels, and `gap` `[(y,) x]` the gap. `frictional` has the nodes under a finite friction, None
    without one.
    """

    load: float
    force: float
    sliding: Reals
    traction: Reals
    potential: float
    repulsion: Reals
    gap: Reals
    frictional: "FrictionalWork | None" = None

    @classmethod
    def of(cls, problem: Problem, contact: Contact) -> "EnergyBalance":
        """Balance of flat bodies, whose displacements are relative to each other.

        Displacements u_t by prescribed tractions t are left out: if the punch adds u, the elastic energy is
        E(u_t + u) = E(u_t) + E(u) + t u by reciprocity, and t u is the work of the prescribed tractions.
        """
        found, laws = contact.equilibrium, problem.interface
        u, pressure = (np.asarray(each[0], dtype=np.float64) for each in (found.displacement, found.pressure))
        apart, slip = gap(contact)[0], np.zeros(u.shape)
        sliding = traction = np.zeros(len(u.shape))
        frictional = None
        potential = float(elastic_energy(contact)[0])  # of all waves but the mean
        if found.tangential is not None:
            sliding = np.ravel(found.tangential.sliding)
            traction = components(found.tangential.traction, u).mean(axis=1)
            sideways = components(found.tangential.displacement, u)
            if contact.approach is None:
                potential += 0.5 * float(traction @ sideways.mean(axis=1))
            if laws.friction is not None and isfinite(laws.friction):
                frictional = FrictionalWork.of(problem, contact)
            slip = vector_slip.length(sliding[:, np.newaxis] - sideways).reshape(u.shape)
        repels = laws.normal_law is not None and laws.normal_law.softening == 0.0
        if laws.normal_law is not None and not repels:
            potential += float(laws.normal_law.energy(apart).mean())
        if laws.cohesive is not None:
            potential += float(laws.cohesive.energy(apart, slip).mean())
        repulsion = pressure if repels else wall_pressure(problem, contact, slip)
        load, mean, force = problem.load, float(u.mean()), float(pressure.mean())
        if contact.approach is not None:  # the elastic energy is all there is, and the load works on the approach
            sunk = float(np.ravel(contact.approach)[0])
            work, conjugate = (0.0, force) if problem.mean_pressure is None else (load * sunk, sunk)
        else:
            work, conjugate = (0.5 * force * mean, force) if problem.mean_pressure is None else (load * mean, -mean)
        return cls(load, conjugate, sliding, traction, potential - work, repulsion, apart, frictional)

    def dissipated(self, earlier: "EnergyBalance") -> float:
        """Return the energy dissipated since an earlier contact, by the trapezium of the forces.

        It is the work of force and traction, less the rise of the potential, with two corrections. Repulsion dissipates
        nothing: a hard wall does no work, and a contact never jumps over a law that repels. So its work by the
        trapezium is subtracted. And the work of friction replaces the trapezium of the tractions of slipping nodes.
        """
        work = 0.5 * (earlier.force + self.force) * (self.load - earlier.load)
        work += 0.5 * float((earlier.traction + self.traction) @ (self.sliding - earlier.sliding))
        work += 0.5 * float(((earlier.repulsion + self.repulsion) * (self.gap - earlier.gap)).mean())
        if self.frictional is not None and earlier.frictional is not None:
            work += self.frictional.dissipated(earlier.frictional) - self.frictional.trapezoidal(earlier.frictional)
        return work - (self.potential - earlier.potential)


@dataclass(frozen=True)
class FrictionalWork:
    """Friction `limit` `[node]`, `traction` and `slip` `[component, node]` of nodes under friction, for its work."""

    limit: Reals
    traction: Reals
    slip: Reals

    @classmethod
    def of(cls, problem: Problem, contact: Contact) -> "FrictionalWork":
        """Nodes of the first realisation of a contact, with all that has moved them."""
        found = contact.equilibrium.tangential
        assert found is not None  # of contacts under friction
        assert contact.tangential_displacement is not None
        wall = wall_pressure(problem, contact)
        slip = np.ravel(found.sliding)[:, np.newaxis] - components(contact.tangential_displacement, wall)
        limit = friction_limit_of(problem, contact, wall).ravel()
        return cls(limit, components(found.traction, wall), slip)

    def trapezoidal(self, earlier: "FrictionalWork") -> float:
        """Work of the trapezium of the tractions since an earlier contact, per nominal area."""
        return 0.5 * float(((earlier.traction + self.traction) * (self.slip - earlier.slip)).sum(axis=0).mean())

    def dissipated(self, earlier: "FrictionalWork") -> float:
        """Return the energy that friction dissipates since an earlier contact, per nominal area.

        Let a node slip by d, with tractions t_0 and t_1 at the two ends and friction limits f_0 and f_1. Its work is

            (max(t_0 d, min(f_0, f_1) / f_1 t_1 d) + t_1 d) / 2,

        the trapezium unless the slip has turned round, when t_0 d and t_1 d would cancel. A node that opens ends with
        t_1 = 0.
        """
        slipped = self.slip - earlier.slip
        first, last = ((each.traction * slipped).sum(axis=0) for each in (earlier, self))
        ratio = np.divide(
            np.minimum(earlier.limit, self.limit),
            self.limit,
            out=np.zeros_like(last),
            where=self.limit > 0.0,
        )
        return 0.5 * float((np.maximum(first, ratio * last) + last).mean())


def friction_limit_of(problem: Problem, contact: Contact, wall: Reals) -> Reals:
    """Friction limit `[(y,) x]` in g E* by the pressure of the wall and the last slip."""
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
