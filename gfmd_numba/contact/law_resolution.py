"""Whether a grid resolves an interaction law: how fast the law softens over how fast the shortest wave stiffens."""

from math import ceil

import numpy as np

from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import condensed_stiffness
from gfmd_numba.scene import Discretisation

COARSEST = 0.3  # up to it, pull-off of Johnson's adhesive wave is right to 1 %
_MOST_NODES = 2**50  # so that a number of nodes is exact


def resolution(problem: Problem) -> float:
    """Ratio x of the largest softening of the law to the stiffness of the shortest wave; 0 without attraction.

    It is (w / range^2) / (pi n E* / 2 L_x) for an exponential law on a half-space of n nodes. Where the law softens
    faster than the shortest wave stiffens, single nodes snap, and the edge of a contact is held by the grid.
    """
    return _on(problem, problem.surface.nx)


def doubt(problem: Problem, discretisation: Discretisation | None) -> str:
    """What is to be said of a law that the grid does not resolve, and the grid that would; nothing of any other."""
    x = resolution(problem)
    if x <= COARSEST:
        return ""
    needed = _needed(problem)
    if discretisation is None:
        remedy = f"at least {needed} points"
    else:
        waves = 2 * discretisation.cut_off_index
        finer = ceil(needed / waves)
        remedy = f"eps_c = 1/{finer} (nx = {finer * waves})"
    return (
        f"the grid does not resolve the interaction law: it softens {x:.3g} times as fast as the shortest wave "
        f"stiffens. Pull-off is right to 1 % at up to {COARSEST:g} times, over 20 % too large at 0.9 and 80 % at 1.9. "
        f"Take {remedy}, or a longer range"
    )


def _on(problem: Problem, nodes: int) -> float:
    shortest = np.array([2.0 * np.pi * (nodes // 2)])
    return problem.interface.softening / float(condensed_stiffness(problem, shortest)[0])


def _needed(problem: Problem) -> int:
    """Number of nodes that resolves the law."""
    nodes = problem.surface.nx
    while nodes < _MOST_NODES and (x := _on(problem, nodes)) > COARSEST:
        nodes = max(nodes + 1, ceil(min(nodes * x / COARSEST, _MOST_NODES)))
    return nodes
