"""Whether a grid resolves an interaction law: how fast the law softens over how fast the shortest wave stiffens."""

from collections.abc import Callable
from math import ceil, sqrt

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import condensed_stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.scene import Discretisation, Document, Interface
from gfmd_numba.scene.document import Location
from gfmd_numba.scene.units import in_unit_of

NAME = "relative_softening"
LONG_NAME = "largest softening of the interaction law over the stiffness of the shortest wave of the grid"
COARSEST = 0.2  # up to it, pull-off of Johnson's adhesive wave, or a paraboloid, is right to 1 % in however short steps
_TOO_LARGE = {1: 25, 2: 8}  # percent of the pull-off of either at 0.9, by the dimension
_DRAG_TOO_LARGE = 15  # percent of the largest traction that drags a wave, at 0.9
REFUSED = 1.0  # above it every wave of the grid may snap, the shortest too: each node is in or out on its own
_REACH = {1: 2**24, 2: 2**14}  # points in each direction, by the dimension: beyond them nobody solves a contact
POINTS = {1: "points", 2: "points both ways"}  # of a grid, by the dimension
_MOST_NODES = 2**50  # so that a number of nodes is exact


def softening(problem: Problem) -> float:
    """Ratio x of the largest softening of the law to the stiffness of the shortest wave; 0 without attraction.

    It is (w / range^2) / (pi n E* / (2 L_x)) for an exponential law on a half-space of n nodes; of a map the
    shortest wave along an axis counts. A law of gap and slip has two, and the larger counts. Where the law softens
    faster than that stiffens, single nodes snap, and the edge of a contact is held by the grid.
    """
    return max(_on(problem, problem.surface.nx))


def warning(problem: Problem, discretisation: Discretisation | None) -> str:
    """Return a warning about a law that the grid does not resolve, with a grid that would; else nothing."""
    x = softening(problem)
    if x <= COARSEST:
        return ""
    dimension = len(problem.surface.shape)
    softens, what, percent = "it softens", "Pull-off", f"over {_TOO_LARGE[dimension]}"
    if _slips(problem):
        softens, what, percent = "under slip it softens", "The largest drag", f"about {_DRAG_TOO_LARGE}"
    return (
        f"the grid does not resolve the interaction law: {softens} {x:.3g} times as fast as the shortest wave "
        f"stiffens. {what} is right to 1 % at up to {COARSEST:g} times, and {percent} % too large "
        f"at 0.9. {_finer(problem, discretisation)}"
    )


def check_resolved(
    document: Document,
    asked: Interface,
    problem: Problem,
    discretisation: Discretisation | None,
    locate: Callable[[Location], Location] = lambda location: location,
) -> None:
    """Raise InputError for a law that softens faster than the shortest wave of the grid stiffens.

    `asked` is what acts in the scene, and `locate` tells where one of its values stands in the file.
    """
    x = softening(problem)
    if x <= REFUSED:
        return
    name, law = next((name, law) for name, law in asked.laws.items() if law.across_open_gap)
    lengths = [key for key in type(law).model_fields if key != "work_of_adhesion"]  # of the gap, and of slip if any
    key = lengths[_slips(problem)]
    at = locate(("scene", "interface", name, key))
    given = getattr(law, key)
    shortest = in_unit_of(given, float(f"{given * sqrt(x / REFUSED):.3g}"))
    raise document.refused(
        at,
        f"at least {shortest} on this grid, whose shortest wave stiffens {1 / x:.3g} times as fast as the law "
        f"softens: each node would snap into contact on its own. {_finer(problem, discretisation)}",
    )


def _finer(problem: Problem, discretisation: Discretisation | None) -> str:
    """Which grid resolves the law of a problem, or that none within reach does."""
    needed, dimension = _needed(problem), len(problem.surface.shape)
    most, points = _REACH[dimension], POINTS[dimension]
    length = "range" if problem.interface.cohesive is None else ("normal_length", "tangential_length")[_slips(problem)]
    if needed > most:
        return f"No grid of up to {most} {points} resolves the law: take a longer {length} or less work"
    if discretisation is None:
        return f"Take at least {needed} {points}, or a longer {length}"
    waves = 2 * discretisation.shortest_wave_index
    finer = ceil(needed / waves)
    return f"Take eps_c = 1/{finer} (nx = {finer * waves}), or a longer {length}"


def _slips(problem: Problem) -> bool:
    """Whether slip softens the law more than the gap does."""
    gap, slip = _on(problem, problem.surface.nx)
    return slip > gap


def _on(problem: Problem, nodes: int) -> tuple[float, float]:
    """Softening by the gap and by slip, each over the stiffness of the shortest wave where the other is free."""
    shortest, laws = np.array([0.0, 2.0 * np.pi * (nodes // 2)]), problem.interface
    gap = laws.softening / float(condensed_stiffness(problem, shortest[1:])[0])
    if not laws.slip_softening > 0.0:
        return gap, 0.0
    compliances, counter = _slip_compliances(problem.body, shortest), problem.counter
    if counter is not None:
        compliances = (
            1.0 - counter.compliance_fraction
        ) * compliances + counter.compliance_fraction * _slip_compliances(counter.elastic, shortest)
    ways = len(problem.surface.shape)  # of a map a wave may also slip across its own direction, where bodies are softer
    return gap, laws.slip_softening * float(compliances[:ways].max())


def _slip_compliances(body: ElasticBody, shortest: Reals) -> Reals:
    """Compliances of a body to slip along the shortest wave and across it, with waves [0, q]."""
    return np.array([body.compliance(shortest).s11[1], body.compliance_across(shortest[1:])[0]])


def _needed(problem: Problem) -> int:
    """Number of nodes that resolves the law."""
    nodes = problem.surface.nx
    while nodes < _MOST_NODES and (x := max(_on(problem, nodes))) > COARSEST:
        nodes = max(nodes + 1, ceil(min(nodes * x / COARSEST, _MOST_NODES)))
    return nodes
