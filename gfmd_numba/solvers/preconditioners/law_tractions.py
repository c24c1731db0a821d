"""Approximate inverses of the compliance on some nodes, of profiles and of maps, in one form."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.elasticity.coupled_stiffness import CoupledStiffness
from gfmd_numba.elasticity.map_stiffness import MapStiffness
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.preconditioners.near_tractions import NearTractions
from gfmd_numba.solvers.preconditioners.profile_inverse import ProfileInverse


class ProfileTractions:
    """Inverses of both compliances of a profile, each on its own nodes."""

    def __init__(self, stiffness: CoupledStiffness, n: int) -> None:
        compliance, share = stiffness.compliance(), grid.multiplicity(n) / n
        self._tangential, self._normal = ProfileInverse(compliance.s11, n), ProfileInverse(compliance.s33, n)
        of_a_node = [
            float((np.divide(1.0, s, out=np.zeros_like(s), where=s > 0.0) * share).sum())
            for s in (compliance.s11, compliance.s33)
        ]
        self.tangential_of_a_node, self.normal_of_a_node = of_a_node
        # a rigid mean is not one of the sum, in which an attraction would move it
        self.takes_law = self._normal.takes_own and bool(np.isfinite(stiffness.k33[0]))

    @property
    def transforms(self) -> float:
        """Transforms made so far."""
        return self._tangential.transforms + self._normal.transforms

    def order(self, flags: Flags) -> Indices:
        """Return the nodes in their order around the period, from behind the widest gap."""
        nodes = np.empty(flags.size, dtype=np.int64)
        return nodes[: kernels.contact_nodes(flags, flags.size, nodes)]

    def factor(self, nodes: Indices, dragged: Indices, own: Reals) -> None:
        """Prepare `solve` for some nodes, and for those of them with tangential tractions of their own.

        `own` `[node]` are further compliances of each node, which count where the normal one is a safe sum.
        """
        if nodes.size:
            self._normal.factor(nodes, nodes.size, own if self.takes_law else None)
        if dragged.size:
            self._tangential.factor(nodes[dragged], dragged.size)

    def solve(self, normal: Reals, tangential: Reals) -> tuple[Reals, Reals]:
        """Return the pressure `[node]` and tractions `[component, dragged]` that about cause displacements."""
        pressure, traction = np.empty_like(normal), np.empty_like(tangential)
        if normal.size:
            self._normal.solve(normal, pressure)
        if tangential.size:
            self._tangential.solve(tangential[0], traction[0])
        return pressure, traction


class MapTractions:
    """The stiffness between near nodes of a map."""

    transforms, takes_law = 0.0, False

    def __init__(self, stiffness: MapStiffness, shape: tuple[int, ...]) -> None:
        self._near, normal = NearTractions(stiffness, shape), stiffness.k33
        self.tangential_of_a_node = self._near.of_a_node
        self.normal_of_a_node = float(normal[np.isfinite(normal)].mean())
        self._dragged = np.empty(0, dtype=np.int64)

    def order(self, flags: Flags) -> Indices:
        """Return the nodes in ascending order."""
        return np.flatnonzero(flags)

    def factor(self, nodes: Indices, dragged: Indices, own: Reals) -> None:
        """Prepare `solve` for some nodes, and for those of them with tangential tractions of their own.

        Compliances of the nodes' own do not count.
        """
        self._near.factor(nodes)
        self._dragged = dragged

    def solve(self, normal: Reals, tangential: Reals) -> tuple[Reals, Reals]:
        """Return the pressure `[node]` and tractions `[component, dragged]` that about cause displacements."""
        u = np.zeros((3, normal.size))
        u[2], u[:2, self._dragged] = normal, tangential
        found = self._near.solve(u)
        return found[2], found[:2, self._dragged]
