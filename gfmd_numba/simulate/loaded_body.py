"""One body without a punch, loaded and displaced as its boundary prescribes, from its file to a dataset."""

import warnings

import xarray as xr

from gfmd_numba.contact.loaded_body import read_loaded_body, reduce_loaded_body
from gfmd_numba.contact.loaded_body_dataset import loaded_body_dataset
from gfmd_numba.contact.loaded_rough_body import solve_boundary_value_problem
from gfmd_numba.scene import BoundaryFile, Document


def solve_loaded_body(file: BoundaryFile, document: Document) -> xr.Dataset:
    """Displacements and tractions of all components over `x`, or (y, x), and how they were reached, in SI units.

    Raises InputError for a boundary that is over-determined or out of balance; a run that fails says so in `status`.
    """
    given = read_loaded_body(file, document)
    problem = reduce_loaded_body(given)
    dataset = loaded_body_dataset(given, problem, solve_boundary_value_problem(problem))
    for sentence in filter(None, dataset.attrs["validity"].split("\n")):
        warnings.warn(sentence, stacklevel=3)
    return dataset
