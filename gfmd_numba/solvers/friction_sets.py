"""Revision of a guess: which nodes touch, which of them stick, and which way the others slip."""

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals


def bound(friction: float, pressure: Reals) -> Reals:
    """Largest tangential traction under a pressure; where that is not positive 0, also of an infinite friction."""
    return np.multiply(friction, pressure, out=np.zeros_like(pressure), where=pressure > 0.0)


def revised(
    contact: Flags,
    slip: Indices,
    shear: Reals,
    pressure: Reals,
    gap: Reals,
    slid: Reals,
    friction: float,
    rounding: float,
) -> tuple[Flags, Indices]:
    """Contact and sign of slip `[n]` that tractions, gaps and distances slid `[n]` speak for.

    Nodes without pressure leave, nodes that overlap by more than `rounding` join. One that joins sticks where it slid
    less than friction times its overlap, and slips otherwise: a trial traction as stiff along the surface as across.
    """
    leaves = contact & ~(pressure > 0.0)
    joins = ~contact & (gap < -rounding)
    sticks = contact & (slip == 0)
    gives_way = sticks & (np.abs(shear) > bound(friction, pressure))
    turns_back = contact & (slip * slid < 0.0)
    new = slip.copy()
    new[gives_way] = -np.sign(shear[gives_way]).astype(np.int64)
    new[turns_back | leaves] = 0
    new[joins] = np.where(np.abs(slid) > bound(friction, np.abs(gap)), np.sign(slid), 0.0)[joins].astype(np.int64)
    return (contact | joins) & ~leaves, new


def middle_slip(slid: Reals, pressure: Reals, contact: Flags) -> int:
    """Node whose slip has as much friction on either side: if it sticks, that of all nodes adds up to zero."""
    nodes = np.flatnonzero(contact)
    order = nodes[np.argsort(slid[nodes], kind="stable")]
    borne = np.cumsum(np.maximum(pressure[order], 0.0))
    return int(order[min(np.searchsorted(borne, 0.5 * borne[-1]), order.size - 1)])
