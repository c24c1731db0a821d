"""Displacements under tractions where a law holds some nodes: body and law in parallel, without transforms."""

import math
from itertools import pairwise

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals

_FINEST, _COARSER = 0.9, 0.5  # waves that a grid is to be right for, over those at its Nyquist
_HELD = 0.1  # stiffness of a held node on coarser grids, over that of the finest waves: they see what is around it, too


class ParallelLaw:
    """Displacements d with (K + D) d = r, nearly, of each component alone, for a stiffness D of the law on each node.

    A sum over grids, each half as fine as the one before (Bramble, Pasciak and Xu, Math. Comp. 55:1, 1990): tractions
    go to each as means, and displacements come back by linear interpolation. The compliances of a node on the first
    grids add up to 1 / (1/C + D), with the compliance C of waves that the last of them still holds, and the mean D
    around the node there. What couples components is left to the iteration. A mean displacement that is held by more
    than any wave takes its part by Woodbury's identity.

    `compliances` `[component, (ny,) nx // 2 + 1]` are those of the body, on (ny,) nx nodes.
    """

    def __init__(self, compliances: Reals, shape: tuple[int, ...]) -> None:
        shapes = [(1, *shape)[-2:]]
        while max(shapes[-1]) > 1:
            most = max(shapes[-1])
            shapes.append(tuple(-(-n // 2) if 2 * n > most else n for n in shapes[-1]))
        first = np.cumsum([0, *map(math.prod, shapes[1:])])
        placed = [_places([pair[axis] for pair in shapes]) for axis in (0, 1)]
        self._grids = kernels.CoarserGrids(np.array(shapes), first, *placed[0], *placed[1])
        waves = compliances.reshape(len(compliances), shapes[0][0], -1)
        self._compliances = np.maximum.accumulate([_of_waves(waves, each, shapes[0]) for each in shapes]).T.copy()
        self._weights, self._room = np.zeros((len(waves), first[-1])), np.zeros(first[-1])
        mean = float(waves[-1, 0, 0])
        self._of_mean, self._is_held = math.prod(shape) * mean, mean < waves[-1].ravel()[1:].min()
        self._uniform: tuple[Reals, float] | None = None

    def factor(self, stiffness: Reals, weight: Reals, room: Reals) -> None:
        """Prepare `solve` for the stiffness of the law on each node, below 0 where it softens `[component, node]`.

        Nodes of no `weight` are held; those of the others are overwritten. The `room` is free.
        """
        for c, compliance in enumerate(self._compliances):
            room[c] = np.where(weight[c] > 0.0, stiffness[c], _HELD / compliance[0])
            kernels.parallel_compliance(self._grids, compliance, room[c], weight[c], self._weights[c], self._room)
        self._uniform = None
        if self._is_held:
            free = (weight > 0.0).astype(np.float64)
            self.solve(weight, free, room)
            moved = free[-1] * room[-1]
            self._uniform = moved, 1.0 / (self._of_mean + moved.sum())

    def solve(self, weight: Reals, r: Reals, d: Reals) -> None:
        """Fill the displacements that about balance the tractions r; those of held nodes mean nothing."""
        for c, weights in enumerate(self._weights):
            kernels.comply_in_parallel(self._grids, weight[c], weights, r[c], d[c], self._room)
        if self._uniform is not None:
            moved, share = self._uniform
            d[-1] -= share * (moved @ r[-1]) * moved


def _places(nodes: list[int]) -> tuple[Indices, Reals]:
    """After which node of the next coarser grid the nodes of each grid lie, and by which share of a spacing."""
    pairs = list(pairwise(nodes))
    after = [np.arange(n) * m // n for n, m in pairs]
    share = [np.arange(n) * m % n / n for n, m in pairs]
    return np.concatenate([np.empty(0, dtype=np.int64), *after]), np.concatenate([np.empty(0), *share])


def _of_waves(compliances: Reals, shape: tuple[int, ...], finest: tuple[int, ...]) -> Reals:
    """Compliance `[component]` of the waves along x and y that a grid of a shape is to be right for."""
    share = _FINEST if shape == finest else _COARSER
    y, x = (max(1, round(share * n / 2)) if n > 1 else 0 for n in shape)
    along = [compliances[:, 0, x]] * (x > 0) + [compliances[:, y, 0]] * (y > 0)
    return np.mean(along, axis=0) if along else compliances[:, 0, 0]
