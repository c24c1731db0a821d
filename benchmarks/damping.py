"""Transforms of Verlet to residual 1e-8 against its damping, medians over surfaces, for several interfaces."""

from dataclasses import replace

import numpy as np

from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import solve
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.table import Options

DAMPINGS, SURFACES, MOST = (0.25, 0.5, 1.0, 2.0), 10, 30_000


def problem(hurst, pressure, nx):
    surface = RandomSurface(SelfAffineWaves(hurst, 2, nx // 8), nx, 4)
    return Problem(surface, ElasticBody(None, None), Interactions(True), pressure, None, Options("verlet"))


def row(name, asked, surfaces=SURFACES):
    medians = []
    for damping in DAMPINGS:
        numerics = Options("verlet", damping=damping, max_iterations=MOST)
        found = solve(replace(asked, numerics=numerics), range(surfaces)).equilibrium
        failed = int((found.status != 0).sum())
        medians.append(f"{np.median(found.n_transforms):7.0f}{f' ({failed})' if failed else '':5}")
    print(f"{name:34}", *medians, flush=True)


print(f"{'damping':34}", *(f"{damping:7g}     " for damping in DAMPINGS))
for nx in (2048, 8192):
    for hurst in (0.0, 0.3, 0.5, 0.8, 1.0):
        for pressure in (0.007, 0.05, 0.3):
            row(f"nx = {nx}, H = {hurst}, p* = {pressure}", problem(hurst, pressure, nx))
for hurst in (0.3, 0.8):
    for pressure in (0.007, 0.05, 0.3):
        common = problem(hurst, pressure, 1024)
        named = f"H = {hurst}, p* = {pressure}"
        row(
            f"friction 0.3, {named}",
            replace(common, body=ElasticBody(0.3, None), interface=Interactions(True, None, 0.3)),
        )
        row(
            f"sticking, {named}",
            replace(common, body=ElasticBody(0.3, None), interface=Interactions(True, None, np.inf)),
        )
        row(f"adhesion, {named}", replace(common, interface=Interactions(True, ExponentialLaw(2e-5, 0.004))))
        row(f"slab a = 0.05, {named}", replace(common, body=ElasticBody(0.33, 0.05)))
        row(
            f"friction, slab, {named}",
            replace(common, body=ElasticBody(0.33, 0.1), interface=Interactions(True, None, 0.3)),
        )
