"""Measures of an ensemble of surfaces in this process, for pilots and studies."""

import numpy as np

from gfmd_numba.campaign.cases import blocks
from gfmd_numba.campaign.collection import Measures
from gfmd_numba.contact import path_measures
from gfmd_numba.contact.problem import Problem


def measured(problem: Problem, realisations: int) -> Measures:
    """Measures [realisation], solved in blocks as a run does it: their memory is bounded."""
    parts = [path_measures.measured(problem, range(block.first, block.stop)) for block in blocks(problem, realisations)]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
