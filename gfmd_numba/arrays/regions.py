"""Nodes that touch or have no gap, and regions of flagged nodes."""

from typing import Any

import numpy as np
import numpy.typing as npt
import scipy  # its modules load with their first use

from gfmd_numba.arrays import Flags


def on_wall(gap: Any) -> Any:
    """Nodes on which the hard wall presses, by the gap of a solved contact in an array of any kind.

    Solvers put the displacement there, and nowhere else, on the wall. The pressure of a dataset does not tell these
    nodes, as it is that of laws too.
    """
    return gap == 0.0


def closed(gap: Any) -> Any:
    """Nodes without a gap: those on the hard wall, and those where surfaces without a hard wall overlap."""
    return gap <= 0.0


def regions(flags: Flags, around: tuple[bool, ...]) -> npt.NDArray[np.int32]:
    """Label of each node `[..., (y,) x]`, from 1 on and in this order, and 0 where the flag is not set.

    Nodes of one region share sides; corners do not connect. `around` says along which of (y,) x the two ends of a
    period are joined.
    """
    sides = scipy.ndimage.generate_binary_structure(flags.ndim, 1)
    for axis in range(flags.ndim - len(around)):
        np.moveaxis(sides, axis, 0)[::2] = False
    labels, count = scipy.ndimage.label(flags, sides)
    axes = [axis for axis, joined in enumerate(around, -len(around)) if joined]
    ends = [[labels.take(end, axis).ravel() for end in (0, -1)] for axis in axes]
    if not ends or count == 0:
        return np.asarray(labels)
    one, other = (np.concatenate(side) for side in zip(*ends, strict=True))
    both = (one > 0) & (other > 0)
    graph = scipy.sparse.coo_array((np.ones(int(both.sum())), (one[both], other[both])), shape=(count + 1, count + 1))
    joined = scipy.sparse.csgraph.connected_components(graph, directed=False)[1]
    # the background is a component of its own, as no pair holds label 0
    number = np.unique(np.delete(joined, 0), return_inverse=True)[1] + 1
    return np.asarray(np.concatenate([[0], number])[labels], dtype=np.int32)
