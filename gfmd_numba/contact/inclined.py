"""Contact on inclined surfaces: where they meet, and along which normal they press.

The pressure acts along the normal of the touching surface, so that it pulls each node along the plane by the pressure
times the slope of what it touches. Friction acts along the surface, and so out of the plane by its slope. A node that
has moved along the plane meets another place of it. All are of first order in the slope, and known once the last round
has told how the surfaces have moved. What a node of `body` meets is a rigid punch, or the deformed surface of the
counter body; tractions belong to the nodes of `body`, and the counter body bears them at the places that they meet.
Lengths in L_x, stresses in E*.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.topography import Response
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.displaced_nodes import DisplacedNodes

_RESOLVED = 3 / 8  # wave index over nodes, up to which splines between the nodes are right


class _Body(Protocol):
    @property
    def heights(self) -> Reals: ...
    @property
    def share(self) -> float: ...


@dataclass(frozen=True)
class Moved:
    """Displacement of a surface, along the plane `[component, (y,) x]` and out of the body `[(y,) x]`.

    `level_along` and `level` are the same without all that slopes add: those of the flat body under the tractions on
    the nodes of `body`.
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


def moved(
    body: ElasticBody,
    level: tuple[Reals | None, Reals],
    inclined: tuple[Reals | None, Reals],
    response: Response,
) -> Moved:
    """How a surface has moved under its tractions along the plane and pressures, were surfaces level, and as they are.

    `response` is what the topography of the body adds to the latter.
    """
    pressure = inclined[1]
    flat, shape = body.response(pressure.shape), (len(pressure.shape), *pressure.shape)
    found, found_level = (
        flat.apply(np.stack((*(np.zeros(shape) if along is None else along.reshape(shape)), -each)))
        for along, each in (inclined, level)
    )
    sideways = found[:-1] if response.along is None else found[:-1] + response.along
    return Moved(sideways, found[-1] + response.u3, found_level[:-1], found_level[-1])


def pair(
    bodies: Sequence[_Body], punch: Reals | None, sliding: Reals, moved: Sequence[Moved], last: Pairing
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
    slope = bodies[1].share * below + bodies[0].share * above
    return Pairing(own.along - met - slid, slope, raised, shifted)


def change(level: Sequence[Moved], inclined: Sequence[Moved], met: Pairing) -> float:
    """Most that a pairing changes of displacements, which were those between level surfaces before (L_x)."""
    both = zip(level, inclined, strict=True)
    own = (max(abs(a.along - b.along).max(), abs(a.out - b.out).max()) for a, b in both)
    return float(max(*own, abs(met.raised).max()))


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
