"""Where a contact ends between two nodes of the grid.

On profiles the grid knows the stiffness K(q) of waves up to Nyquist alone: a longer wave number q acts as its alias
w(q) between -pi and pi over the node spacing. The Wiener-Hopf solution at the edge of a half-infinite contact gives the
pressures at its nodes, counted inward, as p_m ~ a_m + b (a_m - a_{m-1}), -1 <= b <= 0, with
sum a_m z^m = (1-z)^(-2) exp(sum_k c_k z^k), where c_k are the Fourier coefficients of ln K on the grid. The true edge
then lies 1 - e + b node spacings beyond the last touching node. Counted nodes so reach beyond the true edge, on average
over its position, by the excess of

    e = (1/pi) int_0^inf ln(K(q) / K(w(q))) / q^2 dq

node spacings. It is linear in ln K: 0.19 for the half-space, K = q/2; 0 where the body is so thin that K does not
depend on q (Winkler); -0.38 for an incompressible layer as thin, K ~ q^-2.

On maps the nodes along a straight edge with normal n form rows of equal pressure, and the wave q n acts as its alias
w(q n) in the first Brillouin zone of the grid: e is the same with |w(q n)| for w(q). Round contacts stretched r-fold
along y have r sides of nodes that face x for each that faces y, and the mean over their edges, in nodes a side, is
(1 / r (1 + r)) int_0^(pi/2) e / rho^3 dphi over the direction phi of n, rho^2 = (cos phi / r)^2 + sin^2 phi.
(Yastrebov, Anciaux & Molinari, Tribol. Int. 114:161, 2017, have (pi - 1 + ln 2) / 24 a side from geometry.)

The contact area counts the nodes on which the wall presses (p > 0), less the mean excess of each of their sides beyond
which it does not: `evaluation.contact_area_fraction`. A smooth contact of many nodes is known better than that. On
profiles the pressures at its two last nodes say where it ends. On maps, p^2 rises in proportion to the distance from
the edge. From the second node on it is that of the continuum, but for waves of one node spacing, which an average with
smooth weights over the distance hardly feels. `contact_area` extrapolates it to zero.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.polynomial import legendre

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.elasticity.stiffness import half_space

# below that many nodes a stretch is no half-infinite contact: its edges are then taken at their mean position
_LEAST_NODES = 6
_BEHIND = np.arange(_LEAST_NODES + 1)  # nodes of a row on a map whose pressures tell where the row ends
_NEAREST = 0.5  # node spacings from the edge on, up to `_LEAST_NODES`, from which p^2 is extrapolated
_ROUNDS, _SETTLED = 8, 0.1  # of the extrapolation, and node spacings by which the last one may still move an edge
HALF_SPACE_TO_EDGES = 0.02  # of the half-space's excess: bodies thinner than some twenty nodes have another p^2
_STRETCHED = np.linspace(0.0, 1.0, 11)  # |r - 1| / (r + 1); 0 is isotropic, 1 an edge along an axis
_WAVES = np.geomspace(1e-4, 1e10, 1200)  # over the spacing, from waves beyond any contact to those no layer is thin to
_ZONES = 20  # along a direction, beyond which waves and their aliases are independent
_HALF = 0.1900092859259187  # 1/4 - sum_k (Si(k pi) / pi - 1/2)


@dataclass(frozen=True)
class Edge:
    """Edge of a contact on a grid: how many nodes are counted too many, and the pressures next to the edge.

    A touching stretch of N nodes of a profile is shorter than N node spacings, on average over its position by `excess`
    at each of its two ends. A contact on a map is smaller than its counted nodes by a share `of_sides` of a node for
    each pair of neighbours in and out, where |r - 1| / (r + 1) is 0, 0.1 ... 1. `second` is a_1 over a_0. Ends of short
    stretches are uncertain by `short` / N nodes, as these do not feel waves that are longer than twice their length.
    The body has `added` to ln K of a half-space, by wave number over the spacing.
    """

    excess: float
    second: float
    short: float
    added: Callable[[Reals], Reals] = np.zeros_like

    @cached_property
    def of_sides(self) -> tuple[float, ...]:
        """Nodes counted too many per side, by how far contacts are stretched."""
        directions, found = 0.5 * np.pi * _CUBES, []  # edges of long contacts mostly face along an axis
        each = _along(directions, self.added) * 0.5 * np.pi * _WEIGHTS
        for stretched, bias in zip(_STRETCHED[:-1], _OF_HALF_SPACE, strict=True):
            r = (1.0 + stretched) / (1.0 - stretched)
            rho = np.hypot(np.cos(directions) / r, np.sin(directions))
            found.append(bias + float((each / rho**3).sum()) / (r * (1.0 + r)))
        return (*found, self.excess)

    def perimeter_bias(self, facing_x: Indices, facing_y: Indices | int = 0) -> Reals:
        """Nodes counted too many per side of a node on the edge of contacts with so many sides in each direction."""
        sides = np.maximum(facing_x + facing_y, 1)
        stretched = np.abs(facing_x - facing_y) / sides
        if (stretched == 1.0).all():  # edges that all face along one axis need no mean over directions
            return np.full(stretched.shape, self.excess)
        return np.asarray(np.interp(stretched, _STRETCHED, self.of_sides))


_ROOTS = (1.0 + legendre.leggauss(32)[0]) / 2.0
_CUBES, _WEIGHTS = _ROOTS**3, 1.5 * _ROOTS**2 * legendre.leggauss(32)[1]  # int_0^1 f by nodes that are dense at 0
_OF_HALF_SPACE = (
    *(0.1013778, 0.1019183, 0.1035643, 0.1063896, 0.1105189),
    *(0.116136, 0.1235081, 0.133042, 0.1454299, 0.1621301),
)
HALF_SPACE = Edge(_HALF, 2.0 - 1.851937051982466 / np.pi, 0.0)  # 2 - Si(pi) / pi


def edge(stiffness: Callable[[Reals], Reals], spacing: float) -> Edge:
    """Edge of contact on a body of a stiffness (E*/L_x) at wave numbers q > 0, on nodes of a `spacing` (L_x).

    All bodies are half-spaces to their shortest waves: what base and layers add to ln K they add to that of its edge.
    """
    added = np.log(stiffness(_WAVES / spacing) / half_space(_WAVES / spacing))
    return _edge(added.tobytes(), spacing) if added.any() else HALF_SPACE


@lru_cache(maxsize=4)
def _edge(added: bytes, spacing: float) -> Edge:
    """The same from what is added to ln K at each of the waves, in float64: all steps of a path have the same."""
    known = np.frombuffer(added)

    def logarithm(wave: Reals) -> Reals:
        return np.asarray(np.interp(np.log(wave), np.log(_WAVES), known))

    zone = np.pi * _CUBES  # ln K has a logarithm's singularity at 0
    second = HALF_SPACE.second + float(_WEIGHTS @ (logarithm(zone) * np.cos(zone)))
    long = np.array([1.0, 2.0]) * max(0.1, 2.0 * np.pi * spacing)
    long[1] = max(long[1], 1.0)
    steepness = float(np.diff(logarithm(long))[0] / np.diff(np.log(long))[0])  # K ~ q^(1 + steepness)
    excess = HALF_SPACE.excess + float(_along(np.zeros(1), logarithm)[0])
    return Edge(excess, second, 0.25 * abs(steepness) / np.pi, logarithm)


def _along(directions: Reals, logarithm: Callable[[Reals], Reals]) -> Reals:
    """The integral e of a logarithm of q, for edges whose normals have `directions` (rad) to the x axis."""
    period = 2.0 * np.pi
    near, share = np.concatenate([-_CUBES[::-1], _CUBES]), np.concatenate([_WEIGHTS[::-1], _WEIGHTS])
    q = (period * np.arange(1, _ZONES)[:, np.newaxis] + np.pi * near).ravel()  # before them, waves are their own alias
    dq = np.pi * np.tile(share, _ZONES - 1)
    last = period * (_ZONES - 0.5)
    x, y = q * np.cos(directions)[:, np.newaxis], q * np.sin(directions)[:, np.newaxis]
    alias = logarithm(np.hypot(x - period * np.round(x / period), y - period * np.round(y / period)))
    beyond = (_WEIGHTS @ logarithm(last / _CUBES) - alias @ dq / dq.sum()) / last
    return np.asarray(((logarithm(q) - alias) / q**2) @ dq + beyond) / np.pi


def radius(size: Reals, dimension: int) -> Reals:
    """Half a length, or the radius of a disc of an area."""
    return np.asarray((size / {1: 2.0, 2: np.pi}[dimension]) ** (1.0 / dimension))


def contact_length(
    pressure: Reals, touching: Flags, edge: Edge, elastic: Flags, filled: Reals, ends: bool
) -> tuple[Reals, Reals]:
    """Contact length over L_x from the pressures `[realisation, x]` at the edges of its stretches, and its error.

    The error `[realisation]` is one standard deviation, by edges whose position between two nodes is unknown. Nodes
    that are not `elastic` have known edges: each counts by the part by which it is `filled`. Profiles are periodic
    unless they have `ends`, where a stretch that reaches them has no edge.
    """
    nx, inside = pressure.shape[1], slice(None)
    if ends:
        margin, inside = ((0, 0), (_LEAST_NODES, _LEAST_NODES)), slice(_LEAST_NODES, -_LEAST_NODES)
        pressure = np.pad(pressure, margin, "edge")
        touching, elastic = np.pad(touching, margin, "edge"), np.pad(elastic, margin, "edge")
    beyond = np.zeros(len(pressure))
    unknown = np.zeros(len(pressure))
    for inward in (1, -1):
        last = elastic & ~np.roll(touching, inward, axis=1)
        resolved = last.copy()
        for m in range(1, _LEAST_NODES):
            resolved &= np.roll(elastic, -m * inward, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = pressure / np.roll(pressure, -inward, axis=1)
            b = (1.0 - ratio * edge.second) / (ratio * (edge.second - 1.0) - 1.0)
        beyond += np.where(last, np.where(resolved, 0.5 + np.clip(b, -1.0, 0.0), 0.0) - edge.excess, 0.0)[
            :, inside
        ].sum(axis=1)
        unknown += (last & ~resolved)[:, inside].sum(axis=1)
    return (filled.sum(axis=1) + beyond) / nx, np.sqrt(unknown / 12.0) / nx


def contact_area(
    pressure: Reals, touching: Flags, bias: Reals, elastic: Flags, filled: Reals, ends: tuple[bool, ...]
) -> tuple[Reals, Reals]:
    """Contact area in nodes from the pressures `[realisation, y, x]` behind its edges, and the share of sides located.

    Other sides of nodes between in and out count for their mean `bias` `[realisation]`. Of rows and columns those
    count that the edge crosses steeply, with weights whose sum is 1. Maps are periodic but for the axes (y, x) along
    which they have `ends`.
    """
    margins = tuple(_LEAST_NODES if end else 0 for end in ends)
    if any(ends):
        margin = ((0, 0), *((each, each) for each in margins))
        touching, elastic = np.pad(touching, margin, "edge"), np.pad(elastic, margin, "edge")
        pressure = np.pad(pressure, margin, "edge")
    inside = np.zeros((1, *touching.shape[1:]), dtype=np.bool_)
    inside[0][tuple(slice(each, n - each) for each, n in zip(margins, touching.shape[1:], strict=True))] = True
    area, found, sides = filled.sum(axis=(1, 2)).astype(np.float64), np.zeros(len(filled)), np.zeros(len(filled))
    for axis in (1, 2):
        for inward in (1, -1):
            p = np.moveaxis(pressure, axis, -1)[..., ::inward]
            all_in, in_elastic = (np.moveaxis(each, axis, -1)[..., ::inward] for each in (touching, elastic))
            last = in_elastic & ~np.roll(all_in, -1, axis=-1)
            last &= np.moveaxis(inside, axis, -1)[..., ::inward]
            which, row, node = np.nonzero(last)
            behind = node[:, np.newaxis] - _BEHIND
            whole = in_elastic[which[:, np.newaxis], row[:, np.newaxis], behind].all(axis=1)
            beyond, weight, settled = _extrapolated(p**2, which[whole], row[whole], behind[whole])
            moved = -bias[which]
            moved[whole] = np.where(settled, weight * (beyond - 0.5), moved[whole])
            np.add.at(area, which, moved)
            np.add.at(found, which[whole], settled)
            np.add.at(sides, which, 1.0)
    return area, np.divide(found, sides, out=np.ones_like(found), where=sides > 0.0)


def _extrapolated(square: Reals, which: Indices, row: Indices, nodes: Indices) -> tuple[Reals, Reals, Flags]:
    """Node spacings `[side]` from the last node to where p^2 is zero, weight of that, and whether it is settled.

    A row has its `nodes` `[side, behind]` in order inwards; the weight is 1 where the edge crosses it at right angles.
    """
    which, row = which[:, np.newaxis], row[:, np.newaxis]
    along = square[which, row, nodes]
    across = 0.5 * (square[which, (row + 1) % square.shape[1], nodes] - square[which, row - 1, nodes])
    beyond = np.full((len(row), 1), 0.5 - HALF_SPACE.excess)
    step = rise = tilt = np.ones(len(row))
    width = _LEAST_NODES - _NEAREST
    for _ in range(_ROUNDS):
        way = _BEHIND + beyond
        share = np.sin(np.pi / width * np.clip(way - _NEAREST, 0.0, width)) ** 2
        powers = way[..., np.newaxis] ** np.arange(3)
        weighted = (share[..., np.newaxis] * powers).swapaxes(1, 2)
        (at_edge, rise, bend) = np.linalg.solve(weighted @ powers, weighted @ along[..., np.newaxis])[..., 0].T
        lines = weighted[:, :2]
        tilt = np.linalg.solve(lines @ powers[..., :2], lines @ across[..., np.newaxis])[:, 0, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            step = 2.0 * at_edge / (rise + np.sqrt(np.maximum(rise**2 - 4.0 * at_edge * bend, 0.0)))
        beyond = np.clip(beyond + np.nan_to_num(step)[:, np.newaxis], -1.0, 1.5)
    steep = rise**2 / (rise**2 + tilt**2)
    return beyond[:, 0], steep**2 * (3.0 - 2.0 * steep), abs(step) < _SETTLED
