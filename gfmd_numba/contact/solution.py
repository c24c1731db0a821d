"""One dimensionless contact problem from surface to equilibrium, for a block of realisations.

A step prescribes the mean pressure, or the displacement of the punch beyond first touch. Under a pressure the mean
displacement of a periodic body is arbitrary, K(0) = 0: the solver finds the level of the wall from the gap, which is 0
on average over the nodes in contact. In a window the level of the wall has a meaning, the approach.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact import free_window
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.processes import bear_again, processes_of
from gfmd_numba.contact.state import Contact, State
from gfmd_numba.elasticity import free_body, stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.roughness.surfaces import GivenSurface, SummedSurface
from gfmd_numba.solvers.equilibrium import Equilibrium, equilibrate, following
from gfmd_numba.solvers.iteration import Start
from gfmd_numba.solvers.status import Status, withdrawn

_ROUNDING = 4.0 * float(np.finfo(np.float64).eps)


def begin(problem: Problem, realisations: range) -> State:
    """State of realisations of a problem before the first step; `two_step` has that of rough bodies."""
    surface, processes = problem.surface, processes_of(problem)
    if isinstance(surface, SummedSurface):
        heights = np.stack([np.sum(surface.drawn(each), axis=0) for each in realisations]) / surface.rms_gradient
        return State.untouched(
            heights, processes, form=surface.form, passing=problem.passing, moved=_moved(problem, surface)
        )
    heights = surface.heights[np.newaxis] if isinstance(surface, GivenSurface) else surface.heights(realisations)
    return State.untouched(heights, processes, passing=problem.passing)


def _moved(problem: Problem, surface: SummedSurface) -> Callable[[tuple[float, ...]], Reals] | None:
    """Heights `[(y,) x]` of a form alone after a way, None of a rough punch, which is moved as the waves it is."""
    smooth = surface.alone
    if smooth is None:
        return None
    scale, ends = surface.parts[0].gradient / surface.rms_gradient, problem.ends
    return lambda way: scale * smooth.moved(way, ends)


def solve(problem: Problem, state: State | range) -> Contact:
    """Press the surfaces of a problem into contact, from the state that the last step has left (g L_x, g E*).

    A range stands for the realisations of that number, before the first step.
    """
    state = begin(problem, state) if isinstance(state, range) else state
    step = problem.step
    change, heights = state.change(step), state.facing(state.heights, step)
    punch = state.heights.max(axis=tuple(range(1, heights.ndim)), keepdims=True) - heights
    if problem.displacement is not None:
        punch -= problem.displacement
    if change.wall is not None:
        punch += change.wall
    if problem.rough is not None:  # what rounding leaves of heights that just touch is no contact
        punch[abs(punch) <= _ROUNDING * np.ptp(heights)] = 0.0
    if change.normal_offset is not None:
        punch -= change.normal_offset
    drag = np.reshape(step.sliding, (-1, *(1 for _ in heights.shape[1:])))
    laws = problem.interface.lasting(step.duration)
    is_cohesive = laws.cohesive is not None  # slip then counts from where the punch came
    slid = drag - change.anchor_shift[0] if is_cohesive and change.anchor_shift is not None else drag
    start = _start(state, None if is_cohesive else change.anchor_shift, punch, drag)
    load = None if problem.mean_pressure is None else problem.mean_pressure + change.lifted
    approach = None
    if not any(problem.ends):
        response = change.applied_to(response_of(problem))
        equilibrium = equilibrate(punch, response, load, problem.numerics, laws, start, slid)
    else:
        equilibrium, sunk = _without_period(problem, state, punch, load, start, slid)
        punch, approach = punch - sunk, sunk + (problem.displacement or 0.0)
    if equilibrium.tangential is not None:
        equilibrium = replace(equilibrium, tangential=replace(equilibrium.tangential, sliding=drag))
    if equilibrium.plastic is not None:
        equilibrium.plastic[:] |= bear_again(problem, state, equilibrium.touching, equilibrium.pressure)
    stiffness_of_waves = partial(condensed_stiffness, problem)
    if change.wear_compliance > 0.0:  # the wall, and not the body
        yielded = change.wear_compliance * equilibrium.pressure
        equilibrium, punch = replace(equilibrium, displacement=equilibrium.displacement + yielded), punch + yielded
    law = problem.interface.normal_law
    at_contact = 0.0 if law is None else law.traction(np.zeros(problem.surface.shape))
    found = Contact(heights, punch, equilibrium, state, step, change, stiffness=stiffness_of_waves, approach=approach)
    found = replace(found, law_traction_at_contact=at_contact, fields_in_period=problem.fields_in_period)
    return found if problem.periodic is True else replace(found, ends=problem.ends)


def _without_period(
    problem: Problem, state: State, punch: Reals, load: float | None, start: Start | None, slid: Reals
) -> tuple[Equilibrium, Reals]:
    """Equilibrium in the window of a punch, and how far the punch has sunk in beyond where it is (g L_x)."""
    laws, change = problem.interface.lasting(problem.duration), state.change(problem.step)
    response = change.applied_to(response_of(problem))
    if start is not None and state.last is not None and state.last.approach is not None:
        sunk = 0.0 if load is None else state.last.approach
        start = free_window.start(start, state.last.equilibrium, sunk, response, problem.ends)
    shared = None if load is None else free_window.area_fraction(problem.ends) * load
    for farther in free_window.FARTHER:
        around = free_window.around(punch, load, laws, change.factor, farther)
        found = equilibrate(punch, response, shared, problem.numerics, laws, start, slid, around)
        touching = np.asarray(found.touching_around)  # known, as the punch fills a corner
        if not touching.any():
            break
    found = replace(found, status=withdrawn(found.status, touching, Status.no_equilibrium))
    if load is None:
        return found, np.zeros((len(punch), *(1 for _ in punch.shape[1:])))
    sunk = free_window.sunk_in(found, response, problem.ends)
    return replace(found, displacement=found.displacement - sunk), sunk


def _start(state: State, carried: Reals | None, punch: Reals, drag: Reals) -> Start | None:
    """What the solver begins with, None for bodies at rest; friction follows nodes that were `carried` along."""
    before = None if state.last is None else state.last.equilibrium
    if before is not None and carried is not None and state.repeats:
        return continued(before, punch, carried)
    start = None if before is None else following(before, punch, drag)
    if carried is None:
        return start
    start = start or Start.at_rest(punch)
    return replace(start, tangential=start.tangential - carried)


def continued(found: Equilibrium, punch: Reals, carried: Reals) -> Start:
    """Initial state for the same load again, once nodes were `carried` along the surface since the equilibrium found.

    A touching node keeps its anchor, and an open one touches down where it is.
    """
    tangential = found.tangential
    assert tangential is not None
    moved, displacement = tangential.displacement - carried, np.where(found.touching, punch, found.displacement)
    return Start(displacement, moved, -tangential.slip)


def response_of(problem: Problem) -> SpectralResponse:
    """Response of the deformable bodies together, of the normal displacement alone, or of all.

    That of a window is on its padded grid.
    """
    shape, ends, couples, counter = problem.surface.shape, problem.ends, problem.interface.couples, problem.counter
    if not couples and not any(ends):
        return SpectralResponse.of_normal(condensed_stiffness(problem, grid.magnitudes(shape)))
    own, *other = (
        free_body.response(shape, body, ends, couples) if any(ends) else body.response(shape)
        for body in (problem.body, *(() if counter is None else (counter.elastic,)))
    )
    return own if counter is None else own.in_series(other[0], counter.compliance_fraction)


def condensed_stiffness(problem: Problem, q: Reals) -> Reals:
    """Stiffness of the deformable bodies together at wave numbers q, where no tangential traction acts, in E*/L_x."""
    own = problem.body.condensed_stiffness(q)
    if problem.counter is None:
        return own
    other = problem.counter.elastic.condensed_stiffness(q)
    return stiffness.in_series(own, other, problem.counter.compliance_fraction)
