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
    """

    load: float
    force: float
    sliding: Reals
    traction: Reals
    potential: float

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
        if laws.normal_law is not None:
            potential += float(laws.normal_law.energy(gap).mean())
        if laws.cohesive is not None:
            potential += float(laws.cohesive.energy(gap, slip).mean())
        load, mean = problem.load, float(u.mean())
        if problem.mean_pressure is not None:
            return cls(load, -mean, sliding, traction, potential - load * mean)
        force = float(pressure.mean())
        return cls(load, force, sliding, traction, potential - 0.5 * force * mean)

    def lost(self, before: "Balance") -> float:
        """Work since an earlier contact, forces linear between the two, less what the potential has gained."""
        work = 0.5 * (before.force + self.force) * (self.load - before.load)
        work += 0.5 * float((before.traction + self.traction) @ (self.sliding - before.sliding))
        return work - (self.potential - before.potential)


def components(sideways: Reals, field: Reals) -> Reals:
    """Tangential components `[component, node]` of the first realisation, beside a field `[(y,) x]`."""
    return np.asarray(sideways[0].reshape(-1, field.size))
