"""Reasons to doubt a campaign before it runs: steep or thin bodies, coarse grids, limits that no fit can find."""

from collections.abc import Sequence
from math import pi

import numpy as np

from gfmd_numba.campaign.axes import OF_THE_SCENE
from gfmd_numba.campaign.cases import Case
from gfmd_numba.campaign.coordinates import described_coordinates
from gfmd_numba.campaign.file import Campaign
from gfmd_numba.campaign.grid import values_of
from gfmd_numba.contact import law_resolution
from gfmd_numba.contact.doubts import too_thin
from gfmd_numba.contact.problem import DeformableBody, RoughBodies
from gfmd_numba.contact.rough_surfaces import STEEPEST, rough_body
from gfmd_numba.contact.surfaces import SummedSurface
from gfmd_numba.scene import Document
from gfmd_numba.scene.document import Location


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
        f"a deformable surface has an rms gradient of up to {steepest:.3g}, above {STEEPEST:g}: "
        "`next_order` says what the next order in the slope would add to displacements, and the error is of that size"
    )


def _of_films(bodies: Sequence[tuple[SummedSurface, RoughBodies]]) -> str:
    """Return a warning about the film whose thickness changes most, by the first realisation of each surface."""
    films = []
    for surface, rough in bodies:
        if rough.order == 0 and any(_is_film(body) for body in rough.bodies):
            drawn = surface.drawn(0)
            films += [rough_body(body, drawn, rough.order) for body in rough.bodies]
    return too_thin(films)


def _is_film(body: DeformableBody) -> bool:
    """Return whether the body is thin compared with the longest waves."""
    thickness = body.elastic.top.aspect_ratio
    return thickness is not None and 2.0 * pi * thickness <= 1.0


def unresolved(cases: Sequence[Case]) -> str:
    """Return a warning about interaction laws that the grids do not resolve, with the worst case; else nothing."""
    if not cases[0].scene.interface.reaches_across:
        return ""
    doubtful = [case for case in cases if law_resolution.resolution(case.problem) > law_resolution.COARSEST]
    if not doubtful:
        return ""
    worst = _worst(doubtful)
    return f"in {len(doubtful)} of {len(cases)} cases {law_resolution.doubt(worst.problem, worst.discretisation)}"


def is_resolved(cases: Sequence[Case]) -> bool:
    """Whether the grid of every case resolves its law, or there is none."""
    return all(law_resolution.resolution(case.problem) <= law_resolution.REFUSED for case in cases)


def check_resolved(document: Document, campaign: Campaign, cases: Sequence[Case]) -> None:
    """Raise InputError, at the value of the grid that causes it, for a case that does not resolve its law at all."""
    if not campaign.scene.interface.reaches_across:
        return
    worst = _worst(cases)

    def locate(location: Location) -> Location:
        for axis in OF_THE_SCENE:
            if ("scene", *axis.place) == location and (values := values_of(campaign.grid, axis.name)):
                return ("grid", axis.name, values.index(axis.value(worst.scene, worst.discretisation)))
        return location

    law_resolution.check_resolved(document, worst.scene.interface, worst.problem, worst.discretisation, locate)


def _worst(cases: Sequence[Case]) -> Case:
    return max(cases, key=lambda case: law_resolution.resolution(case.problem))


def refused_limits(campaign: Campaign, cases: Sequence[Case]) -> list[str]:
    """Return a sentence for each reason why the fit will refuse the limit; none for a campaign without limits."""
    import xarray as xr

    from gfmd_numba.analysis.tfc import refusals

    if all(case.limit == "reference" for case in cases):
        return []
    coordinates, ones = described_coordinates(cases[0].scene, list(cases)), np.ones((len(cases), 1))
    found = []
    for fit, _ in campaign.fits():
        described = xr.Dataset({fit.variable: (("case", "realisation"), ones)}, coordinates)
        for reason, count in refusals(described, fit.variable, fit.exponents, fit.options["fixed"]).items():
            groups = f"{count} group{'s' * (count > 1)} of cases"
            found.append(f"a run will print no limit of {fit.variable} ({groups}): {'; '.join(reason.splitlines())}")
    return found
