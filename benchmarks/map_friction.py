"""Rough maps with Coulomb friction: transforms and time of a load step to residual 1e-8 by Newton's method and Verlet.

`python benchmarks/map_friction.py 256` takes about a minute; the number is that of nodes along a side.
"""

import sys
import time

import numpy as np

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

SURFACES = 3
BODIES = {"half-space, nu = 0.3": (0.3, None), "half-space, nu = 0": (0.0, None), "slab, nu = 0.5, a = 1": (0.5, 1.0)}


def steps(solver, n, body, friction, load):
    """First loading, then (on a slab) a drag of half of what would make it slide, at 30 degrees to x."""
    heights = self_affine.SelfAffineWaves(0.8, 2, n // 8).heights((n, n), 1, range(SURFACES))
    punch, stiffness = heights.max(axis=(1, 2), keepdims=True) - heights, body.response((n, n))
    ways = [np.zeros((2, 1, 1))]
    if body.aspect_ratio is not None:
        far = 0.5 * friction * load / stiffness.elements[0, 0, 0]
        ways.append(far * np.reshape([np.cos(np.pi / 6), np.sin(np.pi / 6)], (2, 1, 1)))
    before = None
    for way in ways:
        start = None if before is None else following(before, punch, way)
        started = time.process_time()
        before = equilibrate(punch, stiffness, load, Options(solver), Interactions(True, friction=friction), start, way)
        yield before, (time.process_time() - started) / SURFACES


if __name__ == "__main__":
    nodes = int(sys.argv[1])
    for name, (nu, aspect_ratio) in BODIES.items():
        for friction, load in ((0.3, 0.02), (0.3, 0.2), (0.1, 0.05), (1.0, 0.05)):
            both = (
                steps(each, nodes, ElasticBody(nu, aspect_ratio), friction, load)
                for each in ("frictional_newton", "verlet")
            )
            for step, ((fast, seconds), (slow, long)) in enumerate(zip(*both, strict=True)):
                newton = f"Newton {np.median(fast.n_transforms):6.0f} {seconds:6.2f} s"
                verlet = f"Verlet {np.median(slow.n_transforms):6.0f} {long:6.2f} s"
                failed = f"not ok {int((fast.status != 0).sum())} and {int((slow.status != 0).sum())}"
                print(
                    f"{name:22} mu = {friction:<4g} p* = {load:<5g} step {step}: {newton}, {verlet}, {failed}",
                    flush=True,
                )
