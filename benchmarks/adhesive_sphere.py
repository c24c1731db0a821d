"""Pull-off of a paraboloid over Tabor's parameter and the grid, compared with 3/2 pi w R (JKR) and 2 pi w R (DMT).

The punch is drawn off in steps of the range, and where the tension is largest in steps of a quarter of it. Its work of
adhesion gives JKR's contact a radius of 0.1 L_x at pull-off, where the images of the period change the curvature of the
body by 0.2 %. `--quick` stops at 512^2.
"""

import sys
import time

import numpy as np
import slab_stiffness

from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

RADIUS_AT_PULL_OFF = 0.1  # of the contact, in L_x; the paraboloid has the radius L_x


def pull_off(nodes, tabor, contact=RADIUS_AT_PULL_OFF, solver="truncated_newton", part=0.25):
    """Largest tension in w R, x, median of transforms a step, and seconds.

    Steps of a range find where the tension falls, and steps of `part` of it from two steps before how large it was.
    """
    begun = time.perf_counter()
    work = 8.0 * contact**3 / (9.0 * np.pi)
    length = work ** (2.0 / 3.0) / tabor
    law, x = Interactions(True, ExponentialLaw(work, length)), np.arange(nodes) / nodes - 0.5
    punch = 0.5 * (x**2 + x[:, np.newaxis] ** 2)[np.newaxis]
    body, spent = slab_stiffness.slab(grid.magnitudes((nodes, nodes)), 0.3, 1.0), []

    def drawn(before, height):
        start = None if before is None else following(before, punch + height, 0.0)
        found = equilibrate(
            punch + height, SpectralResponse.of_normal(body), None, Options(solver, residual=1e-6), law, start
        )
        assert found.status[0] == 0
        spent.append(int(found.n_transforms[0]))
        return found, -float(found.pressure.mean())

    def largest(before, height, step):
        most, passed = -np.inf, []
        while True:
            found, tension = drawn(before, height)
            if tension < most:
                return most, passed[-2:][0]
            most, before = tension, found
            passed.append((found, height))
            height += step

    _, (before, height) = largest(None, 0.0, length)
    most, _ = largest(before, height, part * length)
    return most / work, law.softening / (np.pi * nodes / 2.0), np.median(spent), time.perf_counter() - begun


grids = (128, 256, 512) if "--quick" in sys.argv else (128, 256, 512, 1024, 2048)
print(" nodes  Tabor      x   over JKR   over DMT   transforms a step       s")
for tabor in (1.0, 2.0, 3.0, 5.0, 7.0, 8.0):
    for nodes in grids:
        about = tabor**2 / (RADIUS_AT_PULL_OFF * nodes)  # x
        if about > 0.7 or (about < 0.2 and nodes > 1024):
            continue
        tension, x, transforms, seconds = pull_off(nodes, tabor)
        jkr, dmt = tension / (1.5 * np.pi), tension / (2.0 * np.pi)
        print(f"{nodes:4}^2 {tabor:6} {x:7.3f} {jkr:9.4f} {dmt:10.4f} {transforms:13.0f} {seconds:14.1f}", flush=True)
print("Small Tabor parameters, 128^2 nodes, a contact of 0.004 L_x, steps of 1/200 of the range")
for tabor in (0.3, 0.1, 0.03, 0.01):
    tension, x, *_ = pull_off(128, tabor, 0.004, part=0.005)
    print(f" 128^2 {tabor:6} {x:7.3f} {tension / (1.5 * np.pi):9.4f} {tension / (2.0 * np.pi):10.4f}", flush=True)
