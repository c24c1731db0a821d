"""kappa in the continuum limit from eps_c^-1 = 4 and 8 alone, against eps_c^-1 = 64, for several estimates of it.

Corrected estimates are extrapolated with the order 2 that they show; counted ones with order 1.
"""

import sys

import numpy as np

from gfmd_numba.contact.evaluation import measure
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import solve
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.table import Options

LEVELS = (2, 4, 8, 16, 32, 64)
VARIABLES = {"kappa_counted": 1, "kappa": 2, "kappa_edges": 2, "kappa_r": 2}


def main(realisations=60, pressure=0.007, cut_on=2, roughness_octaves=10):
    for hurst in (0.3, 0.5, 0.8):
        values = {}
        for level in LEVELS:
            cut_off = cut_on * 2**roughness_octaves
            surface = RandomSurface(SelfAffineWaves(hurst, cut_on, cut_off), 2 * cut_off * level, 2018)
            numerics = Options("active_set_newton")
            problem = Problem(surface, ElasticBody(None, None), Interactions(True), pressure, None, numerics)
            values[level] = measure(solve(problem, range(realisations)))
            assert (values[level]["status"] == 0).all()
        for name, order in VARIABLES.items():
            finest = values[64]["kappa_edges" if name.startswith("kappa_") and name != "kappa_r" else name]
            at = {level: values[level][name] for level in LEVELS}
            limit = at[8] + (at[8] - at[4]) / (2**order - 1)
            shown = "  ".join(f"{level}: {100 * (at[level].mean() / finest.mean() - 1):+6.2f} %" for level in LEVELS)
            difference = limit - finest
            error = difference.std(ddof=1) / np.sqrt(realisations) / finest.mean()
            print(
                f"H = {hurst}: {name:14} {shown}  from 4 and 8: {100 * difference.mean() / finest.mean():+.2f} "
                f"± {100 * error:.2f} %",
                flush=True,
            )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
