"""Friction of rough bodies at orders 1 to 3 in their slope, on random paths: whether every step comes to rest.

`python benchmarks/rough_friction_hunt.py KIND DIMENSION [FIRST [PATHS [FACING]]]` follows random paths of three to five
steps, on 256 nodes or 64 x 64: rms gradients from 0.003 to 0.1, Poisson's ratios from -0.5 to 1/2, slabs and
half-spaces. KIND is `friction`, `sticking`, `attraction`, `repulsion`, `cohesion`, `verlet` or `sticking_verlet`.
FACING is what the rough body meets: a `level` punch, a rough `punch`, or a `body`.
"""

import sys
import warnings

import numpy as np

import gfmd_numba

EPS = {1: {"eps_c": 1 / 4, "eps_f": 1 / 32, "eps_t": 1 / 2}, 2: {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2}}


def path_of(rng, kind, dimension, facing):
    """Scene file of a random path."""
    g, load = float(10 ** rng.uniform(-2.5, -1.0)), rng.uniform(0.005, 0.3, 3)
    body = {
        "poissons_ratio": float(rng.uniform(-0.5, 0.5)) if rng.random() < 0.8 else 0.5,
        "roughness": {"method": "psd", "hurst": float(rng.uniform(0.3, 1.0)), "rms_gradient": g},
    }
    friction = np.inf if "sticking" in kind else float(10 ** rng.uniform(-1.5, 0.2))
    interface = {"hard_wall": {}, "friction": {"coefficient": friction}}
    if kind in ("attraction", "repulsion"):
        work = float(g * g * 10 ** rng.uniform(-3.0, -1.5)) * (1.0 if kind == "attraction" else -1.0)
        interface["exponential"] = {"work_of_adhesion": work, "range": float(g * 10 ** rng.uniform(-1.5, -0.5))}
    path = [{"reduced_pressure": float(load[1])}, {"reduced_pressure": float(load[2])}]
    if rng.random() < 0.7:
        body["aspect_ratio"] = float(rng.uniform(0.1, 1.5))
        names = ("sliding", "sliding_y")[:dimension]
        path[1:1] = [{name: float(0.02 * g * rng.normal()) for name in names} for _ in range(2)]
    if kind == "cohesion":
        work, lengths = float(g * g * 10 ** rng.uniform(-3.0, -1.5)), g * 10 ** rng.uniform(-1.0, -0.3, 2)
        law = {"work_of_adhesion": work, "normal_length": float(lengths[0]), "tangential_length": float(lengths[1])}
        interface = {"hard_wall": {}, "cohesive": law}
    numerics = {"topography_order": int(rng.integers(1, 4))} | ({"solver": "verlet"} if "verlet" in kind else {})
    rough = {
        "method": "psd",
        "hurst": float(rng.uniform(0.3, 1.0)),
        "rms_gradient": g * float(10 ** rng.uniform(-1, 0)),
    }
    above = {"roughness": rough} if facing == "punch" else {}
    if facing == "body":
        body["youngs_modulus"] = 1.0
        other = {"youngs_modulus": float(10 ** rng.uniform(-1, 1)), "poissons_ratio": float(rng.uniform(-0.5, 0.5))}
        if "aspect_ratio" in body:
            other["aspect_ratio"] = float(rng.uniform(0.1, 1.5))
        above = {"counter_body": other | {"roughness": rough}}
    return {
        "scene": {
            "dimension": dimension,
            "body": body,
            "interface": interface,
            "loading": {"reduced_pressure": float(load[0])},
        }
        | above,
        "path": path,
        "numerics": numerics,
        "seed": int(rng.integers(10**6)),
        "discretisation": EPS[dimension],
    }


def main(kind, dimension, first=0, paths=30, facing="level"):
    """Print how many paths end before their last step, and the transforms of a step."""
    failed, steps, transforms = [], 0, []
    for seed in range(int(first), int(first) + int(paths)):
        file = path_of(np.random.default_rng(seed), kind, int(dimension), facing)
        try:
            found = gfmd_numba.solve(file)
        except gfmd_numba.InputError as refused:  # of a law that the grid does not resolve
            print(seed, refused)
            continue
        steps += found.sizes["step"]
        transforms += list(found["n_transforms"].values)
        if found.sizes["step"] <= len(file["path"]) or (found["status"] != 0).any():
            failed.append(seed)
    middle = [int(each) for each in np.quantile(transforms, [0.25, 0.5, 0.75])]
    print(f"{kind}, dimension {dimension}, {facing}: {steps} steps, failed {failed}, quartiles of transforms {middle}")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main(*sys.argv[1:])
