"""What a wall of finite hardness costs to solve, and how far its contact area depends on the grid.

python benchmarks/hardness.py [costs | area]
"""

import sys
import time

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.contact_area import contact_area_fraction, contact_area_fraction_counted
from gfmd_numba.contact.solution import Contact
from gfmd_numba.elasticity import stiffness
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import Equilibrium, equilibrate
from gfmd_numba.solvers.options import Options

GRIDS = ((2**13,), (2**15,), (2**17,), (256, 256), (1024, 1024))
HARDNESSES = (1e-3, 1e-2, 0.1, 0.3, 1.0)
SHARES = (0.01, 0.07, 0.3, 0.7, 0.95)
LOAD, NODES, FINE = 0.02, 128, 2**14


def pressed(punch: Reals, load: float, hardness: float) -> Equilibrium:
    """A half-space under a load, to a residual of 1e-8."""
    body = stiffness.half_space(grid.magnitudes(punch.shape[1:]))
    return equilibrate(punch, body, load, Options("active_set_newton"), Interactions(True, hardness=hardness))


def costs() -> None:
    """Transforms and seconds of the mean and of the hardest case at each hardness."""
    print(f"{'grid':>12} {'p_H/(g E*)':>10} {'not ok':>6} {'transforms':>10} {'most':>5} {'s':>6} {'most':>6}")
    for shape in GRIDS:
        for hardness in HARDNESSES:
            seconds, transforms, failed = [], [], 0
            for hurst in (0.3, 0.8):
                make = self_affine.profiles if len(shape) == 1 else self_affine.maps
                heights = make(hurst, 4, shape[0] // 16, shape[0], 1, range(1))
                punch = heights.max() - heights
                for share in SHARES:
                    started = time.perf_counter()
                    found = pressed(punch, share * hardness, hardness)
                    seconds.append(time.perf_counter() - started)
                    transforms.append(int(found.n_transforms[0]))
                    failed += int(found.status[0] != 0)
            name = " x ".join(map(str, shape))
            print(
                f"{name:>12} {hardness:10g} {failed:6} {np.mean(transforms):10.0f} {max(transforms):5} "
                f"{np.mean(seconds):6.2f} {max(seconds):6.2f}",
                flush=True,
            )


def area() -> None:
    """Error of the length of a flattened sinusoidal contact at 40 places of its nodes, in nodes."""
    print(f"{'p_H / peak':>14} {'length/L_x':>10} {'counted':>8} {'corrected':>9}")
    for share in (0.1, 0.3, 0.5, 0.7, 0.85, 0.95):
        hardness = share * 2.0 * np.sqrt(LOAD)  # of Westergaard's largest pressure
        exact = _sinusoid(FINE, hardness, np.array([0.1, 0.3, 0.5, 0.7, 0.9]))[1].mean()
        counted, corrected = _sinusoid(NODES, hardness, (np.arange(40) + 0.5) / 40)
        off = ((each.mean() - exact) * NODES for each in (counted, corrected))
        print(f"{share:14g} {exact:10.5f} " + " ".join(f"{each:+8.3f}" for each in off))


def _sinusoid(nx: int, hardness: float, shifts: Reals) -> tuple[Reals, Reals]:
    x = (np.arange(nx) + shifts[:, np.newaxis]) / nx
    punch = (1.0 - np.cos(2.0 * np.pi * x)) / np.pi
    made = Contact(-punch, punch, pressed(punch, LOAD, hardness))
    return contact_area_fraction_counted(made), contact_area_fraction(made)


if __name__ == "__main__":
    chosen = sys.argv[1:] or ["costs", "area"]
    for name in chosen:
        {"costs": costs, "area": area}[name]()
