"""What the user describes, and how it is read and checked."""

from gfmd_numba.scene.body_record import Body
from gfmd_numba.scene.document import Document, read_document, validate
from gfmd_numba.scene.interface_records import HardWall, Interface
from gfmd_numba.scene.loading import Loading
from gfmd_numba.scene.measured_record import Measured
from gfmd_numba.scene.records import COMPONENTS, Boundary, Discretisation, Numerics, Scene, SceneFile
from gfmd_numba.scene.scene_file import input_files, load_scene
from gfmd_numba.scene.surfaces import Random, SelfAffine, Surface
from gfmd_numba.text.input_error import InputError
