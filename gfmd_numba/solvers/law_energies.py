"""Energy of a law in one row and its derivatives by all displacements `[component, node]`, the normal one last."""

from collections.abc import Callable
from functools import reduce

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.interface import vector_slip
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions, NormalLaw
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw

_ACROSS = 4.0  # lengths of a law of gap and slip across which it acts
_STRIDE = 0.5  # tangential lengths of the law that a node is dragged in one step: past them the law gives way
_NOTHING = ExponentialLaw(0.0, 1.0)  # stands for no law: a hard wall alone

Place = Callable[[], tuple[Reals, Reals]]  # gap and slip, where they are needed


class EnergyOfGap:
    """A law of the gap alone.

    `reach` is how far a step may close gaps: a stride over the range of an attraction might pass what keeps surfaces
    apart; 0 where nothing attracts. Gaps are `[node]`, slips of the punch over the body `[component, node]`.
    """

    def __init__(self, law: NormalLaw) -> None:
        self._law = law
        self.reach = law.strength / law.softening if law.softening > 0.0 else 0.0
        self.normal_traction = law.traction

    def fill_traction(self, gap: Reals, slip: Reals, traction: Reals) -> None:
        """Fill the tractions that drag and pull the body."""
        traction[-1] = self._law.traction(gap)

    def fill_curvature(self, gap: Reals, slip: Reals, curvature: Reals) -> None:
        """Fill the curvature of the energy by each displacement alone."""
        curvature[-1] = self._law.stiffness(gap)

    def add_coupling(self, moved: Reals, restoring: Reals) -> float:
        """Add how the law couples the components of a node; return twice the energy of the coupling."""
        return 0.0

    def change(self, gap: Reals, slip: Reals, closing: Reals) -> float:
        """Change of the energy as all displacements change by `closing`."""
        return float(self._law.energy_change(gap, closing[-1]).sum(dtype=np.float64))

    def longest(self, place: Place, direction: Reals) -> float:
        """Step along a direction that is tried first."""
        return 1.0


class EnergyOfSlip:
    """A law of gap and slip, with the methods of `EnergyOfGap`."""

    def __init__(self, law: XuNeedlemanLaw) -> None:
        self._law, self.reach = law, law.normal
        self._together: list[tuple[int, int, Reals]] = []

    def normal_traction(self, gap: Reals) -> Reals:
        """Traction that pulls the body towards the punch where nothing has slipped."""
        return self._law.normal_traction(gap, np.zeros(gap.shape[-1]))

    def fill_traction(self, gap: Reals, slip: Reals, traction: Reals) -> None:
        """Fill the tractions that drag and pull the body."""
        traction[-1] = self._law.normal_traction(gap, vector_slip.length(slip))
        traction[:-1] = vector_slip.tangential_traction(self._law, gap, slip)

    def fill_curvature(self, gap: Reals, slip: Reals, curvature: Reals) -> None:
        """Fill the curvature of the energy by each displacement alone."""
        pairs = [(a, b) for a in range(len(curvature)) for b in range(a + 1)]
        self._together = []
        for (a, b), k in zip(pairs, vector_slip.stiffness(self._law, gap, slip), strict=True):
            if a == b:
                curvature[a] = k
            else:
                self._together.append((a, b, k))

    def add_coupling(self, moved: Reals, restoring: Reals) -> float:
        """Add how the law couples the components of a node; return twice the energy of the coupling."""
        pulled: dict[int, Reals] = {}
        energies = []
        for a, b, k in self._together:
            forces = {a: k * moved[b], b: k * moved[a]}
            energies.append(forces[a] * moved[a])
            for component, force in forces.items():
                pulled[component] = pulled[component] + force if component in pulled else force
        for component, force in pulled.items():
            restoring[component] += force
        return 2.0 * float(np.sum(reduce(np.add, energies)))

    def change(self, gap: Reals, slip: Reals, closing: Reals) -> float:
        """Change of the energy as all displacements change by `closing`."""
        change = vector_slip.energy_change(self._law, gap, slip, closing[-1], closing[:-1])
        return float(change.sum(dtype=np.float64))

    def longest(self, place: Place, direction: Reals) -> float:
        """Step along a direction that is tried first; past a stride in slip the law gives way."""
        gap, slip = place()
        near, tangential = gap < _ACROSS * self._law.normal, self._law.tangential
        allowed = np.maximum(vector_slip.length(slip)[near] / tangential - _ACROSS, _STRIDE)
        dragged = vector_slip.length(direction[:-1])[near] / tangential
        return float(1.0 / max(1.0, (dragged / allowed).max(initial=0.0)))


def law_energy(interface: Interactions) -> EnergyOfGap | EnergyOfSlip:
    """Energy of the law that acts; without any, one that is 0."""
    if interface.cohesive is not None:
        return EnergyOfSlip(interface.cohesive)
    return EnergyOfGap(interface.normal_law or _NOTHING)
