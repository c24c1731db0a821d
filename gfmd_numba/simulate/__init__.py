"""One file in, one dataset out: read, reduce, solve, write."""

import warnings

import xarray as xr

from gfmd_numba.contact.loaded_body import (
    loaded_body_dataset,
    read_loaded_body,
    reduce_loaded_body,
    solve_boundary_value_problem,
)
from gfmd_numba.scene import BoundaryFile, Document, SceneFile
from gfmd_numba.simulate.contact import solve_contact


def solve(file: SceneFile | BoundaryFile, document: Document) -> xr.Dataset:
    """Solve what a file describes, a contact or a loaded body without a punch, in SI units.

    Warns of what its `validity` says. Raises InputError for a file that makes no sense; a run that fails says so in
    `status`.
    """
    if isinstance(file, BoundaryFile):
        given = read_loaded_body(file, document)
        problem = reduce_loaded_body(given)
        dataset = loaded_body_dataset(given, problem, solve_boundary_value_problem(problem))
    else:
        dataset = solve_contact(file, document)
    for sentence in filter(None, dataset.attrs["validity"].split("\n")):
        warnings.warn(sentence, stacklevel=2)
    return dataset
