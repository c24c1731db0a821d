"""Rough punches and the half-space below them, for interaction laws."""

import numpy as np

import gfmd_numba
from gfmd_numba.elasticity import stiffness
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine


def surface(nx=512):
    heights = self_affine.SelfAffineWaves(0.8, 2, 32).heights((nx,), 4, range(3))
    return heights.max(axis=1, keepdims=True) - heights, stiffness.half_space(grid.wavenumbers(nx))


def nearly_flat(tmp_path, path, first, **interface):
    """An almost flat punch on a slab: the mean displacement is the only degree of freedom that counts."""
    n = 256
    np.save(tmp_path / "flat.npy", 1e-9 * np.cos(2 * np.pi * np.arange(n) / n))
    return gfmd_numba.solve(
        {
            "scene": {
                "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.1},
                "roughness": {"method": "measured", "file": str(tmp_path / "flat.npy")},
                "interface": interface,
                "loading": {"displacement": first},
            },
            "path": [value if isinstance(value, dict) else {"displacement": value} for value in path],
        }
    )


def area_of_loop(path, found):
    """Area of the loop of pressure and displacement, where the pressure jumps at the places found."""
    pressure, at = found["mean_pressure"].values, found["jump_displacement"].values
    jumped = np.flatnonzero(~np.isnan(at))
    twice, sides = np.repeat(jumped, 2), np.stack([pressure[jumped - 1], pressure[jumped]], axis=1)
    return np.trapezoid(np.insert(pressure, twice, sides.ravel()), np.insert(path, twice, at[twice]))
