"""Processor time of conjugate gradients over that of their transforms alone: one thread, solves and pairs in turns.

python benchmarks/conjugate_gradients.py
"""

import math
import time

import numpy as np

from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options

SAMPLES, REPETITIONS, SEED = 2**17, 5, 2026
CASES = (
    ((8192,), 0.8, 0.007),
    ((8192,), 0.3, 0.007),
    ((8192,), 0.8, 0.05),
    ((8192,), 0.8, 0.3),
    ((512, 512), 0.8, 0.007),
    ((512, 512), 0.3, 0.05),
    ((512, 512), 0.8, 0.3),
    ((1024, 1024), 0.8, 0.007),
)


def seconds(call):
    begun = time.thread_time()
    result = call()
    return time.thread_time() - begun, result


def measured(shape, hurst, load):
    """Seconds of a solve, microseconds of a pair of transforms, and solves over their transforms."""
    nodes, row = math.prod(shape), np.arange(1)
    waves = self_affine.SelfAffineWaves(hurst, 2, shape[-1] // 4)
    heights = waves.heights(shape, SEED, range(max(1, SAMPLES // nodes)))
    punch = heights.max(axis=tuple(range(1, heights.ndim)), keepdims=True) - heights
    body, field = stiffness.half_space(grid.magnitudes(shape)), Transform(1, *shape)
    field.sources[0][:, :nodes] = heights[:1].reshape(1, -1)
    repeats = max(2, 2**20 // nodes)

    def pairs():
        for _ in range(repeats):
            field.forward(row)
            field.inverse(row)

    def solve():
        return equilibrate(punch, SpectralResponse.of_normal(body), load, Options("conjugate_gradients"))

    solve(), pairs()
    solves, transforms, ratios = [], [], []
    for _ in range(REPETITIONS):
        pair = seconds(pairs)[0] / repeats
        taken, result = seconds(solve)
        assert (result.status == 0).all()
        solves.append(taken / len(punch))
        transforms.append(pair)
        ratios.append(2 * taken / (result.n_transforms.sum() * pair))
    return np.median(solves), 1e6 * np.median(transforms), ratios


if __name__ == "__main__":
    print("shape, H, p*: a solve, a pair of transforms, solve over its transforms (range)")
    for case in CASES:
        solve, pair, ratios = measured(*case)
        print(
            f"  {case}: {1e3 * solve:.2f} ms, {pair:.1f} us, {np.median(ratios):.2f} "
            f"({min(ratios):.2f} to {max(ratios):.2f})",
            flush=True,
        )
