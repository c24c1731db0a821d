"""How exact contacts without a period are, where their punch ends, and what they cost beside periodic ones.

python benchmarks/free_contacts.py [hertz | punch | times]
"""

import os
import sys
import time

os.environ["OMP_NUM_THREADS"] = "1"  # before any of them is imported: processor time of one thread

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.evaluation import contact_area_fraction
from gfmd_numba.contact.problem import Problem, given_surface
from gfmd_numba.contact.solution import solve
from gfmd_numba.contact.state import Contact
from gfmd_numba.elasticity import free_body
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.table import Options

RADIUS, HALF_WIDTH = 4.0, 0.2  # of the punch and its contact, in L_x
SQUARE = 1.1523042  # force over E* L_x times the displacement of a flat square punch: pi times 0.3667896, its capacity
SHAPES = ((2048,), (8192,), (32768,), (256, 256), (512, 512), (1024, 1024))


def pressed(heights: Reals, load: float, periodic: bool = False) -> Contact:
    """Contact of heights `[(y,) x]` in L_x under a mean pressure in g E*."""
    surface, _ = given_surface(heights, periodic=periodic)
    numerics = Options("active_set_newton", residual=1e-8)
    return solve(
        Problem(surface, ElasticBody(None, None), Interactions(True), load, None, numerics, periodic=periodic), range(1)
    )


def hertz() -> None:
    """Errors of approach, peak pressure and contact width or area of a cylinder and a sphere."""
    print("| nodes | approach | peak pressure | contact |\n|---|---|---|---|")
    a = HALF_WIDTH
    for shape in ((128,), (512,), (2048,), (64, 64), (128, 128), (256, 256), (512, 512)):
        x = np.arange(shape[-1]) / shape[-1] - 0.5  # a node at the apex
        line = len(shape) == 1
        heights = -(x**2 if line else x**2 + x[:, np.newaxis] ** 2) / (2.0 * RADIUS)
        _, gradient = given_surface(heights, periodic=False)
        load = np.pi * a**2 / (4.0 * RADIUS) if line else 4.0 * a**3 / (3.0 * RADIUS)
        approach = a**2 / (2.0 * RADIUS) * (np.log(2.0 / a) + 0.5) if line else a**2 / RADIUS
        peak = a / (2.0 * RADIUS) if line else 2.0 * a / (np.pi * RADIUS)
        contact = pressed(heights, load / gradient)
        assert contact.approach is not None
        found = (
            float(contact.approach.item()) * gradient / approach,
            float(contact.equilibrium.pressure.max()) * gradient / peak,
            float(contact_area_fraction(contact)[0]) / (2.0 * a if line else np.pi * a**2),
        )
        print(f"| {' x '.join(map(str, shape))} | " + " | ".join(f"{each - 1.0:+.1e}" for each in found) + " |")


def punch() -> None:
    """How many nodes a flat square punch is wider than its own, as its displacement under a force says."""
    print("| nodes a side | wider by (nodes) |\n|---|---|")
    for n in (32, 64, 128, 256):
        compliance = free_body.compliance((n, n))

        def displaced(pressure: Reals, n: int = n, compliance: Reals = compliance) -> Reals:
            wide = np.fft.rfft2(np.pad(pressure, (0, n))) * compliance
            return np.fft.irfft2(wide, (2 * n, 2 * n))[:n, :n]

        p, r = np.zeros((n, n)), np.ones((n, n))
        d, energy = r.copy(), float((r * r).sum())
        for _ in range(2000):  # conjugate gradients, up to a uniform displacement of 1
            moved = displaced(d)
            step = energy / float((d * moved).sum())
            p, r = p + step * d, r - step * moved
            last, energy = energy, float((r * r).sum())
            if energy < 1e-20 * n * n:
                break
            d = r + energy / last * d
        print(f"| {n} | {n * (p.sum() / n**2 / SQUARE - 1.0):+.3f} |")


def rough(shape: tuple[int, ...], seed: int = 1) -> Reals:
    """Random heights `[(y,) x]` of H = 0.8, waves from half the window to eight nodes."""
    q = grid.magnitudes(shape)
    waves = (q >= 4.0 * np.pi) & (q <= np.pi / 4.0 * shape[-1])
    amplitudes = np.where(waves, np.maximum(q, 1.0) ** (-0.8 - 0.5 * len(shape)), 0.0)
    return grid.signal(amplitudes * np.exp(2j * np.pi * np.random.default_rng(seed).random(q.shape)), *shape)


def times() -> None:
    """Processor time of contacts of rough punches without a period, and over that of the periodic contact.

    Each stands between two periodic ones, and its ratio is to their mean: the median of seven, and their range.
    """
    print("| nodes | p* | ms | over periodic | transforms (periodic) |\n|---|---|---|---|---|")
    for shape in SHAPES:
        heights = rough(shape)
        for load in (0.007, 0.05, 0.3):

            def spent(periodic: bool, heights: Reals = heights, load: float = load) -> float:
                begun = time.process_time()
                pressed(heights, load, periodic)
                return time.process_time() - begun

            spent(True), spent(False)
            before, free, ratios = spent(True), [], []
            for _ in range(7):
                free.append(spent(False))
                after = spent(True)
                ratios.append(2.0 * free[-1] / (before + after))
                before = after
            transforms = [int(pressed(heights, load, each).equilibrium.n_transforms[0]) for each in (True, False)]
            name, least, most = " x ".join(map(str, shape)), min(ratios), max(ratios)
            told = f"{1e3 * np.median(free):.3g} | {np.median(ratios):.1f} ({least:.1f} to {most:.1f})"
            print(f"| {name} | {load} | {told} | {transforms[1]} ({transforms[0]}) |", flush=True)


if __name__ == "__main__":
    {"hertz": hertz, "punch": punch, "times": times}[sys.argv[1] if len(sys.argv) > 1 else "hertz"]()
