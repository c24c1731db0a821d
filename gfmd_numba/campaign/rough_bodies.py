"""Whether the slopes and the films of a campaign's rough bodies are within what two-step GFMD describes."""

from collections.abc import Sequence
from math import pi

from gfmd_numba.campaign.cases import Case
from gfmd_numba.contact.doubts import too_thin
from gfmd_numba.contact.problem import DeformableBody, RoughBodies
from gfmd_numba.contact.rough_surfaces import STEEPEST, rough_body
from gfmd_numba.contact.surfaces import SummedSurface


def doubt_of_bodies(cases: Sequence[Case]) -> str:
    """Return warnings about slopes above the thesis's limit and about films at order 0, one sentence a line."""
    if cases[0].problem.rough is None:
        return ""
    followed = dict.fromkeys((case.problem.surface, case.problem.rough) for case in cases)
    bodies = [(surface, rough) for surface, rough in followed if isinstance(surface, SummedSurface) and rough]
    return "\n".join(filter(None, (_of_slopes(bodies), _of_films(bodies))))


def _of_slopes(bodies: Sequence[tuple[SummedSurface, RoughBodies]]) -> str:
    own = ((surface, body.part) for surface, rough in bodies for body in rough.bodies)
    steepest = max((surface.parts[part].rms_gradient for surface, part in own if part is not None), default=0.0)
    if steepest <= STEEPEST:
        return ""
    return (
        f"a deformable surface has an rms gradient of up to {steepest:.3g}, above the {STEEPEST:g} of the thesis; "
        "`next_order` says what the next order in the slope would add to displacements, and the error is of that size"
    )


def _of_films(bodies: Sequence[tuple[SummedSurface, RoughBodies]]) -> str:
    """Warning about the film whose thickness changes most, by the first realisation of each surface."""
    films = []
    for surface, rough in bodies:
        if rough.order == 0 and any(_is_film(body) for body in rough.bodies):
            drawn = surface.drawn(0)
            films += [rough_body(body, drawn, rough.order) for body in rough.bodies]
    return too_thin(films)


def _is_film(body: DeformableBody) -> bool:
    """Whether it is a film to the longest waves."""
    thickness = body.elastic.top.aspect_ratio
    return thickness is not None and 2.0 * pi * thickness <= 1.0
