"""Whether the grids of a campaign resolve its interaction law."""

from collections.abc import Sequence

from gfmd_numba.campaign.axes import OF_THE_SCENE
from gfmd_numba.campaign.cases import Case
from gfmd_numba.campaign.file import Campaign
from gfmd_numba.campaign.grid import values_of
from gfmd_numba.contact import law_resolution
from gfmd_numba.scene import Document
from gfmd_numba.scene.document import Location


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
    """Raise InputError, at the value of the grid that is to blame, for a case that does not resolve its law at all."""
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
