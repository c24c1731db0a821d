"""Pull-off of Johnson's adhesive wave over Tabor's parameter and the grid, and transforms against damped dynamics.

Between two closed forms, of a rigid body (small Tabor parameters) and of a law of short range (Johnson, large ones),
pull-off is compared with that of a fine grid. `--quick` leaves out the finest grids.
"""

import sys

import numpy as np
import slab_stiffness
from scipy.special import ive

from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

AMPLITUDE = 0.1
COARSEST = 0.2  # x, the largest softening of the law over the stiffness of the shortest wave


def pull_off(solver, nodes, work, length, step):
    """Largest tension on a branch drawn back from first touch, and the transforms of each step up to the jump."""
    law, x = Interactions(True, ExponentialLaw(work, length)), np.arange(nodes) / nodes
    body = slab_stiffness.slab(grid.wavenumbers(nodes), 0.3, 1.0)
    punch, before, most, spent = AMPLITUDE * (1 - np.cos(2 * np.pi * x))[np.newaxis], None, 0.0, []
    while before is None or before.touching.any():
        start = None if before is None else following(before, punch, 0.0)
        before = equilibrate(punch, SpectralResponse.of_normal(body), None, Options(solver), law, start)
        assert before.status[0] == 0
        spent.append(int(before.n_transforms[0]))
        most = max(most, -float(before.pressure.mean()))
        punch = punch + step
    return most, spent[:-1], spent[-1]


def johnson(work):
    """Pull-off of Johnson, Int. J. Solids Struct. 32:423 (1995), where the range of the law is short."""
    psi = np.linspace(1e-3, 1.2, 400001)
    return -(np.pi * AMPLITUDE * np.sin(psi) ** 2 - np.sqrt(2 * work * np.tan(psi))).min()


def rigid(work, length):
    """Pull-off of a rigid body that the wave touches in one point: the mean traction of the law."""
    return work / length * ive(0, AMPLITUDE / length)


def rough(nodes):
    """Transforms of both solvers for one more load on adhesive surfaces with x = 0.1."""
    heights = self_affine.SelfAffineWaves(0.8, 2, nodes // 16).heights((nodes,), 4, range(10))
    punch, body = heights.max(axis=1, keepdims=True) - heights, stiffness.half_space(grid.wavenumbers(nodes))
    law = Interactions(True, ExponentialLaw(0.1 * np.pi * nodes / 2 * 1e-6, 1e-3))
    spent = []
    for solver in ("truncated_newton", "verlet"):
        first = equilibrate(punch, SpectralResponse.of_normal(body), 0.02, Options(solver), law)
        second = equilibrate(
            punch, SpectralResponse.of_normal(body), 0.021, Options(solver), law, following(first, punch, 0.0)
        )
        assert (first.status == 0).all()
        assert (second.status == 0).all()
        spent.append(second.n_transforms)
    ratio = np.median(spent[1]) / np.median(spent[0])
    print(f"{nodes:6} {np.median(spent[0]):8.0f} {spent[0].max():8} {np.median(spent[1]):8.0f} {ratio:7.1f}")


grids = (2048, 512) if "--quick" in sys.argv else (16384, 8192, 2048, 512)
print("Johnson's wave, residual 1e-8: pull-off on the finest grid against closed forms, on others against that")
print(
    " nodes  w/E* L_x  Tabor       x   short range     rigid     fine   transforms a step: median, 90 %, jump  dynamics"
)
radius = 1 / (4 * np.pi**2 * AMPLITUDE)
for work in (6e-3, 1e-3):
    for tabor in (0.02, 0.1, 0.5, 1, 2, 4.9, 10):
        stretch = (radius * work**2) ** (1 / 3)  # how far adhesion stretches the body
        length, fine = stretch / tabor, None
        for nodes in grids:
            x = work / length**2 / (np.pi * nodes / 2)
            if x > COARSEST:
                continue
            step = min(length / 4, stretch / 50)
            found, spent, jump = pull_off("truncated_newton", nodes, work, length, step)
            fine = fine or found
            dynamics = ""
            if nodes <= 512 and tabor >= 0.5:
                dynamics = f"{np.median(pull_off('verlet', nodes, work, length, step)[1]):8.0f}"
            print(
                f"{nodes:6} {work:9} {tabor:6} {x:7.4f} {found / johnson(work) - 1:+12.2%} "
                f"{found / rigid(work, length) - 1:+9.2%} {found / fine - 1:+8.2%} {np.median(spent):10.0f} "
                f"{np.percentile(spent, 90):7.0f} {jump:7}  {dynamics}",
                flush=True,
            )
print("Rough surfaces, x = 0.1, range 1e-3 g L_x, from p* = 0.02 to 0.021")
print(" nodes   median  largest  damped dynamics  ratio")
for nodes in sorted(grids):
    rough(nodes)
