"""One dimensionless contact problem from surface to equilibrium, for a block of realisations."""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.problem import ElasticBody, Problem, Profile
from gfmd_numba.elasticity import stiffness, surface
from gfmd_numba.elasticity.surface import CoupledStiffness
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import Equilibrium, Start, equilibrate


@dataclass(frozen=True)
class Contact:
    """Heights `[realisation, (y,) x]` of the punch, peaks towards the body, and the equilibrium of the body under it.

    `punch` is the wall the displacement meets: the heights upside down, first touch (or the prescribed
    displacement below it) at zero. Where tractions are prescribed, `punch` and `equilibrium` count from the
    `deflected` surface (tangential, normal) `[x]` that these have made before the punch comes.
    """

    heights: Reals
    punch: Reals
    equilibrium: Equilibrium
    deflected: tuple[Reals, Reals] | None = None


def solve(
    problem: Problem,
    realisations: range,
    before: Equilibrium | None = None,
    sliding: float = 0.0,
    raised: Reals | float = 0.0,
) -> Contact:
    """Press the realisations of a problem into contact, from the equilibrium `before` it if given (g L_x, g E*).

    `sliding` is the tangential displacement of the punch, `raised` what the surface has moved towards it on its own.
    """
    heights = _heights(problem, realisations)
    body = _stiffness(problem)
    punch = heights.max(axis=tuple(range(1, heights.ndim)), keepdims=True) - heights
    if problem.displacement is not None:
        punch -= problem.displacement
    punch -= raised
    deflected = None
    if problem.tractions is not None:  # the body is linear: what the tractions do to it, the punch meets undeformed
        deflected = _coupled(problem).deflection(problem.tractions.tangential, problem.tractions.normal)
        punch -= deflected[1]
    if problem.numerics.precision == "single":  # whatever the solver works on is of the precision of the punch
        punch = punch.astype(np.float32)
    start = None if before is None else Start.after(before, punch, sliding)
    equilibrium = equilibrate(punch, body, problem.mean_pressure, problem.numerics, problem.interface, start, sliding)
    return Contact(heights, punch, equilibrium, deflected)


def _heights(problem: Problem, realisations: range) -> Reals:
    asked = problem.surface
    if isinstance(asked, Profile):
        return asked.heights[np.newaxis]
    waves = asked.hurst, asked.cut_on_index, asked.cut_off_index, asked.nx, asked.seed, realisations
    return self_affine.profiles(*waves) if asked.dimension == 1 else self_affine.maps(*waves, asked.anisotropy)


def _stiffness(problem: Problem) -> Reals | CoupledStiffness:
    if problem.interface.couples:
        return _coupled(problem)
    return condensed_stiffness(problem, grid.magnitudes(problem.surface.shape))


def condensed_stiffness(problem: Problem, q: Reals) -> Reals:
    """Stiffness of the deformable bodies together at wave numbers q, where no tangential traction acts, in E*/L_x."""
    own = _condensed(problem.body, q)
    if problem.counter is None:
        return own
    # under one pressure displacements add up, wave by wave
    share, other = problem.counter.share, _condensed(problem.counter.body, q)
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / ((1.0 - share) / own + share / other))


def _condensed(body: ElasticBody, q: Reals) -> Reals:
    if body.poissons_ratio is None or body.aspect_ratio is None:
        return stiffness.half_space(q)
    return stiffness.slab(q, body.poissons_ratio, body.aspect_ratio)


def _coupled(problem: Problem) -> CoupledStiffness:
    nx, nu, aspect_ratio = problem.surface.nx, problem.body.poissons_ratio, problem.body.aspect_ratio
    assert nu is not None  # reduce's promise
    return surface.half_space(nx, nu) if aspect_ratio is None else surface.slab(nx, nu, aspect_ratio)
