"""Transforms of one more load on cohesive rough maps, dragged along, by Newton's method and by damped dynamics.

`python benchmarks/cohesive_load_of_maps.py [NODES ...]`, nodes along a side: 128 and 256 without any.
"""

import sys
import time

import numpy as np

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

RANGE, LIMIT = 1e-3, 3000


def compare(nodes, hard_wall):
    """Transforms of the first load and of the next, and processor time of each, by both solvers."""
    heights = SelfAffineWaves(0.8, 2, nodes // 16).heights((nodes, nodes), 4, range(1))
    punch = heights.max(axis=(1, 2), keepdims=True) - heights
    body = ElasticBody(0.3, 0.5).response((nodes, nodes))
    work = 0.1 * np.pi * nodes / 2 * RANGE**2 * np.e**2  # x = 0.1
    laws, start = Interactions(hard_wall, cohesive=XuNeedlemanLaw(work, RANGE, 3 * RANGE)), None
    at_rest, drag = np.zeros((2, 1, 1)), np.reshape((RANGE, 0.5 * RANGE), (2, 1, 1))
    for solver in ("truncated_newton", "verlet"):
        options = Options(solver, max_iterations=LIMIT)
        for name, load, sliding in (("first", 0.02, at_rest), ("next", 0.021, drag)):
            began = time.process_time()
            from_ = None if name == "first" else start
            found = equilibrate(punch, body, load, options, laws, from_, sliding)
            if name == "first" and start is None:
                start = following(found, punch, drag)  # both go on from the same contact
            seconds, spent = time.process_time() - began, int(found.n_transforms[0])
            ended = int(found.status[0])
            print(f"{nodes:6} {hard_wall!s:6} {solver:17} {name:6} {spent:8} {seconds:8.2f} s, status {ended}")


if __name__ == "__main__":
    print(" nodes wall   solver            load   transforms")
    for each in map(int, sys.argv[1:] or ("128", "256")):
        compare(each, True)
        compare(each, False)
