"""What a wall of finite hardness costs to solve, and how far its contact area depends on the grid.

python benchmarks/hardness.py [costs | area | paths]
"""

import sys
import time

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.evaluation import contact_area_fraction, contact_area_fraction_counted
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import Contact, LoadStep
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.roughness.surfaces import GivenSurface, given_surface
from gfmd_numba.solvers.equilibrium import Equilibrium, equilibrate
from gfmd_numba.solvers.table import Options

GRIDS = ((2**13,), (2**15,), (2**17,), (256, 256), (1024, 1024))
HARDNESSES = (1e-3, 1e-2, 0.1, 0.3, 1.0)
SHARES = (0.01, 0.07, 0.3, 0.7, 0.95)
LOAD, NODES, FINE = 0.02, 128, 2**14


def pressed(punch: Reals, load: float, hardness: float) -> Equilibrium:
    """A half-space under a load, to a residual of 1e-8."""
    body = stiffness.half_space(grid.magnitudes(punch.shape[1:]))
    return equilibrate(
        punch,
        SpectralResponse.of_normal(body),
        load,
        Options("active_set_newton"),
        Interactions(True, hardness=hardness),
    )


def costs() -> None:
    """Transforms and seconds of the mean and of the hardest case at each hardness."""
    print(f"{'grid':>12} {'p_H/(g E*)':>10} {'not ok':>6} {'transforms':>10} {'most':>5} {'s':>6} {'most':>6}")
    for shape in GRIDS:
        for hardness in HARDNESSES:
            seconds, transforms, failed = [], [], 0
            for hurst in (0.3, 0.8):
                heights = self_affine.SelfAffineWaves(hurst, 4, shape[0] // 16).heights(shape, 1, range(1))
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


def paths() -> None:
    """How 400 random paths of eight loads end, two of which are repeated, and what growing loads leave in one step."""
    ended, transforms = {"active_set_newton": 0, "conjugate_gradients": 0}, []
    draw = np.random.default_rng(0)
    for seed in range(400):
        n, is_map = int(draw.choice([32, 64, 256])), draw.random() < 0.4
        waves = self_affine.SelfAffineWaves(float(draw.choice([0.3, 0.8])), 2, n // 4)
        heights = waves.heights((n, n) if is_map else (n,), seed, range(1))[0]
        body = ElasticBody(float(draw.choice([0.3, 0.45, 0.5])), float(draw.choice([0.5, 0.05])))
        hardness, displaced = 10.0 ** draw.uniform(-2.0, 0.3), draw.random() < 0.3
        solver = str(draw.choice(list(ended)))
        surface = given_surface(heights)[0]
        loads = (
            draw.uniform(0.0, 0.4, 8) * surface.heights.max() if displaced else draw.uniform(0.01, 0.95, 8) * hardness
        )
        loads[4], loads[6] = loads[2], loads[1]
        for contact in along(surface, body, hardness, loads, solver, displaced):
            ended[solver] += int(contact.equilibrium.status[0] == 0)
            transforms.append(int(contact.equilibrium.n_transforms[0]))
    print(
        f"steps that are ok, of {len(transforms)}: {ended}; transforms: mean {np.mean(transforms):.0f}, most ", end=""
    )
    print(max(transforms))
    worst = 0.0
    for body in (ElasticBody(None, None), ElasticBody(0.3, 0.05), ElasticBody(0.5, 0.05), ElasticBody(0.49, 0.02)):
        for hurst in (0.3, 0.8):
            for shape in ((512,), (64, 64)):
                waves = self_affine.SelfAffineWaves(hurst, 2, shape[0] // 4)
                surface = given_surface(waves.heights(shape, 3, range(1))[0])[0]
                for hardness in (0.05, 0.3):
                    loads = 0.6 * hardness * np.arange(1, 9) / 8.0
                    many = along(surface, body, hardness, loads, "active_set_newton")[-1].plastic_depth
                    (one,) = along(surface, body, hardness, loads[-1:], "active_set_newton")
                    worst = max(worst, float(abs(many - one.plastic_depth).max() / np.max(one.plastic_depth)))
    print(f"eight growing loads and one: depths differ by {worst:.1e} of the largest, of 32 contacts")


def along(
    surface: GivenSurface, body: ElasticBody, hardness: float, loads: Reals, solver: str, displaced: bool = False
) -> list[Contact]:
    """The contacts along a path of mean pressures, or of displacements."""
    wall, options = Interactions(True, hardness=hardness), Options(solver)
    first, *others = (float(load) for load in loads)
    path = tuple(LoadStep(load, (0.0,) * len(surface.shape)) for load in others)
    prescribed = (None, first) if displaced else (first, None)
    problem = Problem(surface, body, wall, *prescribed, options, path=path)
    return [each for each in solve_path(problem, 0) if isinstance(each, Contact)]


if __name__ == "__main__":
    chosen = sys.argv[1:] or ["costs", "area", "paths"]
    for name in chosen:
        {"costs": costs, "area": area, "paths": paths}[name]()
