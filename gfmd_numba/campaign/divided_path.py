"""Loading paths walked in shorter steps."""

from itertools import pairwise

import numpy as np

from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import LoadStep


def divided(problem: Problem, number: int) -> tuple[LoadStep, ...]:
    """Return the path of a problem, each step of which is walked in so many equal ones."""
    return tuple(
        LoadStep(
            before.load + share * (after.load - before.load),
            tuple(old + share * (new - old) for old, new in zip(before.sliding, after.sliding, strict=True)),
            after.duration / number,
        )
        for before, after in pairwise((problem.step, *problem.path))
        for share in (np.arange(1, number + 1) / number).tolist()
    )
