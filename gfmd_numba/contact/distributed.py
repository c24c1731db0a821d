"""One contact of a rough map whose rows processes share: each makes the heights of its own, and the first has it all.

The fields come together only once they are solved, as one process writes them.
"""

import time
from dataclasses import replace
from functools import partial

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.arrays.processes import Communicator, Slab
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import condensed_stiffness
from gfmd_numba.contact.state import NO_MODIFICATION, Contact, State
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.distributed import SlabTransform
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.certificate import pressure_scale
from gfmd_numba.solvers.distributed_newton import REACH, SlabEquilibrium, halvings, press_slab
from gfmd_numba.solvers.equilibrium import Equilibrium
from gfmd_numba.text.input_error import InputError


def solve_in_slabs(problem: Problem, realisation: int, communicator: Communicator) -> Contact | None:
    """Contact of a map that several processes solve together, in the first of them; None in the others.

    Raises InputError for more processes than there are rows for.
    """
    surface, load, size = problem.surface, problem.mean_pressure, communicator.size
    assert isinstance(surface, RandomSurface)  # any other is refused, as all but a load
    assert load is not None
    ny, nx = surface.shape
    if ny < REACH * size:
        raise InputError.of("--mpi", f"{size} processes", f"at most {ny // REACH} for a map of {ny} rows")
    slab, stiffness_of_waves = (
        Slab.of(communicator, ny, 2 ** halvings(ny, nx, size)),
        partial(condensed_stiffness, problem),
    )
    heights = slab_heights(surface, slab, realisation)
    (highest,) = slab.largest(float(heights.max()))
    started = time.perf_counter()
    found = press_slab(slab, highest - heights, stiffness_of_waves, load, problem.numerics)
    took = time.perf_counter() - started
    every = [slab.gathered(each) for each in (heights, found.displacement, found.pressure)]
    whole, displacement, pressure = every
    if whole is None or displacement is None or pressure is None:
        return None
    solved = replace(found, displacement=displacement, pressure=pressure)
    return _contact(problem, whole[np.newaxis], solved, took)


def slab_heights(surface: RandomSurface, slab: Slab, realisation: int) -> Reals:
    """Heights `[row, x]` of the rows of a process: those that `surface.heights` gives to the last bit."""
    generator, transform = surface.generator, SlabTransform(slab, surface.nx, np.zeros_like)
    assert isinstance(generator, SelfAffineWaves)
    spectrum, squares = generator.columns(surface.nx, surface.seed, realisation, transform.columns)
    spectrum /= np.sqrt(np.concatenate(slab.communicator.allgather(squares)).sum())
    return transform.signal(spectrum)


def _contact(problem: Problem, heights: Reals, found: SlabEquilibrium, took: float) -> Contact:
    """Contact `[realisation, y, x]` of the gathered fields of all processes."""
    punch, stiffness_of_waves = heights.max() - heights, partial(condensed_stiffness, problem)
    response = SpectralResponse.of_normal(stiffness_of_waves(grid.magnitudes(punch.shape[1:])))
    equilibrium = Equilibrium(
        displacement=found.displacement[np.newaxis],
        pressure=found.pressure[np.newaxis],
        touching=found.pressure[np.newaxis] > 0.0,
        tangential=None,
        status=np.array([found.status], dtype=np.int8),
        residual=np.array([found.residual]),
        n_iterations=np.array([found.n_iterations]),
        n_transforms=np.array([found.n_transforms]),
        wall_time=np.array([took]),
        full_contact_rms_pressure=pressure_scale(punch, response),
    )
    state = State.untouched(heights, ())
    return Contact(heights, punch, equilibrium, state, problem.step, NO_MODIFICATION, stiffness=stiffness_of_waves)
