"""A punch pressed on a body, in arrays and in a scene file."""

import numpy as np

from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options


def press(heights, load, solver="conjugate_gradients", body=None, residual=1e-10):
    heights = np.atleast_2d(heights)
    body = stiffness.half_space(grid.wavenumbers(heights.shape[1])) if body is None else body
    punch = heights.max(axis=1, keepdims=True) - heights
    result = equilibrate(punch, SpectralResponse.of_normal(body), load, Options(solver, residual=residual))
    assert (result.status == 0).all()
    return result


def scene_file(length=None, youngs_modulus=None, **changes):
    scene = {
        "body": {"poissons_ratio": 0.33, "aspect_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05},
    }
    if length:
        scene["length"] = length
    if youngs_modulus:
        scene["body"]["youngs_modulus"] = youngs_modulus
    scene |= changes
    return {"scene": scene, "discretisation": {"eps_c": 0.25, "eps_f": 1 / 32, "eps_t": 0.5}, "seed": 3}
