"""Tractions that a campaign prescribes in all its cases: files read once, on a grid that all of them fit."""

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.tractions import Tractions, read_boundary, tractions_on_the_body
from gfmd_numba.scene import Document, Scene
from gfmd_numba.scene.scene_file import located_boundary


class PrescribedTractions:
    """The boundary of a campaign's scenes in units of each case; equal tractions are one object."""

    def __init__(self, document: Document, scene: Scene):
        self._document = document
        self._boundary = None if scene.boundary is None else located_boundary(document, scene.boundary)
        self._arrays: dict[tuple[int, ...], dict[str, Reals]] = {}
        self._found: dict[str, Tractions] = {}

    def __call__(self, scene: Scene, shape: tuple[int, ...], rms_gradient: float) -> Tractions | None:
        """Tractions on a surface of that shape; raises InputError for files that do not fit it, or no balance."""
        if self._boundary is None:
            return None
        if shape not in self._arrays:
            self._arrays[shape] = read_boundary(self._document, self._boundary, scene.dimension, shape)
        found = tractions_on_the_body(self._document, scene, self._arrays[shape], shape, rms_gradient)
        return self._found.setdefault(found.digest, found)
