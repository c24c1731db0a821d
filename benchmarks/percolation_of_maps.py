"""Contact area at which the gap of random maps stops connecting two sides, found by bisection in the load.

The area is that of the corrected contact, half-way between the last load with a channel and the first without. Each
surface gives two thresholds, along x and along y. Literature: near 0.42 (Dapp, Luecke, Persson & Mueser, PRL
108:244301, 2012). Usage: percolation_of_maps.py [--surfaces N]
"""

import argparse

import numpy as np

from gfmd_numba.analysis.channels import connects
from gfmd_numba.contact import solution
from gfmd_numba.contact.evaluation import contact_area_fraction, contact_area_fraction_counted
from gfmd_numba.contact.problem import Problem
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options

HALVINGS = 7  # of a range of loads by a factor 6, down to 1.4 % of the load, so half of that either way


def pressed(waves, nx, load, surface):
    problem = Problem(
        RandomSurface(waves, nx, 2012, dimension=2),
        ElasticBody(None, None),
        Interactions(hard_wall=True),
        load,
        None,
        Options("active_set_newton", residual=1e-7),
    )
    contact = solution.solve(problem, range(surface, surface + 1))
    assert contact.equilibrium.status[0] == Status.ok
    return contact


def thresholds(waves, nx, surface):
    """Corrected and counted areas at which the channels along y and x close, `[direction, 2]`."""
    known = {}

    def at(load):
        if load not in known:
            contact = pressed(waves, nx, load, surface)
            free = ~contact.equilibrium.touching[0]
            area = contact_area_fraction(contact)[0], contact_area_fraction_counted(contact)[0]
            known[load] = np.array(area), [connects(free, axis) for axis in (0, 1)]
        return known[load]

    found = []
    for axis in (0, 1):
        lower, upper = 0.1, 0.6
        assert at(lower)[1][axis]
        assert not at(upper)[1][axis]
        for _ in range(HALVINGS):
            middle = float(np.sqrt(lower * upper))
            lower, upper = (middle, upper) if at(middle)[1][axis] else (lower, middle)
        found.append(0.5 * (at(lower)[0] + at(upper)[0]))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--surfaces", type=int, default=8)
    surfaces = parser.parse_args().surfaces
    print("   H  L_x/lambda_l  lambda_l/lambda_s  1/eps_c   corrected area (error)   counted area (error)   scatter")
    for hurst in (0.3, 0.8):
        for cut_on, ratio, fineness in ((4, 16, 2), (4, 16, 4), (8, 16, 2), (4, 32, 2)):
            waves, nx = SelfAffineWaves(hurst, cut_on, cut_on * ratio), 2 * fineness * cut_on * ratio
            values = np.array([thresholds(waves, nx, surface) for surface in range(surfaces)])
            mean = values.mean(axis=1)  # over both directions, which share a surface
            error = mean.std(axis=0, ddof=1) / np.sqrt(surfaces)
            print(
                f"{hurst:4} {cut_on:13} {ratio:18} {fineness:8} {mean[:, 0].mean():14.4f} ({error[0]:.4f}) "
                f"{mean[:, 1].mean():17.4f} ({error[1]:.4f}) {values[..., 0].std(ddof=1):12.4f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
