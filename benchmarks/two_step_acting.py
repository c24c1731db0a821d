"""What acts on rough bodies to each order, against finite elements: layers, tractions, a hardness, a cohesive law."""

import tempfile
import warnings
from functools import cache, partial
from pathlib import Path

import numpy as np
from finite_elements import Body, graded

import gfmd_numba
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw

NX, COARSE, FINE = 1024, 128, 256
X = np.arange(NX) / NX
HEIGHT, TOP = 0.5, 0.1
ORDERS = (0, 1, 2, 3)
AMPLITUDES = (0.01, 0.02, 0.04)
SLAB = {"poissons_ratio": 0.33, "aspect_ratio": HEIGHT}
STACKS = {"hard on soft": ((1.0, 0.3), (0.1, 0.4)), "soft on hard": ((1.0, 0.4), (10.0, 0.2))}  # E* and Poisson's ratio
TRACTIONS = {
    "normal_traction": 2e-3 * np.cos(6 * np.pi * X + 0.2) - 1e-3 * np.sin(2 * np.pi * X),
    "tangential_traction": 3e-3 * np.sin(4 * np.pi * X) + 1e-3,
}
FRICTION = {"hard_wall": {}, "friction": {"coefficient": 0.4}}


def wave(amplitude):
    return -amplitude * np.cos(2 * np.pi * X) + 0.1 * amplitude * np.cos(6 * np.pi * X + 1)


def solved(order, heights, path=(), **scene):
    """A rough body under a level punch, at the last step of a path."""
    whole = {"body": SLAB, "interface": {"hard_wall": {}}} | scene
    rough = {"method": "measured", "heights": heights, "units": {"z": "L_x"}}
    whole["body"] = whole["body"] | {"roughness": rough}
    numerics = {"topography_order": order, "residual": 1e-9}
    found = gfmd_numba.solve({"scene": whole, "numerics": numerics} | ({"path": list(path)} if path else {}))
    assert (found["status"] == 0).all()
    return found.isel(step=-1) if path else found


@cache
def mesh(amplitude, columns, stack=None, follows=False):
    """A rough slab, or layers whose interface is flat, or follows the surface."""
    heights = wave(amplitude)

    def moved(x, z):
        deep = HEIGHT if stack is None else TOP
        weight = 1.0 + z / deep if not follows else 1.0 + (z + TOP) / (HEIGHT - TOP)
        return 0 * x, heights[np.rint(x * NX).astype(int) % NX] * np.clip(weight, 0.0, 1.0)

    if stack is None:
        return Body(columns, graded(HEIGHT, 24, 0.5 / columns), SLAB["poissons_ratio"], moved)
    rows = columns // 8
    edges = np.concatenate(
        (graded(HEIGHT - TOP, rows // 2, 1.5 / columns)[:-1] - TOP, graded(TOP, rows, 0.5 / columns))
    )
    return Body(columns, edges, None, moved, materials=lambda depth: STACKS[stack][int(depth > TOP)])


def row(name, amplitude, found, by_elements):
    """Print one line for each order: errors of displacements and of the mean pressure, and what was expected."""
    coarse, fine = (by_elements(columns, NX // (2 * columns)) for columns in (COARSE, FINE))
    own = max(abs(a[::2] - b).max() for a, b in zip(fine[:2], coarse[:2], strict=True))
    largest = max(abs(each).max() for each in fine[:2])
    print(
        f"\n{name}, A = {amplitude:g}: displacements up to {largest:.1e}, mesh against coarse one {own:.1e}, ", end=""
    )
    print(f"mean pressure {fine[2]:.4e} (coarse {coarse[2]:.4e})")
    for order, each in zip(ORDERS, found, strict=True):
        moved = (each[key].values[:: NX // (2 * FINE)] for key in ("tangential_displacement", "displacement"))
        error = max(abs(a - b).max() for a, b in zip(moved, fine[:2], strict=True))
        pressure = float(each["pressure"].mean()) / fine[2] - 1.0
        print(f"  order {order}: {error:.1e}, expected {float(each['next_order']):.1e}, ", end="")
        print(f"mean pressure {pressure:+.1e}, {int(each['n_transforms'])} transforms")


def pressed(name, amplitude, mesh_of, acting, **scene):
    """Compare a contact with finite elements on which the same acts."""
    heights, depth = wave(amplitude), 0.3 * amplitude
    found = [solved(order, heights, loading={"displacement": depth}, **scene) for order in ORDERS]
    touching, clearance = found[2]["pressure"].values > 0.0, heights.max() - heights - depth

    def by_elements(columns, over):
        body = mesh_of(columns)
        more = {key: value[:, ::over] if key == "tractions" else value for key, value in acting.items()}
        solution = body.press(clearance[::over], touching[::over].copy(), **more)
        return *body.along_top(solution), -body.traction(solution).mean()

    row(name, amplitude, found, by_elements)


def cohesive(amplitude):
    heights, depth, sliding = wave(amplitude), 0.3 * amplitude, 0.1 * amplitude
    law = {"work_of_adhesion": 2e-3 * amplitude, "normal_length": 0.2 * amplitude, "tangential_length": 0.2 * amplitude}
    scene = {"interface": {"cohesive": law}, "loading": {"displacement": depth}, "path": [{"sliding": sliding}]}
    found = [solved(order, heights, **scene) for order in ORDERS]
    start = [found[2][key].values for key in ("tangential_displacement", "displacement")]

    def by_elements(columns, over):
        body, given = mesh(amplitude, columns), [each[::over] for each in start]
        clearance = (heights.max() - heights - depth)[::over]
        *moved, _, pull = body.under_law(clearance, sliding, XuNeedlemanLaw(*law.values()), given)
        return *moved, -np.average(pull, weights=np.where(np.arange(len(pull)) % 2, 2.0, 1.0))

    row("cohesive law, dragged", amplitude, found, by_elements)


def all_at(a, folder):
    """Compare everything that acts at one amplitude."""
    for stack, materials in STACKS.items():
        layers = [
            {"height": h, "youngs_modulus": modulus * (1 - nu**2), "poissons_ratio": nu}
            for h, (modulus, nu) in zip((TOP, HEIGHT - TOP), materials, strict=True)
        ]
        body = {"body": {"layers": layers, "base": "rigid"}}
        for follows, name in ((False, "flat interface"), (True, "interface that follows the surface")):
            layered = partial(mesh, a, stack=stack, follows=follows)
            pressed(f"{stack}, {name}", a, layered, {}, **body)
    prescribed = {"boundary": {key: str(folder / f"{key}.csv") for key in TRACTIONS}}
    given = {"tractions": np.array([TRACTIONS["tangential_traction"], TRACTIONS["normal_traction"]])}
    slab = partial(mesh, a)
    pressed("tractions", a, slab, given, **prescribed)
    rubbing = {"interface": FRICTION, "path": [{"sliding": 0.1}]} | prescribed
    pressed("tractions and friction", a, slab, given | {"friction": 0.4}, **rubbing)
    hard = {"interface": {"hard_wall": {"hardness": 0.9 * a}}}
    pressed("hardness", a, slab, {"hardness": 0.9 * a}, **hard)
    cohesive(a)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    folder = Path(tempfile.mkdtemp())
    for key, values in TRACTIONS.items():
        np.savetxt(folder / f"{key}.csv", values)
    for amplitude in AMPLITUDES:
        all_at(amplitude, folder)
