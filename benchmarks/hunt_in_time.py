"""Random rough punches on random viscoelastic bodies: which contacts are not solved, and what they cost.

python benchmarks/hunt_in_time.py KIND [dimension] [number] [first seed]; KIND is `speed` (punches that slide steadily),
or that of random paths of dwells, loads and sliding at any rate: `friction`, `adhesion`, `both` or `cohesion`. It
prints a line for each that is not certified, how many miss their tolerance in time after 1024 divisions, and the
percentiles of the transforms that all took.
"""

import argparse
import warnings

import numpy as np

import gfmd_numba

GRADIENT = 0.01
TOLERANCE = 0.1  # in time, as the certificates of single contacts are what counts here


def body_of(draw: np.random.Generator) -> dict:
    """One to four branches over four decades of time, a slab in some."""
    branches = [
        {"modulus": float(10.0 ** draw.uniform(-0.5, 2.0)), "time": float(10.0 ** draw.uniform(-4.0, 0.0))}
        for _ in range(draw.integers(1, 5))
    ]
    body = {"poissons_ratio": float(draw.uniform(0.0, 0.5)), "relaxation": branches}
    return body | ({"aspect_ratio": float(10.0 ** draw.uniform(-1.5, 0.0))} if draw.random() < 0.3 else {})


def steady(draw: np.random.Generator, dimension: int) -> dict:
    """A sliding speed, and a displacement of the punch in a few."""
    body, loading = body_of(draw), {"reduced_pressure": float(10.0 ** draw.uniform(-2.5, 0.3))}
    if "aspect_ratio" in body and draw.random() < 0.5 and body["poissons_ratio"] < 0.49:
        loading = {"displacement": float(10.0 ** draw.uniform(-4.0, -2.5))}
    return {"body": body, "loading": loading | {"speed": float(10.0 ** draw.uniform(-5.0, 1.0))}}


def history(draw: np.random.Generator, dimension: int, kind: str) -> dict:
    """Four steps at random rates, some at once: dwells, loads that change, on slabs a punch that slides to and fro."""
    body, interface = body_of(draw), {"hard_wall": {}}
    moves = "aspect_ratio" in body and draw.random() < 0.7 and body["poissons_ratio"] < 0.49
    key, least = "displacement" if moves else "reduced_pressure", 0.0 if kind == "friction" else -0.02
    size = (lambda: float(GRADIENT * draw.uniform(least, 0.1))) if moves else (lambda: float(10 ** draw.uniform(-2, 0)))
    if kind in ("friction", "both"):
        interface["friction"] = {"coefficient": np.inf if draw.random() < 0.1 else float(10 ** draw.uniform(-1.5, 0.2))}
    law = {"work_of_adhesion": GRADIENT**2 * float(10.0 ** draw.uniform(-3.0, -1.5))}
    if kind in ("adhesion", "both"):
        interface["exponential"] = law | {"range": GRADIENT * float(10.0 ** draw.uniform(-1.5, -0.5))}
    if kind == "cohesion":
        lengths = (GRADIENT * 10.0 ** draw.uniform(-1.0, -0.3, 2)).tolist()
        interface["cohesive"] = law | dict(zip(("normal_length", "tangential_length"), lengths, strict=True))
    path = []
    for _ in range(4):
        step = {} if draw.random() < 0.2 else {"duration": float(10.0 ** draw.uniform(-3.0, 1.0))}
        if draw.random() < 0.6 or not step:
            step[key] = size()
        if "aspect_ratio" in body and kind != "adhesion" and draw.random() < 0.6:
            names = ("sliding", "sliding_y")[:dimension]
            step |= {name: float(0.02 * GRADIENT * draw.normal()) for name in names}
        path.append(step)
    return {"body": body, "interface": interface, "loading": {key: abs(size())}, "path": path}


def scene(kind: str, dimension: int, seed: int) -> dict:
    """The file of a seed."""
    draw = np.random.default_rng(seed + 1000 * dimension)
    found = steady(draw, dimension) if kind == "speed" else history(draw, dimension, kind)
    path = found.pop("path", [])
    roughness = {"method": "psd", "hurst": float(draw.uniform(0.2, 1.0)), "rms_gradient": GRADIENT}
    eps_c, eps_f = {1: (1 / 4, 1 / 64), 2: (1 / 2, 1 / 16)}[dimension]
    if path:  # which is hundreds of contacts
        eps_f *= 4 if dimension == 1 else 2
    return {
        "scene": {"dimension": dimension, "roughness": roughness, "interface": {"hard_wall": {}}} | found,
        "path": path,
        "discretisation": {"eps_c": eps_c, "eps_f": eps_f, "eps_t": 1 / 2},
        "numerics": {"time_tolerance": TOLERANCE} if path else {},
        "seed": seed,
    }


def hunt(kind: str, dimension: int, seeds: range) -> None:
    """Solve all seeds."""
    costs, failed, late = [], 0, 0
    for seed in seeds:
        found = gfmd_numba.solve(scene(kind, dimension, seed))
        costs.append(int(found["n_transforms"].sum()))
        late += kind != "speed" and float(found["time_error"][-1]) > TOLERANCE
        gains = float(found["hysteretic_friction"]) < -1e-12 if kind == "speed" else False
        if found["status"].any() or not float(found["residual"].max()) <= 1e-8 or gains:
            failed += 1
            print(f"seed {seed}: status {found['status'].values}, residual {float(found['residual'].max()):.1e}")
    shares = dict(zip((0, 50, 95, 100), np.percentile(costs, (0, 50, 95, 100)), strict=True))
    told = ", ".join(f"{share} %: {cost:.0f}" for share, cost in shares.items())
    print(f"{failed} of {len(seeds)} are not certified, {late} need shorter steps; transforms {told}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kind", choices=["speed", "friction", "adhesion", "both", "cohesion"])
    parser.add_argument("dimension", type=int, nargs="?", default=1, choices=[1, 2])
    parser.add_argument("number", type=int, nargs="?", default=200)
    parser.add_argument("first", type=int, nargs="?", default=0)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    hunt(given.kind, given.dimension, range(given.first, given.first + given.number))
