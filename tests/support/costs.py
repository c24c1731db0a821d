"""The seconds that problems take on an imagined machine, and what is predicted of them."""

import zlib

import numpy as np

from gfmd_numba.campaign import cost


def true_seconds(problem):
    surface = problem.surface
    work = (
        surface.nodes**1.05 * np.log2(surface.nodes) + 4e4
    )  # what is done once for each contact counts on small grids
    return 2e-8 * work * (1.0 + surface.generator.hurst) * problem.mean_pressure**0.3


def noise(problem, salt=0):
    """A factor of each problem's own, of a tenth."""
    key = f"{salt} {problem.surface} {problem.body} {problem.mean_pressure}"
    return np.exp(np.random.default_rng(zlib.crc32(key.encode())).normal(0.0, 0.1))


def predicted(planned, budget=100.0):
    return cost.predict(
        planned.problems, [planned.demand[p.identity] for p in planned.problems], budget, lambda problems: None
    )
