"""Transforms of one more load on cohesive rough surfaces, by Newton's method and by damped dynamics.

`python benchmarks/cohesive_load.py` takes about twenty seconds.
"""

import time

import numpy as np

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

RANGE, SURFACES = 1e-3, 6


def compare(nodes, hard_wall):
    """Transforms of the first load and of the next, and processor time of both, by each solver."""
    heights = self_affine.SelfAffineWaves(0.8, 2, nodes // 16).heights((nodes,), 4, range(SURFACES))
    punch, body = heights.max(axis=1, keepdims=True) - heights, ElasticBody(0.3, None).response((nodes,))
    work = 0.1 * np.pi * nodes / 2 * RANGE**2 * np.e**2  # x = 0.1
    laws, start = Interactions(hard_wall, cohesive=XuNeedlemanLaw(work, RANGE, 3 * RANGE)), None
    for solver in ("truncated_newton", "verlet"):
        began = time.process_time()
        first = equilibrate(punch, body, 0.02, Options(solver), laws)
        start = start or following(first, punch, 0.0)  # both go on from the same contact
        second = equilibrate(punch, body, 0.021, Options(solver), laws, start)
        seconds = time.process_time() - began
        for name, found in (("first", first), ("next", second)):
            spent, ok = found.n_transforms, int((found.status == 0).sum())
            row = f"{nodes:6} {hard_wall!s:6} {solver:17} {name:6}"
            print(f"{row} {np.median(spent):8.0f} {spent.min():9} {spent.max():8} {ok:3}")
        print(f"{'':32}{seconds:.2f} s")


if __name__ == "__main__":
    print(" nodes wall   solver            load     median  smallest  largest  ok")
    for nodes in (512, 2048, 8192):
        compare(nodes, True)
        compare(nodes, False)
