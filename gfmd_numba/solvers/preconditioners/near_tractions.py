"""Approximate inverse of the compliance of all three displacements of a map, on the nodes in contact."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.map_stiffness import MapStiffness
from gfmd_numba.solvers.preconditioners.near_field import NearField


class NearTractions:
    """The stiffness between near neighbours of each component, as if the others were free of traction.

    What couples the components is left out, and both tangential ones have the mean of their stiffnesses: it is then
    positive, and costs no transform.
    """

    def __init__(self, stiffness: MapStiffness, shape: tuple[int, ...]) -> None:
        xx, xy, yy, *_ = compliance = stiffness.compliance()
        determinant, trace = xx * yy - xy**2, 0.5 * (xx + yy)
        tangential = np.divide(trace, determinant, out=np.zeros_like(trace), where=determinant > 0.0)
        normal = np.divide(1.0, compliance[5], out=np.zeros_like(trace), where=compliance[5] > 0.0)
        for symbol in (tangential, normal):  # a mean that is nearly rigid would reach over the whole map
            symbol[0, 0] = min(symbol[0, 0], symbol[0, 1])
        self._tangential, self._normal = NearField(tangential, shape), NearField(normal, shape)
        self.of_a_node = float(tangential.mean())  # tangential stiffness of a node among others that are held

    def factor(self, nodes: Indices) -> None:
        """Prepare `solve` for some nodes."""
        self._tangential.factor(nodes, nodes.size)
        self._normal.factor(nodes, nodes.size)

    def solve(self, displacement: Reals) -> Reals:
        """Tractions on the nodes that about cause displacements there `[component, node]`."""
        found = np.empty_like(displacement)
        for near, u, t in zip((self._tangential, self._tangential, self._normal), displacement, found, strict=True):
            near.solve(u, t)
        return found
