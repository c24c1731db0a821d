"""Contacts with Coulomb friction: transforms and time of a load step to residual 1e-8 by Newton's method and by Verlet.

`python benchmarks/friction.py` takes a quarter of an hour; `newton` leaves Verlet out.
"""

import sys
import time

import numpy as np

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

NX, SURFACES, FEW = 8192, 30, 2
MOST = 40_000  # of Verlet
BODIES = {"half-space, nu = 0.3": (0.3, None), "half-space, nu = 0": (0.0, None), "slab, nu = 0.3, a = 0.5": (0.3, 0.5)}


def punches(hurst, surfaces):
    heights = self_affine.SelfAffineWaves(hurst, 2, NX // 8).heights((NX,), 1, range(surfaces))
    return heights.max(axis=1, keepdims=True) - heights


def steps(solver, hurst, body, friction, load, surfaces):
    """First loading, then half of the load, then (on a slab) a drag of half of what would make it slide."""
    punch, stiffness = punches(hurst, surfaces), body.response((NX,))
    interface, options = Interactions(True, friction=friction), Options(solver, max_iterations=MOST)
    drag = 0.0 if body.aspect_ratio is None else 0.5 * friction * load / stiffness.elements[0][0]
    path = [(load, 0.0), (0.5 * load, 0.0)] + ([(0.5 * load, 0.5 * drag)] if drag else [])
    before = None
    for pressure, sliding in path:
        start = None if before is None else following(before, punch, sliding)
        started = time.perf_counter()
        before = equilibrate(punch, stiffness, pressure, options, interface, start, sliding)
        yield before, (time.perf_counter() - started) / surfaces


def row(name, body, friction, hurst, load, with_verlet):
    newton = list(steps("frictional_newton", hurst, body, friction, load, SURFACES))
    damped = list(steps("verlet", hurst, body, friction, load, FEW)) if with_verlet else [None] * len(newton)
    for step, ((found, seconds), other) in enumerate(zip(newton, damped, strict=True)):
        failed = int((found.status != 0).sum())
        text = f"{name:24} mu = {friction:<4g} H = {hurst} p* = {load:<6g} step {step}"
        text += f" {np.median(found.n_transforms):6.0f} {found.n_transforms.max():6} {failed:2} {1e3 * seconds:7.0f} ms"
        if other is not None:
            slow, long = other
            ratio = np.median(slow.n_transforms / found.n_transforms[:FEW])
            text += f" {np.median(slow.n_transforms):8.0f} {1e3 * long:8.0f} ms {ratio:7.1f}"
            text += f" {int((slow.status != 0).sum())}"
        print(text, flush=True)


if __name__ == "__main__":
    for name, (nu, aspect_ratio) in BODIES.items():
        for friction in (0.1, 0.3, 1.0):
            for hurst, load in ((0.3, 0.05), (0.8, 0.007), (0.8, 0.05), (0.8, 0.3)):
                row(name, ElasticBody(nu, aspect_ratio), friction, hurst, load, "newton" not in sys.argv)
