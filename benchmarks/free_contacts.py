"""How exact contacts without a period are, where their punch ends, and what they cost next to periodic ones.

python benchmarks/free_contacts.py [hertz | punch | stamp | adhesion | rubbing | kernel | inside | times]
"""

import os
import sys
import time
from pathlib import Path
from typing import Any

os.environ["OMP_NUM_THREADS"] = "1"  # before any of them is imported: processor time of one thread

import numpy as np
from scipy.special import ellipe, ellipk

import gfmd_numba
from gfmd_numba.arrays import Reals
from gfmd_numba.contact.evaluation import contact_area_fraction, contact_radius
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import solve
from gfmd_numba.contact.state import Contact
from gfmd_numba.elasticity import free_body
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.surfaces import given_surface
from gfmd_numba.scene.form_record import Form
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
    """Errors of approach, peak pressure, contact radius and corrected nodes of Hertz's contacts."""
    print("| nodes | approach | peak pressure | radius | corrected nodes |\n|---|---|---|---|---|")
    a = HALF_WIDTH
    for shape in ((128,), (512,), (2048,), (64, 64), (128, 128), (256, 256), (512, 512)):
        x = np.arange(shape[-1]) / shape[-1] - 0.5  # a node at the apex
        line = len(shape) == 1
        heights = -(x**2 if line else x**2 + x[:, np.newaxis] ** 2) / (2.0 * RADIUS)
        load = np.pi * a**2 / (4.0 * RADIUS) if line else 4.0 * a**3 / (3.0 * RADIUS)
        approach = a**2 / (2.0 * RADIUS) * (np.log(2.0 / a) + 0.5) if line else a**2 / RADIUS
        peak = a / (2.0 * RADIUS) if line else 2.0 * a / (np.pi * RADIUS)
        area = 2.0 * a if line else np.pi * a**2
        _hertz_row(" x ".join(map(str, shape)), heights, load, (approach, peak, a, area))
    for ratio in (2.0, 5.0):
        m, b, peak = 1.0 - ratio**-2, a / ratio, 0.02
        k, e = ellipk(m), ellipe(m)
        of_x, of_y = (peak * b / (a**2 * m) * each for each in (k - e, ratio**2 * e - k))
        for n in (256, 512):
            x = np.arange(n) / n - 0.5
            exact = (peak * b * k, peak, np.sqrt(a * b), np.pi * a * b)
            name = f"{n} x {n}, 1:{ratio:g}"
            _hertz_row(name, -of_x * x**2 - of_y * x[:, np.newaxis] ** 2, 2.0 / 3.0 * np.pi * a * b * peak, exact)


def _hertz_row(name: str, heights: Reals, load: float, exact: tuple[float, ...]) -> None:
    _, gradient = given_surface(heights, periodic=False)
    contact = pressed(heights, load / gradient)
    assert contact.approach is not None
    found = (
        float(contact.approach.item()) * gradient,
        float(contact.equilibrium.pressure.max()) * gradient,
        float(contact_radius(contact)[0]),
        float(contact_area_fraction(contact)[0]),
    )
    print(
        f"| {name} | " + " | ".join(f"{one / other - 1.0:+.1e}" for one, other in zip(found, exact, strict=True)) + " |"
    )


def of_form(form: dict[str, float], load: dict[str, float], points: int, **more: Any) -> dict[str, Any]:
    """Scene file of a form of E* = 1 in a window of 1, on profiles where it bears a line load."""
    scene = {
        "dimension": 1 if "line_load" in load else 2,
        "periodic": False,
        "body": {"poissons_ratio": more.pop("nu", 0.3)},
        "form": form | {"points": points},
        "interface": {"hard_wall": {}} | more.pop("laws", {}),
        "loading": load,
    }
    return {"scene": scene, **more}


def stamp() -> None:
    """Errors of a strip and a round stamp, half of them flat, with rounded edges (closed forms in tests/contact)."""
    print("| nodes | approach | radius |\n|---|---|---|")
    radius, a, flat = 1.0, 0.2, 0.1
    angle, root = np.arcsin(flat / a), np.sqrt(a**2 - flat**2)
    line_load = 0.25 * a**2 / radius * (np.pi - 2.0 * angle - np.sin(2.0 * angle))
    form = {"width": 2.0 * flat, "edge_radius": radius}
    for n in (512, 2048, 8192):
        heights = in_units(form, n, 1)
        found = pressed(heights[0], line_load / heights[1])
        print(f"| {n} | - | {float(contact_radius(found)[0]) / a - 1.0:+.1e} |")
    angle = np.arccos(flat / a)
    force = 2.0 / radius * (a**2 * root - root**3 / 3.0 - 0.5 * flat * (a**2 * angle + flat * root))
    for n in (128, 256, 512):
        heights = in_units(form, n, 2)
        found = pressed(heights[0], force / heights[1])
        assert found.approach is not None
        approach = float(found.approach.item()) * heights[1] / (a / radius * (root - flat * angle)) - 1.0
        print(f"| {n} x {n} | {approach:+.1e} | {float(contact_radius(found)[0]) / a - 1.0:+.1e} |")


def in_units(form: dict[str, float], n: int, dimension: int) -> tuple[Reals, float]:
    """Heights of a form in a window of 1, and their rms gradient."""
    x = np.arange(n) / n - 0.5
    heights = Form(**form).heights(x, x[:, np.newaxis] if dimension == 2 else 0.0)
    return heights, given_surface(heights, periodic=False)[1]


def adhesion() -> None:
    """Largest tension of a ball over that of rings of pressure, and over pi w R, by Tabor's parameter."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
    from support.adhesive_sphere import pull_off

    print("| Tabor | nodes | tension | error |\n|---|---|---|---|")
    for tabor, work, grids in ((0.1, 3e-5, (64, 128)), (0.5, 3e-4, (64, 128, 256)), (3.0, 4e-3, (128, 256, 512))):
        length, unit = work ** (2.0 / 3.0) / tabor, (9.0 * np.pi * work / 8.0) ** (2.0 / 3.0)
        known = pull_off(work, length, 640)
        laws = {"exponential": {"work_of_adhesion": work, "range": length}}

        def tension(way: Reals, n: int, laws: dict[str, Any] = laws) -> tuple[float, float]:
            """Largest tension along a way of displacements, and where, by the parabola of the three largest."""
            path = [{"displacement": float(each)} for each in way[1:]]
            file = of_form({"radius": 1.0}, {"displacement": float(way[0])}, n, laws=laws, path=path)
            found = gfmd_numba.solve(file | {"numerics": {"residual": 1e-6}})
            assert (found["status"] == 0).all()
            tensions = -found["mean_pressure"].values
            k = min(max(int(tensions.argmax()), 1), len(tensions) - 2)
            bent, tilt, at = np.polyfit(way[k - 1 : k + 2] - way[k], tensions[k - 1 : k + 2], 2)
            return float(at - tilt**2 / (4.0 * bent)), float(way[k] - tilt / (2.0 * bent))

        _, around = tension(np.linspace(0.6, -1.2, 19) * unit, grids[0])
        for n in grids:
            largest, around = tension(around + np.linspace(0.1, -0.1, 6) * unit, n)
            print(f"| {tabor} | {n} x {n} | {largest / (np.pi * work):.4f} | {largest / known - 1.0:+.1e} |")


def rubbing() -> None:
    """Force along the drag over that of full slip, of a ball in partial slip, next to cells of Love and Cerruti."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
    from support.cells import rubbed

    print("| nu | nodes | waves | cells |\n|---|---|---|---|")
    a, friction, held = 0.3, 0.5, 0.6
    depth, force = a**2 / RADIUS, 4.0 * a**3 / (3.0 * RADIUS)
    for nu in (0.3, 0.5):
        largest = 3.0 * friction * force * (2.0 - nu) / (8.0 * (1.0 - nu) * a)
        way = largest * (1.0 - (1.0 - held) ** (2.0 / 3.0))
        for n in (16, 24, 32, 64, 128):
            laws = {"friction": {"coefficient": friction}}
            file = of_form({"radius": RADIUS}, {"displacement": depth}, n, nu=nu, laws=laws, path=[{"sliding": way}])
            waves = float(gfmd_numba.solve(file)["mean_tangential_traction"][1]) / (friction * force)
            x, cells = np.arange(n) / n - 0.5, "-"
            if n < 64:
                gap = n * ((x**2 + x[:, np.newaxis] ** 2) / (2.0 * RADIUS) - depth)
                cells = f"{rubbed(gap, nu, friction, [0.0, n * way])[1, 0].mean() / (friction * force):.4f}"
            print(f"| {nu} | {n} x {n} | {waves:.4f} | {cells} |")


def kernel() -> None:
    """Displacement by a node over that by a square cell of uniform pressure, at some nodes away; less 1."""
    print("| x | y | cell | node | difference |\n|---|---|---|---|---|")
    n = 256
    nodes = np.fft.irfft2(free_body.compliance((n, n))[0], (2 * n, 2 * n)) * n

    def corner(x: float, y: float) -> float:
        r = np.hypot(x, y)
        return float(x * np.log(y + r) + y * np.log(x + r))

    for x, y in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 0), (5, 3), (10, 0), (10, 10)):
        east, west, north, south = x + 0.5, x - 0.5, y + 0.5, y - 0.5
        cell = (corner(east, north) - corner(east, south) - corner(west, north) + corner(west, south)) / np.pi
        print(f"| {x} | {y} | {cell:.6f} | {nodes[y, x]:.6f} | {nodes[y, x] / cell - 1.0:+.1e} |")


def inside() -> None:
    """Largest shear stress on the axis below a cylinder and a ball of nu = 0.3, over the peak pressure, and where."""
    print("| nodes | shear / p0 | depth / a | error of stresses / p0 | seconds |\n|---|---|---|---|---|")
    a, depth = HALF_WIDTH, np.linspace(0.3, 1.0, 71)
    for shape in ((512,), (2048,), (64, 64), (128, 128), (256, 256)):
        n, line = shape[-1], len(shape) == 1
        load = {"line_load": np.pi * a**2 / (4.0 * RADIUS)} if line else {"force": 4.0 * a**3 / (3.0 * RADIUS)}
        peak = a / (2.0 * RADIUS) if line else 2.0 * a / (np.pi * RADIUS)
        file = of_form({"radius": RADIUS}, load, n)
        file["scene"] |= {"body": {"youngs_modulus": 1.0 - 0.3**2, "poissons_ratio": 0.3}, "length": 1.0}
        contact, begun = gfmd_numba.solve(file), time.process_time()
        found = gfmd_numba.body_fields(contact, -a * depth, **({} if line else {"y": 0.5}))
        spent, axis = time.process_time() - begun, found.isel(x=n // 2)
        across, along = axis["stress_1"].values / peak, axis["stress_3"].values / peak
        exact = -1.0 / np.sqrt(1.0 + depth**2) if line else -1.0 / (1.0 + depth**2)
        exact_across = 2.0 * depth + (1.0 + 2.0 * depth**2) * exact
        if not line:
            exact_across = -1.3 * (1.0 - depth * np.arctan2(1.0, depth)) - 0.5 * exact
        error = max(abs(along - exact).max(), abs(across - exact_across).max())
        shear = 0.5 * abs(along - across)
        at = depth[shear.argmax()]
        print(f"| {' x '.join(map(str, shape))} | {shear.max():.4f} | {at:.2f} | {error:.1e} | {spent:.2g} |")


def punch() -> None:
    """How many nodes a flat square punch is wider than its own, as its displacement under a force says."""
    print("| nodes a side | wider by (nodes) |\n|---|---|")
    for n in (32, 64, 128, 256):
        compliance = free_body.compliance((n, n))[0]

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


PARTS = (hertz, punch, stamp, adhesion, rubbing, kernel, inside, times)

if __name__ == "__main__":
    {part.__name__: part for part in PARTS}[sys.argv[1] if len(sys.argv) > 1 else "hertz"]()
