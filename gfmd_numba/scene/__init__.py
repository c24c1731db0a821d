"""What the user describes, and how it is read and checked."""

from gfmd_numba.scene.body_record import Body
from gfmd_numba.scene.boundary_file import BoundaryFile, LoadedBody, has_no_punch, input_files, load_boundary
from gfmd_numba.scene.boundary_records import COMPONENTS, Boundary
from gfmd_numba.scene.document import Document, InputError, read_document
from gfmd_numba.scene.interface_records import HardWall, Interface
from gfmd_numba.scene.records import (
    SINGLE_RESIDUAL,
    Discretisation,
    Loading,
    Numerics,
    Scene,
    SceneFile,
)
from gfmd_numba.scene.scene_file import check_discretisation, check_range, load_scene, scene_document
from gfmd_numba.scene.surfaces import Measured, Random, SelfAffine, Surface
from gfmd_numba.scene.validation import validate

__all__ = [
    "COMPONENTS",
    "SINGLE_RESIDUAL",
    "Body",
    "Boundary",
    "BoundaryFile",
    "Discretisation",
    "Document",
    "HardWall",
    "InputError",
    "Interface",
    "LoadedBody",
    "Loading",
    "Measured",
    "Numerics",
    "Random",
    "Scene",
    "SceneFile",
    "SelfAffine",
    "Surface",
    "check_discretisation",
    "check_range",
    "has_no_punch",
    "input_files",
    "load_boundary",
    "load_scene",
    "read_document",
    "scene_document",
    "validate",
]
