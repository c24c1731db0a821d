"""The first pressure of a map: that of the waves which a grid half as fine holds, found from the next coarser one."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.in_place import InPlaceTransform, storage
from gfmd_numba.kernels.tiles import TILE
from gfmd_numba.solvers.map_contact import Level, MapContact

_COARSEST = 64  # nodes along the shorter side up to which the first guess is full contact
_SETTLED = 0.03  # relative error of the pressure with which a coarser grid is left


def levels(stiffness: Reals, shape: tuple[int, ...]) -> list[Level]:
    """Grids from the given one down, each about half as fine as the one before."""
    made = [Level.of(stiffness, shape)]
    while min(shape) > _COARSEST:
        shape = tuple(TILE * -(-n // (2 * TILE)) for n in shape)
        stiffness = stiffness[grid.wave_indices(shape)]
        made.append(Level.of(stiffness, shape))
    return made


def guess(grids: list[Level], wall: Reals, transform: InPlaceTransform, load: float | None, start: float) -> float:
    """Fill the transform of the first grid with a pressure; transforms of coarser grids, by their cost on this one.

    `start` is the uniform pressure that the coarsest grid begins with.
    """
    if len(grids) == 1:
        transform.samples[:] = start
        return 0.0
    coarse = grids[1]
    own = InPlaceTransform(coarse.shape, storage(1, coarse.shape)[0])
    smooth = _without_short_waves(wall, transform, own)
    spent = guess(grids[1:], smooth, own, load, start)
    contact = MapContact(coarse, smooth, np.empty(coarse.shape), own, load)
    contact.settle(contact.look(), _SETTLED)
    kernels.put_tiles(contact.pressure, contact.tiles, own.rows, coarse.shape[1])
    places = [np.divmod(np.arange(n) * m, n) for n, m in zip(wall.shape, coarse.shape, strict=True)]
    (above, down), (left, right) = [(first, rest / n) for (first, rest), n in zip(places, wall.shape, strict=True)]
    kernels.refine_pressure(own.samples, above, down, left, right, transform.rows)
    if load is not None:
        np.multiply(transform.samples, load / transform.samples.mean(), out=transform.samples)
    return (spent + own.n_transforms + contact.coarse_transforms) * grid.relative_cost(own.n, wall.size)


def _without_short_waves(wall: Reals, transform: InPlaceTransform, coarse: InPlaceTransform) -> Reals:
    """Heights of the waves that a coarser grid holds, on its nodes; overwrites both transforms."""
    transform.samples[:] = wall
    transform.forward()
    ky, kx = grid.wave_indices(coarse.shape)
    held = np.abs(ky) < coarse.shape[0] / 2, kx < coarse.shape[1] / 2
    coarse.spectrum[:, : kx.size] = np.where(held[0] & held[1], transform.spectrum[ky, kx], 0.0) / wall.size
    coarse.inverse()
    return np.asarray(coarse.samples.copy(), dtype=coarse.samples.dtype)
