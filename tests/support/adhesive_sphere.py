"""A rigid paraboloid on a half-space under the exponential law and a hard wall, by rings of uniform pressure.

Independent of any grid over x and y, of transforms and of solvers: the displacement by a ring is a difference of two
discs (Johnson, Contact Mechanics, 3.4.2), and the radius of contact is what is prescribed.
"""

import numpy as np
from scipy.special import ellipe, ellipk


def disc(r, c):
    """Displacement at r under a unit pressure on a disc of radius c, E* = 1."""
    inside = 4.0 * c / np.pi * ellipe(np.minimum(r / c, 1.0) ** 2)
    m = np.minimum(c / r, 1.0) ** 2
    outside = 4.0 * r / np.pi * (ellipe(m) - (1.0 - m) * ellipk(np.where(m < 1.0, m, 0.0)))
    return np.where(r < c, inside, outside)


def tension(work, length, rings, touching, width):
    """Tension at which the innermost rings touch, the last of them without pressure of the wall; radius of punch 1."""
    edges = width * np.arange(1, rings + 1)
    r = edges - 0.5 * width
    up_to = disc(r[:, np.newaxis], edges[np.newaxis])
    influence = np.diff(up_to, axis=1, prepend=0.0)
    free, height = np.arange(rings) >= touching, 0.5 * r**2
    pull = work / length
    gap = np.maximum(height - height[touching - 1], 0.0)
    # unknown are the pressures but of the last touching ring, and in its place the approach of the punch
    matrix = influence[:, ~free].copy()
    known = -pull * matrix[:, -1]
    matrix[:, -1] = -1.0
    for _ in range(200):
        law = -pull * np.exp(-gap[free] / length)
        rest = height + known + influence[:, free] @ law
        inner = np.linalg.solve(matrix[~free], -rest[~free])
        wanted = rest[free] + matrix[free] @ inner
        softening = -law / length
        response = influence[np.ix_(free, free)] - matrix[free] @ np.linalg.solve(
            matrix[~free], influence[np.ix_(~free, free)]
        )
        step = np.linalg.solve(np.eye(free.sum()) - response * softening, wanted - gap[free])
        gap[free] += step * min(1.0, length / abs(step).max())
        if abs(step).max() < 1e-10 * length:
            break
    else:
        raise ArithmeticError("no equilibrium")
    traction = np.concatenate([inner[:-1], [-pull], -pull * np.exp(-gap[free] / length)])
    area = np.pi * np.diff(edges**2, prepend=0.0)
    return -float(area @ traction)


def pull_off(work, length, rings):
    """Largest tension over all radii of contact, extrapolated from this number of rings and half of it."""
    coarse, fine = (_largest(work, length, n) for n in (rings // 2, rings))
    return fine + (fine - coarse) / 3.0


def _largest(work, length, rings):
    jkr = (9.0 * np.pi * work / 8.0) ** (1.0 / 3.0)
    width = (1.2 * jkr + 4.0 * np.sqrt(2.0 * length)) / rings
    stride = max(1, rings // 40)
    first, last = (max(2, int(part * jkr / width)) for part in (0.5, 1.2))
    tried = {m: tension(work, length, rings, m, width) for m in range(first, last, stride)}
    best = max(tried, key=tried.__getitem__)
    around = range(max(2, best - stride), best + stride + 1)
    return max(tension(work, length, rings, m, width) for m in around)
