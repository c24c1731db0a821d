"""Where a contact ends between two nodes of the grid.

On profiles, for the spectral discretisation with the stiffness q E*/2 cut at Nyquist, the Wiener-Hopf solution at the
edge of a half-infinite contact gives the pressures at its nodes, counted inward, as p_m ~ a_m + b (a_m - a_{m-1}) with
sum a_m z^m = (1-z)^(-3/2) / g+(z) and log g+(z) = sum_k s_k z^k / k, s_k = Si(k pi)/pi - 1/2. The true edge then lies
3/4 + c + b node spacings beyond the last touching node, c = sum_k s_k. It is never farther than 3/4 + c, and one
spacing less brings the next node out of contact.

On maps the nodes along a straight edge with normal n form rows of equal pressure, and the wave q n acts as its alias
w(q n) in the first Brillouin zone of the grid. The same solution with |w(q n)| for q says that counted nodes reach
beyond the edge, on average over its position, by (1/pi) int_0^inf ln(q / |w(q n)|) / q^2 dq node spacings: by 1/4 - c
along an axis. Round contacts stretched r-fold along y have r sides of nodes that face x for each that faces y, and the
mean over their edges, in nodes a side, is (1 / 4 pi r (1 + r)) int ln(|q| / |w(q)|) / rho^3 d^2q over the whole plane,
rho^2 = (q_x / r)^2 + q_y^2. (Yastrebov, Anciaux & Molinari, Tribol. Int. 114:161, 2017, have (pi - 1 + ln 2) / 24 a
side from geometry.)
"""

import numpy as np
from scipy.special import sici

from gfmd_numba.arrays import Flags, Indices, Reals

# A touching stretch of N nodes is shorter than N dx: on average over its position by this many dx at each of its two
# ends, 1/4 - c.
EDGE_BIAS = 0.1900092859259187
# A contact on a map is smaller than its counted nodes by this share of a node for each pair of neighbours in and out,
# where |r - 1| / (r + 1) is 0, 0.1 ... 1; 0 is isotropic.
_PERIMETER_BIAS = (
    *(0.1013778, 0.1019183, 0.1035643, 0.1063896, 0.1105189, 0.1161360, 0.1235081, 0.1330420, 0.1454299, 0.1621301),
    EDGE_BIAS,
)
_FARTHEST = 1.0 - EDGE_BIAS  # 3/4 + c
_A1 = 1.5 - (float(sici(np.pi)[0]) / np.pi - 0.5)  # a_1; a_0 is 1
# below that many nodes a stretch is no half-infinite contact: its edges are then taken at their mean position
_LEAST_NODES = 6


def perimeter_bias(facing_x: Indices, facing_y: Indices) -> Reals:
    """Nodes counted too many per side of a node on the edge of contacts with so many sides in each direction."""
    sides = np.maximum(facing_x + facing_y, 1)
    return np.asarray(np.interp(np.abs(facing_x - facing_y) / sides, np.linspace(0.0, 1.0, 11), _PERIMETER_BIAS))


def contact_length(
    pressure: Reals, touching: Flags, elastic: Flags | None = None, filled: Reals | None = None
) -> tuple[Reals, Reals]:
    """Contact length over L_x from the pressures `[realisation, x]` at the edges of its stretches, and its error.

    The error `[realisation]` is one standard deviation, of the edges whose position between two nodes is unknown. Those
    of nodes that are not `elastic`, by default none, are where the share says by which such nodes are `filled`.
    """
    nx = pressure.shape[1]
    elastic = touching if elastic is None else elastic
    shares = touching.sum(axis=1) if filled is None else filled.sum(axis=1)
    beyond = np.zeros(len(pressure))
    unknown = np.zeros(len(pressure))
    for inward in (1, -1):
        edge = elastic & ~np.roll(touching, inward, axis=1)
        resolved = edge.copy()
        for m in range(1, _LEAST_NODES):
            resolved &= np.roll(elastic, -m * inward, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = pressure / np.roll(pressure, -inward, axis=1)
            b = (1.0 - ratio * _A1) / (ratio * (_A1 - 1.0) - 1.0)
        position = np.where(resolved, np.clip(_FARTHEST + b, _FARTHEST - 1.0, _FARTHEST), 0.5 - EDGE_BIAS)
        beyond += np.where(edge, position - 0.5, 0.0).sum(axis=1)
        unknown += (edge & ~resolved).sum(axis=1)
    return (shares + beyond) / nx, np.sqrt(unknown / 12.0) / nx
