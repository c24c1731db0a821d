"""Processor time of a contact over that of one transform pair, against nx, load and body: one thread.

python benchmarks/scaling.py [nx ...]

Solves and pairs alternate in one run: median and range of the ratios. Other solvers go as far as is worth waiting for.
"""

import sys
import time

import numpy as np
import slab_stiffness

from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options

SAMPLES, REPETITIONS, SEED = 2**17, 7, 2026
GRIDS = (2**13, 2**15, 2**17, 2**20)
LARGEST = {"active_set_newton": 2**20, "conjugate_gradients": 2**15, "verlet": 2**13}
BODIES = {
    "half-space": stiffness.half_space,
    "slab, a = 0.1": lambda q: slab_stiffness.slab(q, 0.33, 0.1),
}


def pair_seconds(field, times):
    row = np.arange(1)
    begun = time.thread_time()
    for _ in range(times):
        field.forward(row)
        field.inverse(row)
    return (time.thread_time() - begun) / times


def measured(solver, nx, hurst, load, body):
    """Ratios to a pair, transform pairs and nodes in contact of some surfaces."""
    surfaces = max(1, SAMPLES // nx)
    heights = self_affine.SelfAffineWaves(hurst, 2, nx // 4).heights((nx,), SEED, range(surfaces))
    punch = heights.max(axis=1, keepdims=True) - heights
    symbol, field = BODIES[body](grid.wavenumbers(nx)), Transform(1, nx)
    field.sources[0][:, :nx] = heights[:1]
    equilibrate(punch[:1], SpectralResponse.of_normal(symbol), load, Options(solver))
    ratios = []
    for _ in range(REPETITIONS if solver == "active_set_newton" else 1):
        pair = pair_seconds(field, max(4, SAMPLES // nx))
        begun = time.thread_time()
        result = equilibrate(punch, SpectralResponse.of_normal(symbol), load, Options(solver))
        ratios.append((time.thread_time() - begun) / surfaces / pair)
        assert (result.status == 0).all()
    return ratios, result.n_transforms / 2, result.touching.sum(axis=1)


if __name__ == "__main__":
    print("solver, body, p*, H, nx: solve over one pair (range), transform pairs (most), nodes in contact")
    for nx in [int(argument) for argument in sys.argv[1:]] or GRIDS:
        for solver, largest in LARGEST.items():
            for load, body in ((0.007, "half-space"), (0.3, "half-space"), (0.007, "slab, a = 0.1")):
                if nx > largest or (solver != "active_set_newton" and (load, body) != (0.007, "half-space")):
                    continue
                for hurst in (0.8, 0.3):
                    ratios, pairs, nodes = measured(solver, nx, hurst, load, body)
                    print(
                        f"  {solver}, {body}, {load}, {hurst}, {nx}: {np.median(ratios):.1f} "
                        f"({min(ratios):.1f} to {max(ratios):.1f}), {np.median(pairs):.1f} ({pairs.max():.1f}), "
                        f"{nodes.mean():.0f}",
                        flush=True,
                    )
