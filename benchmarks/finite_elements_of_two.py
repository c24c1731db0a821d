"""Finite elements for two rough bodies without friction: they touch where their nodes have moved to.

The nodes of the lower body press along the normal of its deformed surface; the upper one bears their forces at the
places that they meet on its quadratic elements. Lengths in L_x, stresses in E* of both bodies together.
"""

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.sparse import coo_array


def press_together(lower, upper, shares, displacement, most=60):
    """Displacements (u1, u3) of both surfaces, each in axes out of its own body, and forces on the lower one's nodes.

    Both are `Body`s of as many columns, the upper one upside down; `shares` are their parts E*/E_i* of 1/E*. The upper
    one comes down by the `displacement` from first touch.
    """
    n = len(lower.top)
    below, above = (share * body.compliance() for share, body in zip(shares, (lower, upper), strict=True))
    low, high = (body.owned_position[1][body.top] for body in (lower, upper))
    apart = (low + high).max() - displacement - low
    moved, slope, touching = np.zeros(n), np.zeros(n), low + high > (low + high).max() - displacement
    way = moved
    for _ in range(most):
        meets = on_quadratic_elements(lower.x + way, n)
        carried = np.vstack([np.diag(slope), -np.eye(n)]), -np.vstack([meets.T @ np.diag(slope), meets.T.toarray()])
        of_lower, of_upper = below @ carried[0], above @ carried[1]
        closing = -of_lower[n:] - meets @ of_upper[n:]  # of the gap, per force
        force, touching = _active_set(closing, apart - meets @ high, touching)
        (u1, u3), (w1, w3) = (np.split(each @ force, 2) for each in (of_lower, of_upper))
        slope = _slope(lower.x + u1, low + u3)
        last, way = way, u1 - meets @ w1
        if abs(way - last).max() <= 1e-12:
            return (u1, u3), (w1, w3), force
    raise RuntimeError("the places where nodes meet did not settle")


def _active_set(closing, gap, touching, most=60):
    """Forces above 0 on nodes without a gap, of which `closing` is the part of each force."""
    for _ in range(most):
        on = np.flatnonzero(touching)
        force = np.zeros(len(gap))
        force[on] = np.linalg.solve(closing[np.ix_(on, on)], -gap[on])
        pulled, inside = touching & (force < 0.0), ~touching & (gap + closing @ force < -1e-15)
        if not (pulled | inside).any():
            return force, touching
        touching = (touching & ~pulled) | inside
    raise RuntimeError("the active set did not settle")


def on_quadratic_elements(places, n):
    """Matrix `[place, node]` of what n top nodes, evenly spaced, are worth at places of the period."""
    element, at = np.divmod((places % 1.0) * n / 2.0, 1.0)
    worth = (1.0 - at) * (1.0 - 2.0 * at), 4.0 * at * (1.0 - at), at * (2.0 * at - 1.0)
    rows, shape = np.arange(len(places)), (len(places), n)
    parts = [coo_array((each, (rows, (2 * element.astype(int) + k) % n)), shape) for k, each in enumerate(worth)]
    return sum(parts[1:], parts[0]).tocsr()


def _slope(x, z):
    """Slope of a periodic curve at its points."""
    return CubicSpline(np.append(x, x[0] + 1.0), np.append(z, z[0]), bc_type="periodic")(x, 1)
