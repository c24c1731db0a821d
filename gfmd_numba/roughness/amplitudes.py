"""Random amplitudes of waves, each keyed to (seed, realisation, wave): what refines a grid keeps the surface."""

import numpy as np

from gfmd_numba.arrays import Complexes, Indices
from gfmd_numba.fourier import grid


def stream(seed: int, realisation: int) -> np.random.Generator:
    """Random numbers of one realisation; a short request is a prefix of any longer one."""
    return np.random.Generator(np.random.Philox(np.random.SeedSequence((seed, realisation))))


def complex_gaussian(seed: int, realisation: int, count: int) -> Complexes:
    """First `count` complex Gaussians of mean square 2 by Box-Muller (3.35); a prefix of any longer request."""
    radius, angle = stream(seed, realisation).random((count, 2)).T
    return np.asarray(np.sqrt(-2.0 * np.log1p(-radius)) * np.exp(2j * np.pi * angle))


def waves(seed: int, realisation: int, shape: tuple[int, ...], largest_index: int) -> Complexes:
    """Complex Gaussians of unit mean square in the layout of the transform of `[nx]` or `[ny, nx]` samples.

    Waves with an index beyond `largest_index` in any direction, and the mean, are zero.
    """
    found: Complexes = np.zeros((*shape[:-1], shape[-1] // 2 + 1), dtype=np.complex128)
    if len(shape) == 1:
        found[1 : largest_index + 1] = complex_gaussian(seed, realisation, largest_index)
        found /= np.sqrt(2.0)
        return found
    ky, kx = grid.wave_indices(shape)
    kept = (np.maximum(abs(kx), abs(ky)) <= largest_index) & ((kx > 0) | (ky > 0))
    place = np.broadcast_to(_ordinal(ky, kx), kept.shape)
    found[kept] = complex_gaussian(seed, realisation, 2 * largest_index * (largest_index + 1))[place[kept]]
    # of a pair of opposite waves along y, the layout keeps both
    found[-1 : -largest_index - 1 : -1, 0] = found[1 : largest_index + 1, 0].conj()
    found /= np.sqrt(2.0)
    return found


def _ordinal(ky: Indices, kx: Indices) -> Indices:
    """Place of a wave (kx > 0, or kx = 0 and ky > 0) when waves are counted in square rings max(|kx|, |ky|)."""
    ring = np.maximum(kx, abs(ky))
    within = np.where(kx == ring, ky + ring, np.where(ky > 0, 2 * ring + 1, 3 * ring) + kx)
    return np.asarray(2 * ring * (ring - 1) + within)
