"""Fits without doubts about their laws, for campaigns that follow these, or whose other properties are looked at."""

import numpy as np

from gfmd_numba.analysis import limit_errors
from gfmd_numba.analysis.selection import LIMITS


def without_doubts(patch):
    """Trust the laws of fits beyond the finest level, and with all levels there are."""
    patch.setattr(
        limit_errors,
        "extrapolation_errors",
        lambda index, group, means, choice, *_: np.zeros((len(choice.nodes), len(LIMITS))),
    )
    patch.setattr(limit_errors, "rivals", lambda groups, given: [])
    patch.setattr(limit_errors, "without_coarsest", lambda groups: None)
