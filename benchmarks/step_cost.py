"""What a step costs over its transforms, with every effect absent or present: medians of ratios taken in one run."""

import time
from functools import partial

import numpy as np

from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import begin
from gfmd_numba.solvers.iteration import Batch, Start
from gfmd_numba.solvers.table import Options

ROUNDS, LOAD = 15, 0.05


def seconds(step, repeats):
    started = time.perf_counter()
    for _ in range(repeats):
        step()
    return (time.perf_counter() - started) / repeats


def solvers(nx):
    heights = self_affine.profiles(0.8, 2, nx // 4, nx, 1, range(1))
    punch = heights.max(axis=1, keepdims=True) - heights
    condensed = stiffness.half_space(grid.wavenumbers(nx))
    both = ElasticBody(0.3, None).response((nx,)).with_mean(0.0)
    condensed[0] = 0.0

    def started(solver, body, **effects):
        batch = Batch(punch, body, np.array([LOAD]), Interactions(True, **effects), Start.at_rest(punch))
        return begin(batch, Options(solver))

    one, two = partial(started, body=condensed), partial(started, "verlet", both)
    yield "verlet, hard wall", 1, one("verlet")
    yield "fire, hard wall", 1, one("fire")
    yield "conjugate gradients", 2, one("conjugate_gradients")
    yield "verlet, exponential law", 1, one("verlet", normal_law=ExponentialLaw(0.001, 0.01))
    yield "two components, friction", 2, two(friction=0.3)
    yield "two components, cohesive", 2, two(cohesive=XuNeedlemanLaw(0.001, 0.01, 0.01))


for nx in (1024, 8192, 65536):
    field, row = Transform(1, nx), np.arange(1)

    def pair(field=field, row=row):
        field.forward(row)
        field.inverse(row)

    repeats = max(20, 2**21 // nx)
    print(f"\nnx = {nx}: one transform pair {1e6 * np.median([seconds(pair, repeats) for _ in range(ROUNDS)]):.1f} us")
    for name, pairs, solver in solvers(nx):
        solver.advance(row)
        ratios = []
        for _ in range(ROUNDS):
            floor = seconds(pair, repeats)
            ratios.append(seconds(partial(solver.advance, row), repeats) / (pairs * floor))
        low, median, high = np.quantile(ratios, [0.1, 0.5, 0.9])
        print(f"  {name:26} {pairs} pairs a step, time over transforms {median:.2f} ({low:.2f} to {high:.2f})")
