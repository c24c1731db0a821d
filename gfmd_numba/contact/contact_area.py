"""Where a contact touches: its nodes, its separate parts, and its length or area with and without corrected edges."""

from collections.abc import Callable
from functools import wraps
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.ndimage import label

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.contact import edges
from gfmd_numba.contact.state import Contact, once


def touching(contact: Contact) -> npt.NDArray[np.bool_]:
    """Nodes in contact `[realisation, (y,) x]`: those on which the hard wall presses."""
    return contact.equilibrium.touching


@once
def edge(contact: Contact) -> edges.Edge:
    """What the grid makes of the edges of the contact."""
    now = contact.heights[0]
    return edges.edge(contact.stiffness, 1.0 / now.shape[-1], now.ndim)


@once
def elastic_nodes(contact: Contact) -> npt.NDArray[np.bool_]:
    """Touching nodes that are neither plastic nor in a fringe `[realisation, (y,) x]`.

    Where such nodes are the last, pressure goes to zero as under an elastic body, and counted nodes reach too far.
    """
    plastic = contact.equilibrium.plastic
    return touching(contact) if plastic is None else touching(contact) & ~plastic & ~_fringe(contact, plastic)


@once
def filled(contact: Contact) -> npt.NDArray[Any]:
    """Share of each node that is in contact `[realisation, (y,) x]`, but for the edges of elastic nodes.

    Around a plastic spot pressure falls from the hardness to zero within a fringe. One narrower than a node is a
    node that the edge of the spot crosses: it is in contact where it bears the hardness, a share p / p_H of it. So the
    area of a wholly plastic contact is the load over the hardness.
    """
    plastic = contact.equilibrium.plastic
    if plastic is None:
        return touching(contact)
    pressure, axes = contact.equilibrium.pressure, tuple(range(1, plastic.ndim))
    hardness = pressure.max(axis=axes, keepdims=True)  # that of a fringe, which has plastic neighbours
    share = np.divide(pressure, hardness, out=np.zeros(pressure.shape), where=hardness > 0.0)
    return np.where(_fringe(contact, plastic), share, touching(contact))


def _fringe(contact: Contact, plastic: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Elastic nodes with both plastic and open neighbours."""
    now = touching(contact)
    next_to_plastic, next_to_open = (
        np.logical_or.reduce([np.roll(some, side, axis=axis) for axis in range(1, now.ndim) for side in (1, -1)])
        for some in (plastic, ~now)
    )
    return np.asarray(now & ~plastic & next_to_plastic & next_to_open)


def plastic_area_fraction(contact: Contact) -> Reals:
    """Nodes at the hardness over all nodes `[realisation]`."""
    return mean_of_nodes(np.asarray(contact.equilibrium.plastic))


@once
def n_segments(contact: Contact) -> npt.NDArray[np.int64]:
    """Number of separate stretches of contact `[realisation]`, or clusters; 0 in full contact, which has no edge."""
    now = touching(contact)
    if now.ndim == 3:
        return np.array([0 if each.all() else _clusters(each) for each in now])
    return np.asarray(np.count_nonzero(now & ~np.roll(now, 1, axis=1), axis=1))


def _clusters(flags: npt.NDArray[np.bool_]) -> int:
    """Clusters of flags `[y, x]` on a torus that touch with a side of a node."""
    labels, count = label(flags)
    joined = np.arange(count + 1)
    for one, other in ((labels[0], labels[-1]), (labels[:, 0], labels[:, -1])):
        for a, b in {(int(a), int(b)) for a, b in zip(one, other, strict=True) if a and b}:
            joined[joined == joined[a]] = joined[b]
    return len(set(joined[1:].tolist()))


@once
def perimeter(contact: Contact) -> tuple[Indices, ...]:
    """Number of neighbours along x, and on maps along y, of which one touches elastically, one not `[realisation]`."""
    now, elastic = touching(contact), elastic_nodes(contact)
    axes = tuple(range(1, len(now.shape)))
    return tuple(
        np.sum([np.count_nonzero(elastic & ~np.roll(now, side, axis=axis), axis=axes) for side in (1, -1)], axis=0)
        for axis in axes[::-1]
    )


def _of_profiles(measure: Callable[[Contact], Reals]) -> Callable[[Contact], Reals]:
    """Return a measure that is not-a-number on maps, of which it is not known."""

    @wraps(measure)
    def found(contact: Contact) -> Reals:
        realisations, *shape = contact.heights.shape
        return measure(contact) if len(shape) == 1 else np.full(realisations, np.nan)

    return found


def contact_area_fraction_counted(contact: Contact) -> Reals:
    """Touching nodes over all nodes `[realisation]`."""
    return np.asarray(mean_of_nodes(touching(contact)))


@once
def contact_area_fraction(contact: Contact) -> Reals:
    """Contact length over L_x, or area over L_x^2, with the mean correction for its edges `[realisation]`."""
    sides = perimeter(contact)
    excess = edge(contact).perimeter_bias(*sides) * sum(sides)
    return np.asarray(mean_of_nodes(filled(contact)) - excess / contact.heights[0].size)


@_of_profiles
def contact_area_fraction_error(contact: Contact) -> Reals:
    """Standard deviation of the corrected contact length over L_x: edges lie anywhere within a spacing.

    On thin bodies also their mean position is uncertain, where stretches are short.
    """
    (ends,), nodes = perimeter(contact), touching(contact).sum(axis=1)
    of_mean = edge(contact).short * ends * n_segments(contact) / np.maximum(nodes, 1)
    return np.asarray(np.sqrt(ends / 12.0 + of_mean**2) / contact.heights.shape[1])


@_of_profiles
def contact_area_fraction_edges(contact: Contact) -> Reals:
    """Contact length over L_x with each edge where the pressures at its two last nodes put it `[realisation]`."""
    return _located(contact)[0]


@_of_profiles
def contact_area_fraction_edges_error(contact: Contact) -> Reals:
    """Standard deviation of that length, from the stretches too short for it `[realisation]`."""
    return _located(contact)[1]


@once
def _located(contact: Contact) -> tuple[Reals, Reals]:
    found = contact.equilibrium
    return edges.contact_length(found.pressure, found.touching, edge(contact), elastic_nodes(contact), filled(contact))


@_of_profiles
def mean_segment_length(contact: Contact) -> Reals:
    """Mean length of a stretch of contact over L_x `[realisation]`; that of full contact is 1, that of maps nan."""
    area, segments = contact_area_fraction(contact), n_segments(contact)
    return np.asarray(np.where(area == 1.0, 1.0, area / segments))


def mean_of_nodes(field: npt.NDArray[Any]) -> Reals:
    """Mean over the nodes of each realisation."""
    return np.asarray(field.mean(axis=tuple(range(1, field.ndim))))
