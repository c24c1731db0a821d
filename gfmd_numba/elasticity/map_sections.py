"""Fields below a map on vertical sections and on horizontal planes; of the volume, one plane at a time is in memory."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.elasticity import fields
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.map_fields import STRESSES, waves_kept
from gfmd_numba.elasticity.map_rough_fields import LoadedMap, waves_at_depth
from gfmd_numba.fourier import grid

Axis = Literal["x", "y"]


@dataclass(frozen=True)
class Largest:
    """Largest von Mises stress (E*) of each plane z `[z]`, and where it is (L_x)."""

    von_mises: Reals
    x: Reals
    y: Reals


def section(surface: LoadedMap, z: Reals, body: ElasticBody, across: Axis, at: float, names: tuple[str, ...]) -> Reals:
    """Named fields `[field, z, node]` on the vertical section x = at, or y = at (L_x), over the nodes along it."""
    on_section = _at_x if across == "x" else _at_y
    return np.stack([on_section(surface, max(-float(height), 0.0), body, at, names) for height in z], axis=1)


def plane(surface: LoadedMap, z: float, body: ElasticBody, names: tuple[str, ...]) -> Reals:
    """Named fields `[field, y, x]` on the plane z, on the nodes of the map."""
    return _plane(surface, max(-z, 0.0), body, names, surface.shape)


def largest_von_mises(surface: LoadedMap, z: Reals, body: ElasticBody) -> Largest:
    """Largest von Mises stress of whole planes z `[z]`, on grids that resolve the waves that are felt there."""
    found = np.empty((3, z.size))
    for i, height in enumerate(z):
        depth = max(-float(height), 0.0)
        kept = waves_kept(surface.shape, depth)
        shape = tuple(min(n, 2 * k + 2) for n, k in zip(surface.shape, kept, strict=True))
        stress = fields.von_mises(*_plane(surface, depth, body, STRESSES, shape))
        row, column = np.unravel_index(int(stress.argmax()), shape)
        found[:, i] = stress[row, column], column / shape[1], row / shape[0]
    return Largest(*found)


def _at_y(surface: LoadedMap, depth: float, body: ElasticBody, y: float, names: tuple[str, ...]) -> Reals:
    found: Complexes | float = 0.0
    for k_y, _, waves in waves_at_depth(surface, depth, body, names):
        found = found + np.exp(2j * np.pi * k_y * y) @ waves
    nx = surface.shape[1]
    spectrum = np.zeros((len(names), nx // 2 + 1), dtype=np.complex128)
    spectrum[:, : np.shape(found)[-1]] = found
    return grid.signal(spectrum, nx)


def _at_x(surface: LoadedMap, depth: float, body: ElasticBody, x: float, names: tuple[str, ...]) -> Reals:
    ny, nx = surface.shape
    spectrum = np.zeros((len(names), ny), dtype=np.complex128)
    for k_y, k_x, waves in waves_at_depth(surface, depth, body, names):
        weights = grid.multiplicity(nx)[k_x] * np.exp(2j * np.pi * k_x * x)
        for half in (k_y >= 0, k_y < 0):  # both Nyquist rows are one of the spectrum
            spectrum[:, k_y[half] % ny] += (waves @ weights)[:, half]
    mirrored = np.roll(spectrum[:, ::-1], 1, axis=1).conj()  # the real part is the mean with waves of the other sign
    return grid.signal(0.5 * (spectrum + mirrored)[:, : ny // 2 + 1], ny)


def _plane(
    surface: LoadedMap, depth: float, body: ElasticBody, names: tuple[str, ...], shape: tuple[int, ...]
) -> Reals:
    spectrum = np.zeros((len(names), shape[0], shape[1] // 2 + 1), dtype=np.complex128)
    for k_y, k_x, waves in waves_at_depth(surface, depth, body, names):
        for half in (k_y >= 0, k_y < 0):
            spectrum[:, k_y[half] % shape[0], : k_x.size] += waves[:, half]
    return np.stack([grid.signal(each, *shape) for each in spectrum])
