"""One file in, one dataset out: read, reduce, solve, write."""

import xarray as xr

from gfmd_numba.scene import BoundaryFile, Document, SceneFile
from gfmd_numba.simulate.contact import solve_contact
from gfmd_numba.simulate.loaded_body import solve_loaded_body


def solve(file: SceneFile | BoundaryFile, document: Document) -> xr.Dataset:
    """Solve what a file describes, a contact or a loaded body without a punch; raises InputError."""
    if isinstance(file, BoundaryFile):
        return solve_loaded_body(file, document)
    return solve_contact(file, document)
