"""Contact sets of three solvers on 30 self-affine surfaces each, and what they took."""

import time

import numpy as np

from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options

SURFACES, NX = 30, 8192
body = stiffness.half_space(grid.wavenumbers(NX))
print(f"{SURFACES} surfaces, nx = {NX}, eps_c^-1 = 2, eps_f^-1 = 1024, eps_t^-1 = 2, residual 1e-8")
print("  H     p*    differing nodes   kappa (counted)       transforms (median)           seconds a surface")
print("                                                  Verlet       CG   Newton    Verlet       CG   Newton")
for hurst in (0.3, 0.5, 0.8):
    heights = self_affine.SelfAffineWaves(hurst, 2, 2048).heights((NX,), 2018, range(SURFACES))
    punch = heights.max(axis=1, keepdims=True) - heights
    for load in (0.007, 0.05, 0.3):
        results, seconds = [], []
        for solver in ("verlet", "conjugate_gradients", "active_set_newton"):
            equilibrate(punch[:1], SpectralResponse.of_normal(body), load, Options(solver, max_iterations=10))
            started = time.perf_counter()
            results.append(equilibrate(punch, SpectralResponse.of_normal(body), load, Options(solver)))
            seconds.append((time.perf_counter() - started) / SURFACES)
        assert all((result.status == 0).all() for result in results)
        touching = [result.pressure > 0 for result in results]
        kappa = touching[0].mean(axis=1) / load
        transforms = [np.median(result.n_transforms) for result in results]
        differing = sum(np.count_nonzero(touching[0] != other) for other in touching[1:])
        print(
            f"{hurst:4} {load:6} {differing:12}      {kappa.mean():8.3f} +- {kappa.std(ddof=1) / SURFACES**0.5:5.3f} "
            + "".join(f"{each:9.0f}" for each in transforms)
            + " "
            + "".join(f"{each:9.4f}" for each in seconds)
        )
