"""The mean pressure that a hardness bears: less than that at which every node would be plastic."""

from collections.abc import Iterator, Mapping, Sequence

from gfmd_numba.contact.bodies import contact_modulus, stiffness_scale
from gfmd_numba.scene import Document, Interface, Random, Scene
from gfmd_numba.scene.document import Location
from gfmd_numba.scene.loading import Step
from gfmd_numba.scene.units import in_unit_of


def plastic_pressure(interface: Interface, grid: Mapping[str, Sequence[float]] | None = None) -> float | None:
    """Pressure of a plastic spot in Pa (E* without moduli): the hardness less what a law pulls at no gap.

    The least one of a grid; None without a hardness.
    """
    grid, law = grid or {}, interface.exponential
    hardnesses = grid.get("hardness", () if interface.hardness is None else (interface.hardness,))
    if not hardnesses:
        return None
    if law is None:
        return min(hardnesses)
    works, ranges = grid.get("work_of_adhesion", (law.work_of_adhesion,)), grid.get("interaction_range", (law.range,))
    return min(hardnesses) - max(max(works) / length for length in (min(ranges), max(ranges)))


def at_most(interface: Interface) -> str:
    """Say what the mean pressure of a wholly plastic contact is."""
    less = "" if interface.exponential is None else ", less what the exponential law pulls at no gap"
    return f"the mean pressure is the hardness itself{less}"


def check_bearable(document: Document, scene: Scene, path: Sequence[Step], grid: Mapping[str, Sequence[float]]) -> None:
    """Raise InputError for a pressure of a scene, its path or its grid that the least hardness cannot bear.

    Surfaces of an rms height have no gradient before they are made: reduction refuses their reduced pressures.
    """
    plastic = plastic_pressure(scene.interface, grid)
    if plastic is None:
        return
    for location, pressure in _prescribed("pressure", scene, path, grid):
        if pressure >= plastic:
            allowed = f"below {in_unit_of(pressure, plastic, 'Pa')}, at which {at_most(scene.interface)}"
            raise document.error(location, document.value(location), allowed)
    own = scene.roughness.rms_gradient if isinstance(scene.roughness, Random) else None
    gradients = grid.get("rms_gradient", () if own is None else (own,))
    if not gradients:
        return
    stiffest = max(contact_modulus(each) for each in _bodies(scene, grid.get("poissons_ratio", ())))
    most = plastic * stiffness_scale(scene) / (max(gradients) * stiffest)
    for location, pressure in _prescribed("reduced_pressure", scene, path, grid):
        if pressure >= most:
            raise document.error(location, pressure, f"below {most:.6g}, at which {at_most(scene.interface)}")


def _bodies(scene: Scene, ratios: Sequence[float]) -> list[Scene]:
    """The scene with each Poisson's ratio of a grid."""
    bodies = (scene.body.model_copy(update={"poissons_ratio": ratio}) for ratio in ratios)
    return [scene.model_copy(update={"body": body}) for body in bodies] or [scene]


def _prescribed(
    name: str, scene: Scene, path: Sequence[Step], grid: Mapping[str, Sequence[float]]
) -> Iterator[tuple[Location, float]]:
    """The pressures of this name, and where they stand in the file."""
    for i, value in enumerate(grid.get(name, ())):
        yield ("grid", name, i), value
    if name not in grid and getattr(scene.loading, name) is not None:
        yield ("scene", "loading", name), getattr(scene.loading, name)
    for i, step in enumerate(path):
        if getattr(step, name) is not None:
            yield ("path", i, name), getattr(step, name)
