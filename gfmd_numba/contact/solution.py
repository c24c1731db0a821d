"""One dimensionless contact problem from surface to equilibrium, for a block of realisations."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.surfaces import GivenSurface, SummedSurface
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.equilibrium import Equilibrium, equilibrate, following
from gfmd_numba.solvers.iteration import Start

_ROUNDING = 4.0 * float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Followed:
    """What a step of a path lost: energy per nominal area (g^2 E* L_x), and the load at its largest jump.

    The load is the displacement of the punch (g L_x) or the mean pressure (g E*), not-a-number without a jump.
    `least_pressure` is the smallest mean pressure of all solutions on the way (g E*), and `jump_sliding` the tangential
    displacement of the punch along x at the jump (g L_x).
    """

    lost: float
    jump_at: float
    least_pressure: float = np.nan
    jump_sliding: float = np.nan


NOTHING_LOST = Followed(0.0, np.nan)


@dataclass(frozen=True)
class Contact:
    """Heights `[realisation, (y,) x]` of the punch, peaks towards the body, and the equilibrium of the body under it.

    `punch` is the wall the displacement meets: the heights upside down, first touch (or the prescribed
    displacement below it) at zero. Where tractions are prescribed, `punch` and `equilibrium` count from the
    `deflected` surface (tangential, normal) that these have made, of their shapes, before the punch comes. `dented` is
    how far earlier steps of a path have flattened the punch, of its shape: the `punch` is flat there. `followed` tells
    of the step of a path that led here, None where steps are not divided. `stiffness` is that of the deformable bodies
    at any wave numbers (E*/L_x). `found` is what observables have found of it.
    """

    heights: Reals
    punch: Reals
    equilibrium: Equilibrium
    deflected: tuple[Reals, Reals] | None = None
    followed: Followed | None = None
    dented: Reals | float = 0.0
    stiffness: Callable[[Reals], Reals] = stiffness.half_space
    found: dict[object, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def flattened(self) -> Reals | float:
        """How far the punch is flattened in this step (g L_x): what plastic nodes penetrate."""
        if self.equilibrium.plastic is None:
            return 0.0
        return np.maximum(self.equilibrium.displacement - self.punch, 0.0)

    @property
    def plastic_depth(self) -> Reals | float:
        """How far the punch is flattened in all (g L_x), and stays when it is unloaded."""
        return self.dented + self.flattened


def solve(
    problem: Problem,
    realisations: range,
    before: Equilibrium | None = None,
    sliding: Sequence[float] | None = None,
    raised: Reals | float = 0.0,
    shifted: Reals | None = None,
    dented: Reals | float = 0.0,
    again: Equilibrium | None = None,
) -> Contact:
    """Press the realisations of a problem into contact, from the equilibrium `before` it if given (g L_x, g E*).

    `sliding` is the tangential displacement of the punch along x, on maps also along y, `raised` what the surface has
    moved towards it on its own, and `shifted` what its nodes have moved along it on their own since the equilibrium
    `before`, under a cohesive law since the punch came, of the shape of tangential quantities. `dented`
    `[realisation, (y,) x]` is how far the punch has been flattened. With `again`, the equilibrium under the same load
    of a surface that has hardly moved since, nodes are held where that held them, and `shifted` counts from there.
    """
    surface = problem.surface
    assert not isinstance(surface, SummedSurface)  # `two_step` draws it
    heights = surface.heights[np.newaxis] if isinstance(surface, GivenSurface) else surface.heights(realisations)
    response = _response(problem)
    punch = heights.max(axis=tuple(range(1, heights.ndim)), keepdims=True) - heights
    if problem.displacement is not None:
        punch -= problem.displacement
    punch += dented - raised
    if problem.rough is not None:  # what rounding leaves of heights that just touch is no contact
        punch[abs(punch) <= _ROUNDING * np.ptp(heights)] = 0.0
    deflected = None
    if problem.tractions is not None:  # the body is linear: what the tractions do to it, the punch meets undeformed
        share = 1.0 if problem.counter is None else 1.0 - problem.counter.share  # of E* in that of the body
        given = np.stack((*problem.tractions.tangential, problem.tractions.normal))
        moved = problem.body.response(given.shape[1:]).apply(share * given)
        deflected = moved[:-1], moved[-1]
        punch -= deflected[1]
    if problem.numerics.precision == "single":  # whatever the solver works on is of the precision of the punch
        punch = punch.astype(np.float32)
    ways = sliding or (0.0,) * (heights.ndim - 1)
    drag = np.reshape(ways, (-1, *(1 for _ in heights.shape[1:])))
    start = None if before is None else following(before, punch, drag)
    slid = drag
    if shifted is not None and problem.interface.cohesive is not None:
        slid = drag - shifted[0]
    elif shifted is not None and again is not None:
        start = continued(again, punch, shifted)
    elif shifted is not None:
        start = start or Start.at_rest(punch)
        start = replace(start, tangential=start.tangential - shifted, anchor=start.anchor - shifted)
    equilibrium = equilibrate(punch, response, problem.mean_pressure, problem.numerics, problem.interface, start, slid)
    if equilibrium.tangential is not None:
        equilibrium = replace(equilibrium, tangential=replace(equilibrium.tangential, sliding=drag))
    if equilibrium.plastic is not None:  # loaded again, a dent bears the hardness to within the residual
        assert problem.interface.hardness is not None
        law = problem.interface.normal_law
        wall = equilibrium.pressure if law is None else equilibrium.pressure + law.traction(np.zeros(1))
        bears = equilibrium.touching & (wall >= (1.0 - problem.numerics.residual) * problem.interface.hardness)
        equilibrium.plastic[:] |= bears & (np.asarray(dented) > 0.0)
    of_waves = partial(condensed_stiffness, problem)
    return Contact(heights, punch, equilibrium, deflected, dented=dented, stiffness=of_waves)


def continued(found: Equilibrium, punch: Reals, carried: Reals) -> Start:
    """Initial state for the same load again, once nodes were `carried` along the surface since the equilibrium found.

    A touching node slips from where it did there, an open one touches down where it is.
    """
    tangential = found.tangential
    assert tangential is not None
    touching = found.touching[:, np.newaxis]
    moved, displacement = tangential.displacement - carried, np.where(found.touching, punch, found.displacement)
    return Start(displacement, moved, np.where(touching, moved - tangential.slip, np.nan), -tangential.slip)


def _response(problem: Problem) -> SpectralResponse:
    """Of all that deforms: of the normal displacement alone, or of all."""
    shape, counter = problem.surface.shape, problem.counter
    if not problem.interface.couples:
        return SpectralResponse.of_normal(condensed_stiffness(problem, grid.magnitudes(shape)))
    own = problem.body.response(shape)
    return own if counter is None else own.in_series(counter.body.response(shape), counter.share)


def condensed_stiffness(problem: Problem, q: Reals) -> Reals:
    """Stiffness of the deformable bodies together at wave numbers q, where no tangential traction acts, in E*/L_x."""
    own = problem.body.condensed_stiffness(q)
    if problem.counter is None:
        return own
    other = problem.counter.body.condensed_stiffness(q)
    return stiffness.in_series(own, other, problem.counter.share)
