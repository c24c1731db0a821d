"""What the file of a contact gives: checked records, surfaces made, files read. Errors of files end here."""

from dataclasses import dataclass
from math import isinf

import numpy as np

from gfmd_numba.contact.prescribed_load import reduced_pressure, steps_of
from gfmd_numba.contact.problem import contact_modulus, effective_modulus
from gfmd_numba.contact.refusal import check_combination
from gfmd_numba.contact.rough_surfaces import PressedSurfaces, pressed_surfaces
from gfmd_numba.contact.tractions import Tractions, balanced, read_boundary, tractions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.scene import Document, SceneFile
from gfmd_numba.scene.checks import check_range
from gfmd_numba.scene.document import Location


@dataclass(frozen=True)
class ContactInput:
    """A scene file, the surfaces that it presses together, and the tractions that it prescribes, in g E*."""

    file: SceneFile
    surfaces: PressedSurfaces
    tractions: Tractions | None = None


def read_contact(file: SceneFile, document: Document) -> ContactInput:
    """Whatever a scene file describes or names; raises InputError for what does not go together or cannot be used."""
    check_combination(document, file.scene, file.numerics, file.path)
    surfaces = pressed_surfaces(file, document)
    check_range(document, file.scene, surfaces.surface.nx)
    _check_loads(file, surfaces, document)
    prescribed = _tractions(file, surfaces, document)
    _check_room(file, surfaces, document)
    return ContactInput(file, surfaces, prescribed)


def _check_loads(file: SceneFile, surfaces: PressedSurfaces, document: Document) -> None:
    """Raise InputError for a load that is beyond all measure beside the rms gradient and the moduli."""
    control = file.scene.loading.control
    places: list[Location] = [("scene", "loading", control), *(("path", i, control) for i in range(len(file.path)))]
    for (scene, _), place in zip(steps_of(file), places, strict=True):
        try:
            reduced_pressure(scene, surfaces.rms_gradient, contact_modulus(scene))
        except ValueError as error:
            raise document.error(place, document.value(place), str(error)) from None


def _tractions(file: SceneFile, surfaces: PressedSurfaces, document: Document) -> Tractions | None:
    """Raise InputError for a mean traction that nothing holds, or that the loading decides already."""
    scene, nx = file.scene, surfaces.surface.nx
    if scene.boundary is None:
        return None
    arrays = read_boundary(document, scene.boundary, nx)
    if scene.loading.displacement is None:
        arrays = balanced(
            document, arrays, "normal", f"as loading.{scene.loading.control} prescribes the mean pressure"
        )
    if isinf(scene.body.aspect_ratio):
        arrays = balanced(document, arrays, "tangential", "or a finite aspect_ratio, as nothing holds a half-space")
    scale = surfaces.rms_gradient * effective_modulus(scene.body)
    tangential, normal = (
        np.nan_to_num(arrays.get(f"{component}_traction", np.zeros(nx)), nan=0.0) / scale
        for component in ("tangential", "normal")
    )
    return tractions(tangential, normal)


def _check_room(file: SceneFile, surfaces: PressedSurfaces, document: Document) -> None:
    """Raise InputError for a punch that would have to displace more of an incompressible body than there is room."""
    scene = file.scene
    prescribed: list[tuple[float | None, Location]] = [
        (scene.loading.displacement, ("scene", "loading", "displacement")),
        *((step.displacement, ("path", i, "displacement")) for i, step in enumerate(file.path)),
    ]
    incompressible_slab = scene.body.effective_poissons_ratio == 0.5 and not isinf(scene.body.aspect_ratio)
    if scene.loading.displacement is None or not incompressible_slab or surfaces.bodies is not None:
        return
    surface = surfaces.surface
    one = range(file.realisation, file.realisation + 1)
    heights = surface.heights(one)[0] if isinstance(surface, RandomSurface) else surface.heights
    room = float(heights.max() - heights.mean()) * surfaces.rms_gradient * (scene.length or 1.0)
    for displacement, place in prescribed:
        if displacement is not None and displacement > room:
            allowed = f"at most {room:.6g}, where this punch has no more room for an incompressible body"
            raise document.error(place, document.value(place), allowed)
