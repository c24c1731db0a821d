"""Error of the tractions of a normal load with friction, made in 1 to 64 equal steps, against 256: some minutes."""

import numpy as np

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

NX, LOAD, FINEST = 1024, 0.05, 256
HEIGHTS = self_affine.SelfAffineWaves(0.8, 2, NX // 8).heights((NX,), 3, range(6))
PUNCH = HEIGHTS.max(axis=1, keepdims=True) - HEIGHTS


def loaded(stiffness, friction, steps, solver="frictional_newton"):
    before = None
    for load in LOAD * np.arange(1, steps + 1) / steps:
        start = None if before is None else following(before, PUNCH, 0.0)
        before = equilibrate(PUNCH, stiffness, load, Options(solver), Interactions(True, friction=friction), start)
        assert (before.status == 0).all()
    return before


def off(found, exact):
    return np.linalg.norm(found - exact) / np.linalg.norm(exact)


for nu in (0.3, 0.0):
    stiffness = ElasticBody(nu, None).response((NX,))
    for friction in (0.1, 0.3):
        exact = loaded(stiffness, friction, FINEST)
        cases = [("verlet", 1), *(("frictional_newton", 4**k) for k in range(4))]
        for solver, steps in cases:
            found = loaded(stiffness, friction, steps, solver)
            shear = off(found.tangential.traction, exact.tangential.traction)
            pressure, area = off(found.pressure, exact.pressure), found.touching.sum() / exact.touching.sum() - 1.0
            text = f"nu = {nu}, mu = {friction}, {steps:2} steps ({solver}): shear {shear:.3f},"
            print(f"{text} pressure {pressure:.4f}, contact {area:+.4f}", flush=True)
