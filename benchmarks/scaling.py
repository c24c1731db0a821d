"""Transforms and seconds against nx, for each solver as far as it is worth waiting for."""

import time

import numpy as np

from gfmd_numba.elasticity import stiffness
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.convolution import Convolution
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.options import Options

LOAD, SAMPLES = 0.007, 2**17
LARGEST = {"active_set_newton": 2**20, "conjugate_gradients": 2**15, "verlet": 2**15}


def pair_seconds(nx):
    field, row = Convolution(1, nx), np.arange(1)
    taken = []
    for _ in range(9):
        started = time.perf_counter()
        field.forward(row)
        field.inverse(row)
        taken.append(time.perf_counter() - started)
    return np.median(taken)


print(f"half-space, p* = {LOAD}, lambda_l = L_x/2, eps_c^-1 = 2, residual 1e-8; medians over the surfaces")
for hurst in (0.8, 0.3):
    for solver, largest in LARGEST.items():
        print(f"H = {hurst}, {solver}: nx, transform pairs (coarser grids by cost), seconds, over those of its pairs")
        for nx in 2 ** np.arange(13, 21):
            if nx > largest:
                break
            surfaces = max(1, SAMPLES // int(nx))
            heights = self_affine.profiles(hurst, 2, int(nx) // 4, int(nx), 2018, range(surfaces))
            punch = heights.max(axis=1, keepdims=True) - heights
            body = stiffness.half_space(grid.wavenumbers(int(nx)))
            equilibrate(punch[:1], body, LOAD, Options(solver, max_iterations=1))
            result = equilibrate(punch, body, LOAD, Options(solver))
            assert (result.status == 0).all()
            pairs, seconds = np.median(result.n_transforms) / 2, result.wall_time.mean()
            floor = result.n_transforms.mean() / 2 * pair_seconds(int(nx))
            print(f"  2^{int(np.log2(nx))} {pairs:8.0f} {seconds:10.4f} {seconds / floor:6.1f}", flush=True)
