"""Connected regions of a map: contact clusters and open gaps, on a torus or between two sides."""

import numpy as np
import numpy.typing as npt
from scipy.ndimage import label
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from gfmd_numba.arrays import Flags


def regions(flags: Flags, around_y: bool = True, around_x: bool = True) -> npt.NDArray[np.int32]:
    """Label of each node `[y, x]`, from 1 on, and 0 where the flag is not set.

    Nodes of one region share sides; corners do not connect. `around_y` and `around_x` join the two ends of a period.
    """
    labels, count = label(flags)
    ends = [
        ends
        for ends, joined in (((labels[0], labels[-1]), around_y), ((labels.T[0], labels.T[-1]), around_x))
        if joined
    ]
    if not ends or count == 0:
        return np.asarray(labels)
    one, other = (np.concatenate(side) for side in zip(*ends, strict=True))
    both = (one > 0) & (other > 0)
    graph = coo_array((np.ones(int(both.sum())), (one[both], other[both])), shape=(count + 1, count + 1))
    joined = connected_components(graph, directed=False)[1]
    # the background is a component of its own, as no pair holds label 0
    number = np.unique(np.delete(joined, 0), return_inverse=True)[1] + 1
    return np.asarray(np.concatenate([[0], number])[labels], dtype=np.int32)


def sizes(labels: npt.NDArray[np.int32]) -> npt.NDArray[np.int64]:
    """Number of nodes of each region `[region]`."""
    return np.bincount(labels.ravel())[1:].astype(np.int64)


def connects(flags: Flags, axis: int, around: bool = True) -> bool:
    """Whether a region touches both ends of `axis`; it may go `around` the other axis, whose ends are one."""
    labels = np.moveaxis(regions(flags, around and axis != 0, around and axis != 1), axis, 0)
    shared = np.intersect1d(labels[0], labels[-1])
    return bool((shared > 0).any())
