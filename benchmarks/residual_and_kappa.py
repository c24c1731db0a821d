"""What stopping at a residual changes kappa by, against runs at 1e-12, and what `kappa_residual_error` says of it."""

from dataclasses import replace

import numpy as np

from gfmd_numba.contact.evaluation import gap, measure
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import solve
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.table import Options

SURFACES, SOLVERS = 8, ("verlet", "conjugate_gradients", "active_set_newton")
RESIDUALS = (1e-2, 1e-3, 1e-4, 1e-6)


def cases():
    half_space, slab, wall = ElasticBody(None, None), ElasticBody(0.33, 0.05), Interactions(True)
    for hurst in (0.0, 0.3, 0.8, 1.0):
        for pressure in (0.007, 0.05, 0.3):
            for nx in (1024, 8192):
                yield Problem(
                    RandomSurface(SelfAffineWaves(hurst, 2, nx // 8), nx, 4),
                    half_space,
                    wall,
                    pressure,
                    None,
                    Options("active_set_newton"),
                )
    surface = RandomSurface(SelfAffineWaves(0.8, 2, 256), 2048, 4)
    yield Problem(surface, slab, wall, 0.05, None, Options("active_set_newton"))
    yield Problem(surface, slab, wall, None, 0.03, Options("active_set_newton"))
    yield Problem(
        RandomSurface(SelfAffineWaves(0.8, 2, 32), 128, 4, 2),
        half_space,
        wall,
        0.05,
        None,
        Options("active_set_newton"),
    )


print(
    f"{'runs':>6} {'residual':>9} {'changed':>9} {'(most)':>9} {'stated':>9} {'covered':>9} {'p/eps':>7} {'gap/eps':>8}"
)
found = {residual: [] for residual in RESIDUALS}
for problem in cases():
    tight = solve(replace(problem, numerics=Options("active_set_newton", residual=1e-12)), range(SURFACES))
    exact = measure(tight)["kappa"]
    for residual in RESIDUALS:
        for solver in SOLVERS if problem.surface.nodes == problem.surface.nx else SOLVERS[1:]:
            loose = solve(replace(problem, numerics=Options(solver, residual=residual)), range(SURFACES))
            values = measure(loose)
            changed, stated = (abs(values["kappa"] / exact - 1.0), values["kappa_residual_error"] / exact)
            now, then = loose.equilibrium.touching, tight.equilibrium.touching
            peak = loose.equilibrium.pressure.reshape(SURFACES, -1).max(axis=1)
            eps = np.expand_dims(loose.equilibrium.residual * peak, tuple(range(1, now.ndim))) * np.ones(now.shape)
            left = (loose.equilibrium.pressure / eps)[now & ~then].max(initial=0.0)
            joined = (gap(loose) / eps)[~now & then].max(initial=0.0)
            good = np.isfinite(changed) & np.isfinite(stated)
            found[residual] += zip(changed[good], stated[good], [left] * good.sum(), [joined] * good.sum(), strict=True)
for residual, rows in found.items():
    changed, stated, left, joined = np.array(rows).T
    print(
        f"{len(rows):6} {residual:9.0e} {changed.mean():9.1e} {changed.max():9.1e} {stated.mean():9.1e} "
        f"{(changed <= stated).mean():9.2%} {left.max():7.2f} {joined.max():8.4f}"
    )
