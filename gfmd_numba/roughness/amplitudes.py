"""Random amplitudes of waves, each keyed to (seed, realisation, wave): what refines a grid keeps the surface."""

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.arrays.threads import team
from gfmd_numba.fourier import grid


def stream(seed: int, realisation: int) -> np.random.Generator:
    """Random numbers of one realisation; a short request is a prefix of any longer one."""
    return np.random.Generator(np.random.Philox(np.random.SeedSequence((seed, realisation))))


def complex_gaussian(seed: int, realisation: int, count: int) -> Complexes:
    """First `count` complex Gaussians of mean square 2 by Box-Muller (3.35); a prefix of any longer request.

    Profiles take these as (3.35) has them, maps the same over sqrt(2). Each surface is then brought to its own scale,
    so that the norm is free; another one would change the last digit of every profile.
    """
    uniform, found = stream(seed, realisation).random((count, 2)), np.empty(count, dtype=np.complex128)

    def draw(some: slice) -> None:
        found[some] = _box_muller(uniform[some])

    team().by_rows(draw, uniform.shape)
    return found


def _box_muller(uniform: Reals) -> Complexes:
    radius, angle = uniform.T
    return np.asarray(np.sqrt(-2.0 * np.log1p(-radius)) * np.exp(2j * np.pi * angle))


def waves(seed: int, realisation: int, shape: tuple[int, ...], largest_index: int) -> Complexes:
    """Complex Gaussians of unit mean square in the layout of the transform of `[nx]` or `[ny, nx]` samples.

    Waves with an index beyond `largest_index` in any direction, and the mean, are zero.
    """
    all_ky, kx = grid.wave_indices((1, *shape)[-2:])
    highest, rows = min(largest_index, len(all_ky) // 2), abs(all_ky) <= largest_index
    # waves (kx > 0, or kx = 0 and ky > 0) are counted in square rings, as far as these have rows
    count = min(largest_index, kx.size - 1) * rows.sum() + (rows & (all_ky > 0)).sum()
    drawn = complex_gaussian(seed, realisation, int(count))
    found: Complexes = np.zeros((all_ky.size, kx.size), dtype=np.complex128)

    def place(some: slice) -> None:
        ky = all_ky[some]
        ring = np.maximum(kx, abs(ky))
        kept = (ring <= largest_index) & ((kx > 0) | (ky > 0))
        whole = np.minimum(ring - 1, highest)
        before = 2 * whole * (whole + 1) + (ring - 1 - whole) * (2 * highest + 1)
        within = np.where(kx == ring, ky + np.minimum(ring, highest), np.where(ky > 0, 2 * ring + 1, 3 * ring) + kx)
        found[some][kept] = drawn[(before + within)[kept]]

    team().by_rows(place, found.shape)
    # of a pair of opposite waves along y, the layout keeps both
    found[-1 : -highest - 1 : -1, 0] = found[1 : highest + 1, 0].conj()
    found /= np.sqrt(2.0)
    return found.reshape(*shape[:-1], -1)


def waves_of_columns(seed: int, realisation: int, largest_index: int, columns: slice) -> Complexes:
    """Some columns k_x of what `waves` gives on the smallest grid that holds all, without the others in memory."""
    source, first, last = stream(seed, realisation), columns.start, columns.stop
    found: Complexes = np.zeros((2 * largest_index + 1, last - first), dtype=np.complex128)
    for ring in range(1, largest_index + 1):
        drawn, end = source.random((4 * ring, 2)), min(last, ring)
        if first <= ring < last:
            found[np.arange(-ring, ring + 1), ring - first] = _box_muller(drawn[: 2 * ring + 1])
        if first < end:
            for k_y, start in ((ring, 2 * ring + 1), (-ring, 3 * ring)):
                found[k_y, : end - first] = _box_muller(drawn[start + first : start + end])
    if first == 0 < last:
        found[-1 : -largest_index - 1 : -1, 0] = found[1 : largest_index + 1, 0].conj()
    found /= np.sqrt(2.0)
    return found
