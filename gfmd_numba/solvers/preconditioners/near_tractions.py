"""Approximate inverse of the compliance of all displacements, of profiles and of maps, on the nodes in contact."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.preconditioners.exponential_sum import ProfileInverse
from gfmd_numba.solvers.preconditioners.near_field import NearField


class NearTractions:
    """Tractions on some nodes that about cause displacements there, each component as if the others were free of them.

    Of profiles these are the inverses of both compliances, of maps the stiffness between near neighbours, where both
    tangential components have the mean of their stiffnesses. What couples the components is left out.
    `normal_of_a_node` and `tangential_of_a_node` are stiffnesses of a node among others that are held. `takes_law`
    says whether nodes may have a compliance of their own in addition, of either sign.
    """

    _tangential: ProfileInverse | NearField
    _normal: ProfileInverse | NearField

    def __init__(self, response: SpectralResponse, shape: tuple[int, ...]) -> None:
        elements = response.inverse()
        normal, tangential = elements[-1], elements[0]
        if len(shape) == 1:
            self._tangential, self._normal = (
                ProfileInverse(_reciprocal(each), each, *shape) for each in (tangential, normal)
            )
        else:
            xx, xy, yy = elements[:3]
            trace = 0.5 * (xx + yy)
            tangential = np.divide(xx * yy - xy**2, trace, out=np.zeros_like(trace), where=trace > 0.0)
            self._tangential, self._normal = (NearField(_inverse(each), shape) for each in (tangential, normal))
        share = grid.multiplicity(shape[-1]) / np.prod(shape)
        self.tangential_of_a_node = float((_inverse(tangential) * share).sum())
        self.normal_of_a_node = float((_inverse(normal) * share).sum())
        # a rigid mean is not one of the sum, in which an attraction would move it
        self.takes_law = self._normal.takes_own and not response.is_rigid

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
            self._tangential.factor(nodes[dragged], dragged.size)

    def solve(self, normal: Reals, tangential: Reals) -> tuple[Reals, Reals]:
        """Return the pressure `[node]` and tractions `[component, dragged]` that about cause displacements."""
        pressure, traction = np.empty_like(normal), np.empty_like(tangential)
        if normal.size:
            self._normal.solve(normal, pressure)
        if tangential.size:
            for u, t in zip(tangential, traction, strict=True):
                self._tangential.solve(u, t)
        return pressure, traction


def _inverse(compliance: Reals) -> Reals:
    """Stiffness; a mean displacement that is rigid has none, and one nearly so would reach over the whole map."""
    stiffness = _reciprocal(compliance)
    stiffness.flat[0] = min(stiffness.flat[0], stiffness.flat[1])
    return stiffness


def _reciprocal(compliance: Reals) -> Reals:
    return np.divide(1.0, compliance, out=np.zeros_like(compliance), where=compliance > 0.0)
