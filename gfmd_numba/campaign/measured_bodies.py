"""Measured surfaces of a campaign between rough bodies: read once, the same in every case."""

from typing import Literal

from gfmd_numba.campaign.file import Campaign, check_scene
from gfmd_numba.contact.contact_input import with_measured
from gfmd_numba.contact.rough_surfaces import MeasuredSurfaces
from gfmd_numba.scene import Document, Measured
from gfmd_numba.scene.scene_file import with_located_files


def with_measured_bodies(campaign: Campaign, document: Document) -> tuple[Campaign, MeasuredSurfaces]:
    """A campaign with the dimension and the period that its measured surfaces tell, and these surfaces.

    Raises InputError for files that cannot be used or do not fit each other.
    """
    if not any(isinstance(surface, Measured) for surface in campaign.scene.surfaces.values()):
        return campaign, {}
    scene, measured = with_measured(with_located_files(document, campaign.scene), document)
    check_scene(document, campaign, scene)
    return campaign.model_copy(update={"scene": scene}), measured


def said_of_bodies(measured: MeasuredSurfaces, what: Literal["done", "doubts"]) -> list[str]:
    """What was done to measured surfaces, or makes them implausible, each after the place of its surface."""
    return [f"{'.'.join(place)}: {told}" for place, surface in measured.items() for told in getattr(surface, what)]
