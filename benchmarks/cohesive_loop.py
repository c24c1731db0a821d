"""Energy lost by a wave under a cohesive law that is pressed and drawn off, or dragged to and fro, against the step.

`python benchmarks/cohesive_loop.py` takes about a minute. Where no step loses a jump, the loss does not depend on it.
"""

import warnings

import numpy as np

import gfmd_numba

NODES = 256
LAW = {"work_of_adhesion": 6e-3, "normal_length": 5e-3, "tangential_length": 9e-3}  # x = 0.17 by slip


def loop(positions, key):
    """Results along a path of displacements, or of positions along the surface, of the punch."""
    x = np.arange(NODES) / NODES
    scene = {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1},
        "roughness": {"method": "measured", "heights": 0.1 * np.cos(2 * np.pi * x)},
        "interface": {"hard_wall": {}, "cohesive": LAW},
        "loading": {"displacement": positions[0] if key == "displacement" else 0.02},
    }
    with warnings.catch_warnings(action="ignore"):
        return gfmd_numba.solve({"scene": scene, "path": [{key: float(position)} for position in positions[1:]]})


def ways(step):
    """Both loops in steps of that length; the first begins and ends apart, so that its area is what is lost."""
    there = np.linspace(-0.06, 0.02, round(0.08 / step) + 1)
    yield "displacement", np.concatenate([there, np.arange(0.02 - step, -0.09, -step)])
    positions = [np.arange(0.0, 0.25, step), np.arange(0.25 - step, -0.05, -step)]
    yield "sliding", np.concatenate(positions)


if __name__ == "__main__":
    print("loop of       step     energy lost  area of loop  jumps  transforms a step (median, all)  ok")
    for step in (2e-2, 1e-2, 5e-3, 2.5e-3, 1e-3):
        for key, positions in ways(step):
            found = loop(positions, key)
            lost, jumps = float(found["energy_lost"].sum()), int(found[f"jump_{key}"].notnull().sum())
            area = f"{np.trapezoid(found['mean_pressure'], positions):.6f}" if key == "displacement" else ""
            spent, ok = found["n_transforms"].values, bool((found["status"] == 0).all())
            print(
                f"{key:13} {step:<8g} {lost:.6f}     {area:13} {jumps:<6} {np.median(spent):.0f}, {spent.sum()}  {ok}"
            )
