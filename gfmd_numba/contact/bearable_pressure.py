"""The mean pressure that a hardness bears: less than itself, at which every node would be plastic."""

from collections.abc import Mapping, Sequence

from gfmd_numba.contact.bodies import contact_modulus, stiffness_scale
from gfmd_numba.scene import Document, Random, Scene
from gfmd_numba.scene.document import Location


def check_bearable(document: Document, scene: Scene, grid: Mapping[str, Sequence[float]]) -> None:
    """Raise InputError for a pressure of a scene, or of its grid, that the least hardness beside it cannot bear.

    Surfaces of an rms height have no gradient before they are made: reduction refuses theirs.
    """
    own = scene.roughness.rms_gradient if isinstance(scene.roughness, Random) else None
    gradients = grid.get("rms_gradient", () if own is None else (own,))
    hardness = scene.interface.hardness
    hardnesses = grid.get("hardness", () if hardness is None else (hardness,))
    if not gradients or not hardnesses:
        return
    stiffest = max(contact_modulus(each) for each in _bodies(scene, grid.get("poissons_ratio", ())))
    most = min(hardnesses) * stiffness_scale(scene) / (max(gradients) * stiffest)
    for location, pressure in _pressures(scene, grid):
        if pressure >= most:
            raise document.error(
                location, pressure, f"below {most:.6g}, at which the mean pressure is the hardness itself"
            )


def _bodies(scene: Scene, ratios: Sequence[float]) -> list[Scene]:
    """The scene with each Poisson's ratio of a grid."""
    bodies = (scene.body.model_copy(update={"poissons_ratio": ratio}) for ratio in ratios)
    return [scene.model_copy(update={"body": body}) for body in bodies] or [scene]


def _pressures(scene: Scene, grid: Mapping[str, Sequence[float]]) -> list[tuple[Location, float]]:
    """The reduced pressures, and where they stand in the file."""
    if "reduced_pressure" in grid:
        return [(("grid", "reduced_pressure", i), value) for i, value in enumerate(grid["reduced_pressure"])]
    own = scene.loading.reduced_pressure
    return [] if own is None else [(("scene", "loading", "reduced_pressure"), own)]
