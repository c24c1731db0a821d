"""What the user describes, and how it is read and checked."""

from gfmd_numba.scene.document import Document, InputError, load_scene, read_document, validate
from gfmd_numba.scene.records import (
    Body,
    Discretisation,
    HardWall,
    Interface,
    Loading,
    Measured,
    Numerics,
    Roughness,
    Scene,
    SceneFile,
    SelfAffine,
)

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
    "load_scene",
    "read_document",
    "validate",
]
