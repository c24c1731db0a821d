"""Loading paths walked in shorter steps."""

from itertools import pairwise

import numpy as np

from gfmd_numba.contact.problem import LoadStep, Problem


def divided(problem: Problem, number: int) -> tuple[LoadStep, ...]:
    """Return the path of a problem, each step of which is walked in so many equal ones."""
    steps = [LoadStep(problem.load, (0.0,) * len(problem.surface.shape)), *problem.path]
    return tuple(
        LoadStep(
            before.load + share * (after.load - before.load),
            tuple(old + share * (new - old) for old, new in zip(before.sliding, after.sliding, strict=True)),
        )
        for before, after in pairwise(steps)
        for share in (np.arange(1, number + 1) / number).tolist()
    )
