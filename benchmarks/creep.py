"""Creep of a ball against Lee and Radok, and what its steps in time cost.

It presses a ball on a standard linear solid by a sudden load, which then stays (relaxed modulus 1, a branch of
modulus 3 and relaxation time 1). Its radius and approach are those of Hertz with E* = 1 / J(t).
"""

import argparse
import time
from itertools import pairwise

import numpy as np

import gfmd_numba

RADIUS, LAST = 4.0, 1.0 / 3.0  # of the ball, and of its contact at last, in windows


def compliance(elapsed: float) -> float:
    """Creep compliance of the solid."""
    return 1.0 - 0.75 * float(np.exp(-0.25 * elapsed))


def ball(nodes: list[int]) -> None:
    """Relative errors of the radius and the approach, at numbers of nodes along the last radius."""
    times = (0.0, 1.0, 4.0, 16.0)
    force = 4.0 * LAST**3 / (3.0 * RADIUS)
    print("| nodes a radius | time | radius | approach | reported error | solver, s |\n|---|---|---|---|---|---|")
    for count in nodes:
        begun = time.process_time()
        found = gfmd_numba.solve(
            {
                "dimension": 2,
                "periodic": False,
                "length": 1.0,
                "body": {"youngs_modulus": 0.75, "poissons_ratio": 0.5, "relaxation": [{"modulus": 2.25, "time": 1.0}]},
                "form": {"radius": RADIUS, "points": round(count / LAST)},
                "interface": {"hard_wall": {}},
                "loading": {"force": force},
                "path": [{"duration": end - start} for start, end in pairwise(times)],
            }
        )
        spent = time.process_time() - begun
        for i, elapsed in enumerate(times):
            radius = float(np.cbrt(3.0 * force * compliance(elapsed)))
            errors = float(found["contact_radius"][i]) / radius - 1.0, float(found["approach"][i]) * 4 / radius**2 - 1.0
            error = float(found["time_error"][i])
            print(f"| {count} | {elapsed:g} | {errors[0]:+.1e} | {errors[1]:+.1e} | {error:.1e} | {spent:.0f} |")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("nodes", type=int, nargs="*", default=[16, 32, 64, 128])
    ball(parser.parse_args().nodes)
