"""One dimensionless contact problem from surface to equilibrium, for a block of realisations."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gfmd_numba import grid
from gfmd_numba.dynamics import Equilibrium, equilibrate
from gfmd_numba.elasticity import stiffness
from gfmd_numba.problem import Problem, Profile
from gfmd_numba.roughness import self_affine

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Contact:
    """Heights `[realisation, x]` of the punch, peaks towards the body, and the equilibrium of the body under it.

    `punch` is the wall the displacement meets: the heights upside down, first touch (or the prescribed
    displacement below it) at zero.
    """

    heights: Reals
    punch: Reals
    stiffness: Reals
    equilibrium: Equilibrium


def solve(problem: Problem, realisations: range, before: Equilibrium | None = None) -> Contact:
    """Press the realisations of a problem into contact, from the equilibrium `before` it if given (g L_x, g E*)."""
    heights = _heights(problem, realisations)
    body = _stiffness(problem)
    punch = heights.max(axis=1, keepdims=True) - heights
    if problem.displacement is not None:
        punch -= problem.displacement
    # what touched the punch follows it: a gap torn open by the step itself would break an adhesive contact early
    start = None if before is None else np.where(before.touching, punch, before.displacement)
    return Contact(
        heights,
        punch,
        body,
        equilibrate(punch, body, problem.mean_pressure, problem.numerics, problem.interface, start),
    )


def _heights(problem: Problem, realisations: range) -> Reals:
    surface = problem.surface
    if isinstance(surface, Profile):
        return surface.heights[np.newaxis]
    return self_affine.profiles(
        surface.hurst, surface.cut_on_index, surface.cut_off_index, surface.nx, surface.seed, realisations
    )


def _stiffness(problem: Problem) -> Reals:
    q = grid.wavenumbers(problem.surface.nx)
    if problem.slab is None:
        return stiffness.half_space(q)
    return stiffness.slab(q, problem.slab.poissons_ratio, problem.slab.aspect_ratio)
