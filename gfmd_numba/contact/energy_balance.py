"""The energy of one contact, and the forces that do work on it along a path."""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.evaluation import elastic_energy
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import Contact
from gfmd_numba.interface import vector_slip


@dataclass(frozen=True)
class Balance:
    """What the balance of energy takes of one contact, per nominal area, in g L_x and g E*.

    `force` is what the load is conjugate to, the mean pressure or minus the mean displacement. `sliding` and the mean
    tangential `traction` are `[component]`. `potential` is the stored energy, less the work of a prescribed pressure.
    `lossless` is the pressure of what only repels, the hard wall or a law, and `gap` the gap, over the nodes.
    """

    load: float
    force: float
    sliding: Reals
    traction: Reals
    potential: float
    lossless: Reals
    gap: Reals

    @classmethod
    def of(cls, problem: Problem, contact: Contact) -> "Balance":
        """Balance of flat bodies without prescribed tractions, whose displacements are relative to each other."""
        found, laws = contact.equilibrium, problem.interface
        u, pressure = found.displacement[0], found.pressure[0]
        gap, slip = contact.punch[0] - u, np.zeros(u.shape)
        sliding = traction = np.zeros(u.ndim)
        potential = float(elastic_energy(contact)[0])  # of all waves but the mean
        if found.tangential is not None:
            sliding, traction = (
                np.ravel(found.tangential.sliding),
                components(found.tangential.traction, u).mean(axis=1),
            )
            sideways = components(found.tangential.displacement, u)
            potential += 0.5 * float(traction @ sideways.mean(axis=1))
            slip = sliding[:, np.newaxis] - sideways
            slip = np.reshape(slip[0] if len(slip) == 1 else vector_slip.length(slip), u.shape)
        repels = laws.normal_law is not None and laws.normal_law.softening == 0.0
        if laws.normal_law is not None and not repels:
            potential += float(laws.normal_law.energy(gap).mean())
        if laws.cohesive is not None:
            potential += float(laws.cohesive.energy(gap, slip).mean())
        lossless = pressure if repels else wall_pressure(problem, contact, slip)
        load, mean = problem.load, float(u.mean())
        if problem.mean_pressure is not None:
            return cls(load, -mean, sliding, traction, potential - load * mean, lossless, gap)
        force = float(pressure.mean())
        return cls(load, force, sliding, traction, potential - 0.5 * force * mean, lossless, gap)

    def lost(self, before: "Balance") -> float:
        """Work since an earlier contact, forces linear between the two, less what the potential has gained.

        What only repels loses nothing: a hard wall does no work, and a contact never jumps over a law that repels.
        Their work, if pressure and gap of each node were linear between the two contacts, is therefore taken off.
        """
        work = 0.5 * (before.force + self.force) * (self.load - before.load)
        work += 0.5 * float((before.traction + self.traction) @ (self.sliding - before.sliding))
        work += 0.5 * float(((before.lossless + self.lossless) * (self.gap - before.gap)).mean())
        return work - (self.potential - before.potential)


def wall_pressure(problem: Problem, contact: Contact, slip: Reals | None = None) -> Reals:
    """Pressure of the hard wall `[(y,) x]` in g E*, of the first realisation: that of the contact without a law's.

    A law of gap and slip has to know the `slip` `[(y,) x]` over the nodes.
    """
    found, laws = contact.equilibrium, problem.interface
    gap: Reals = contact.punch[0] - found.displacement[0]
    wall: Reals = found.pressure[0]
    if laws.normal_law is not None:
        return np.asarray(wall + laws.normal_law.traction(gap))
    if laws.cohesive is not None and slip is not None:
        return np.asarray(wall + laws.cohesive.normal_traction(gap, slip))
    return wall


def components(sideways: Reals, field: Reals) -> Reals:
    """Tangential components `[component, node]` of the first realisation, beside a field `[(y,) x]`."""
    return np.asarray(sideways[0].reshape(-1, field.size))
