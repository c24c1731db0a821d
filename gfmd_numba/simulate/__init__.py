"""One file in, one dataset out: read, reduce, solve, write."""

import xarray as xr

from gfmd_numba.arrays.processes import Communicator
from gfmd_numba.arrays.threads import shared_by
from gfmd_numba.contact.contact_dataset import boundary_dataset, path_dataset
from gfmd_numba.contact.contact_input import BoundaryInput, read, read_contact
from gfmd_numba.contact.distributed import solve_in_slabs
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.contact.refusal import check_where
from gfmd_numba.contact.state import Tell
from gfmd_numba.scene import Document, SceneFile


def solve(file: SceneFile, document: Document, tell: Tell = lambda more: None) -> xr.Dataset:
    """Solve what a file describes, a contact or a loaded body without a punch, in SI units.

    `tell` is called with the steps of a path, or parts of a step, done since the last call. Raises InputError for a
    file that makes no sense.
    """
    given = read(file, document)
    if isinstance(given, BoundaryInput):
        return boundary_dataset(given)
    problem, realisation = given.task
    with shared_by(problem.numerics.threads):
        return path_dataset(given, solve_path(problem, realisation, tell))


def solve_in_processes(file: SceneFile, document: Document, communicator: Communicator) -> xr.Dataset | None:
    """As `solve`, of a map that processes share: its dataset in the first of them, None in the others.

    Raises InputError, in all of them, for what they cannot share.
    """
    check_where(document, file.scene, "processes", file.numerics, file.path)
    given = read_contact(file, document)
    problem, realisation = given.task
    found = solve_in_slabs(problem, realisation, communicator)
    return None if found is None else path_dataset(given, [found])
