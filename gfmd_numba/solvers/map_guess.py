"""The first pressure of a map: that of the waves which a grid half as fine holds, found from the next coarser one."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.kernels.tiles import TILE
from gfmd_numba.solvers.map_contact import Level, MapContact

_COARSEST = 64  # nodes along the shorter side up to which the first guess is full contact
_FIRST = np.zeros(1, dtype=np.int64)
_SETTLED = 0.03  # relative error of the pressure with which a coarser grid is left


def levels(stiffness: Reals, shape: tuple[int, ...]) -> list[Level]:
    """Grids from the given one down, each about half as fine as the one before."""
    made = [Level.of(stiffness, shape)]
    while min(shape) > _COARSEST:
        shape = tuple(TILE * -(-n // (2 * TILE)) for n in shape)
        stiffness = stiffness[grid.wave_indices(shape)]
        made.append(Level.of(stiffness, shape))
    return made


def guess(grids: list[Level], wall: Reals, transform: Transform, load: float | None, start: float) -> float:
    """Fill the transform of the first grid with a pressure; transforms of coarser grids, by their cost on this one.

    `start` is the uniform pressure that the coarsest grid begins with.
    """
    if len(grids) == 1:
        transform.samples[0] = start
        return 0.0
    coarse = grids[1]
    own = Transform(1, *coarse.shape, in_place=True)
    smooth = _without_short_waves(wall, transform, own)
    spent = guess(grids[1:], smooth, own, load, start)
    contact = MapContact(coarse, smooth, np.empty(coarse.shape), own, load)
    contact.settle(contact.look(), _SETTLED)
    kernels.put_tiles(contact.pressure, contact.tiles, contact.rows, coarse.shape[1])
    places = [np.divmod(np.arange(n) * m, n) for n, m in zip(wall.shape, coarse.shape, strict=True)]
    (above, down), (left, right) = [(first, rest / n) for (first, rest), n in zip(places, wall.shape, strict=True)]
    kernels.refine_pressure(own.samples[0], above, down, left, right, transform.memory[0])
    if load is not None:
        samples = transform.samples[0]
        np.multiply(samples, load / samples.mean(), out=samples)
    return (spent + int(own.n_transforms[0]) + contact.coarse_transforms) * grid.relative_cost(own.n, wall.size)


def _without_short_waves(wall: Reals, transform: Transform, coarse: Transform) -> Reals:
    """Heights of the waves that a coarser grid holds, on its nodes; overwrites both transforms."""
    transform.samples[0] = wall
    transform.forward(_FIRST)
    ky, kx = grid.wave_indices(coarse.shape)
    held = np.abs(ky) < coarse.shape[0] / 2, kx < coarse.shape[1] / 2
    coarse.waves[0, :, : kx.size] = np.where(held[0] & held[1], transform.waves[0, ky, kx], 0.0) / wall.size
    coarse.inverse(_FIRST)
    return np.asarray(coarse.samples[0].copy(), dtype=coarse.samples.dtype)
