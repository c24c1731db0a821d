"""Random rough punches that slide steadily over random viscoelastic bodies: which are not solved, and what they cost.

python benchmarks/sliding_hunt.py [dimension] [number]; a line for each that is not certified, and the percentiles of
the transforms that all took.
"""

import argparse
import warnings

import numpy as np

import gfmd_numba


def scene(dimension: int, seed: int) -> dict:
    """One to four branches over four decades of time, a slab in some, a displacement of the punch in a few."""
    draw = np.random.default_rng(seed + 1000 * dimension)
    branches = [
        {"modulus": float(10.0 ** draw.uniform(-0.5, 2.0)), "time": float(10.0 ** draw.uniform(-4.0, 0.0))}
        for _ in range(draw.integers(1, 5))
    ]
    body = {"poissons_ratio": float(draw.uniform(0.0, 0.5)), "relaxation": branches}
    if draw.random() < 0.3:
        body["aspect_ratio"] = float(10.0 ** draw.uniform(-1.5, 0.0))
    loading = {"reduced_pressure": float(10.0 ** draw.uniform(-2.5, 0.3))}
    if "aspect_ratio" in body and draw.random() < 0.5 and body["poissons_ratio"] < 0.49:
        loading = {"displacement": float(10.0 ** draw.uniform(-4.0, -2.5))}
    loading["speed"] = float(10.0 ** draw.uniform(-5.0, 1.0))
    roughness = {"method": "psd", "hurst": float(draw.uniform(0.2, 1.0)), "rms_gradient": 0.01}
    eps_c, eps_f = {1: (1 / 4, 1 / 64), 2: (1 / 2, 1 / 16)}[dimension]
    return {
        "scene": {
            "dimension": dimension,
            "body": body,
            "roughness": roughness,
            "interface": {"hard_wall": {}},
            "loading": loading,
        },
        "discretisation": {"eps_c": eps_c, "eps_f": eps_f, "eps_t": 1 / 2},
        "seed": seed,
    }


def hunt(dimension: int, number: int) -> None:
    """Solve so many."""
    costs, failed = [], 0
    for seed in range(number):
        found = gfmd_numba.solve(scene(dimension, seed))
        costs.append(int(found["n_transforms"]))
        if int(found["status"]) or not float(found["residual"]) <= 1e-8 or float(found["hysteretic_friction"]) < -1e-12:
            failed += 1
            print(f"seed {seed}: status {int(found['status'])}, residual {float(found['residual']):.1e}")
    shares = dict(zip((0, 50, 95, 100), np.percentile(costs, (0, 50, 95, 100)), strict=True))
    told = ", ".join(f"{share} %: {cost:.0f}" for share, cost in shares.items())
    print(f"{failed} of {number} are not certified; transforms {told}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dimension", type=int, nargs="?", default=1, choices=[1, 2])
    parser.add_argument("number", type=int, nargs="?", default=200)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    hunt(given.dimension, given.number)
