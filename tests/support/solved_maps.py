"""Maps of known shape, pressed on a half-space, in L_x and E*."""

import numpy as np
import xarray as xr

import gfmd_numba
from gfmd_numba.roughness.statistics import rms_gradient


def pressed(heights, pressure, path=()):
    """Dataset of the contact under mean pressures in E*."""
    first, *others = (load / rms_gradient(heights, (1.0, 1.0)) for load in (pressure, *path))
    scene = {
        "dimension": 2,
        "body": {"poissons_ratio": 0.3},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": float(first)},
    }
    return gfmd_numba.solve({"scene": scene, "path": [{"reduced_pressure": float(load)} for load in others]}, heights)


def paraboloid(n, radius=100.0):
    x = np.arange(n) / n - 0.5
    return -(x**2 + x[:, np.newaxis] ** 2) / (2.0 * radius)


def wave(n, amplitude, axis=1):
    """One ridge [y, x] a period, whose height varies along an axis."""
    ridge = amplitude * np.cos(2.0 * np.pi * np.arange(n) / n)
    return np.broadcast_to(ridge if axis == 1 else ridge[:, np.newaxis], (n, n)).copy()


def made(touching, gap=1.0):
    """Dataset of contacts made by hand, `[..., y, x]`, with pressure 1 where they touch."""
    touching = np.asarray(touching, dtype=bool)
    dims = ("step", "y", "x")[-touching.ndim :]
    n_y, n_x = touching.shape[-2:]
    height = np.broadcast_to(np.arange(n_x, dtype=float), touching.shape)
    fields = {"gap": np.where(touching, 0.0, gap), "pressure": touching * 1.0, "height": height}
    dataset = xr.Dataset({name: (dims, values) for name, values in fields.items()})
    outer = touching.shape[:-2]
    for name, value in (("status", 0), ("mean_pressure", 1.0), ("full_contact_rms_pressure", 1.0)):
        dataset[name] = (dims[:-2], np.full(outer, value))
    return dataset.assign_coords(y=np.arange(n_y) / n_x, x=np.arange(n_x) / n_x)
