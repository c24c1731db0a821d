"""Contacts with friction and a law of the gap: transforms of a load step to 1e-8 by Newton's method and by Verlet.

`python benchmarks/friction_and_law.py 8192 30` takes some minutes: nodes, and surfaces (of which Verlet takes two).
"""

import sys

import numpy as np

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

FEW, MOST = 2, 200_000  # surfaces and iterations of Verlet
LAWS = {"repulsion": (-1e-4, 1e-3), "attraction, x = 0.02": (0.02, 1e-3), "attraction, x = 0.2": (0.2, 2e-4)}
LOADS = ((0.3, 0.05), (0.8, 0.05), (0.8, 0.3))  # Hurst exponent, reduced pressure


def steps(solver, nx, surfaces, law, friction, hurst, load):
    """First load and half of it, on a half-space whose surface moves sideways."""
    heights = self_affine.SelfAffineWaves(hurst, 2, nx // 8).heights((nx,), 1, range(surfaces))
    punch, stiffness = heights.max(axis=1, keepdims=True) - heights, ElasticBody(0.3, None).response((nx,))
    before = None
    for pressure in (load, 0.5 * load):
        start = None if before is None else following(before, punch, 0.0)
        laws = Interactions(True, normal_law=law, friction=friction)
        before = equilibrate(punch, stiffness, pressure, Options(solver, max_iterations=MOST), laws, start)
        yield before


def transforms(found):
    low, median, high = np.percentile(found.n_transforms, (25, 50, 75))
    return f"{median:6.0f} ({low:.0f} to {high:.0f}), {int((found.status != 0).sum())} not ok"


if __name__ == "__main__":
    nx, surfaces = int(sys.argv[1]), int(sys.argv[2])
    for name, (strength, length) in LAWS.items():
        work = strength if strength < 0.0 else strength * 0.5 * np.pi * nx * length**2
        for friction in (0.3, np.inf):
            for hurst, load in LOADS:
                case = (ExponentialLaw(float(work), length), friction, hurst, load)
                both = zip(
                    steps("frictional_newton", nx, surfaces, *case), steps("verlet", nx, FEW, *case), strict=True
                )
                for step, (newton, damped) in enumerate(both):
                    ratio = np.median(damped.n_transforms / newton.n_transforms[:FEW])
                    handed = int((newton.n_iterations > 100).sum())
                    text = f"{name}, mu = {friction}, H = {hurst}, p* = {load}, step {step}: {transforms(newton)}"
                    print(f"{text}, {handed} by Verlet at last; Verlet {transforms(damped)}; {ratio:.1f}", flush=True)
