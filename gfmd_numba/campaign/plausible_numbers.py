"""Numbers of a campaign that are implausible for what they are, in its scene or in its grid."""

from gfmd_numba.campaign.axes import OF_THE_SCENE, with_values
from gfmd_numba.campaign.file import Campaign
from gfmd_numba.contact.plausible_numbers import implausible
from gfmd_numba.scene.document import dotted


def doubt_of_numbers(campaign: Campaign, length: float | None) -> str:
    """Sentences about implausible numbers, a line each; `length` is the period in m, which a measured file may tell.

    Of the values of an axis the first implausible one is named.
    """
    axes = {axis: values for axis in OF_THE_SCENE if (values := getattr(campaign.grid, axis.name))}
    scene = with_values(campaign.scene, {axis.place: values[0] for axis, values in axes.items()})
    scene = scene.model_copy(update={"length": length})
    found = dict.fromkeys(implausible(scene, campaign.path))
    for axis, values in axes.items():
        others = (implausible(with_values(scene, {axis.place: value}), campaign.path) for value in values[1:])
        found |= dict.fromkeys(next((sentences for sentences in others if set(sentences) - found.keys()), ()))
    said = "\n".join(found)
    for axis in axes:
        said = said.replace(f"{dotted(axis.place)} is ", f"grid.{axis.name} is ")
    return said
