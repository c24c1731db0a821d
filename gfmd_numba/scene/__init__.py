"""What the user describes, and how it is read and checked."""

from gfmd_numba.scene.document import Document, InputError, read_document
from gfmd_numba.scene.interface_records import HardWall, Interface
from gfmd_numba.scene.records import (
    Body,
    Discretisation,
    Loading,
    Measured,
    Numerics,
    Roughness,
    Scene,
    SceneFile,
    SelfAffine,
)
from gfmd_numba.scene.scene_file import check_discretisation, check_range, load_scene, scene_document
from gfmd_numba.scene.validation import validate

__all__ = [
    "Body",
    "Discretisation",
    "Document",
    "HardWall",
    "InputError",
    "Interface",
    "Loading",
    "Measured",
    "Numerics",
    "Roughness",
    "Scene",
    "SceneFile",
    "SelfAffine",
    "check_discretisation",
    "check_range",
    "load_scene",
    "read_document",
    "scene_document",
    "validate",
]
