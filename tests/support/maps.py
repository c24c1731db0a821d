"""Rough maps, and a punch of two dimensions pressed on a body."""

import slab_stiffness

from gfmd_numba.contact.problem import Problem
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options

HALF_SPACE = ElasticBody(None, None)


def body(shape, slab=None):
    q = grid.magnitudes(shape)
    return stiffness.half_space(q) if slab is None else slab_stiffness.slab(q, *slab)


def press(punch, load, solver="active_set_newton", slab=None):
    found = equilibrate(punch, SpectralResponse.of_normal(body(punch.shape[1:], slab)), load, Options(solver))
    assert (found.status == Status.ok).all()
    return found


def rough(nx, realisations=range(1), hurst=0.8, seed=3):
    heights = self_affine.SelfAffineWaves(hurst, 2, nx // 4).heights((nx, nx), seed, realisations)
    return heights.max(axis=(1, 2), keepdims=True) - heights


def problem(nx=64, load=0.03, cut_off=16, solver="active_set_newton"):
    surface = RandomSurface(SelfAffineWaves(0.8, 2, cut_off), nx, 7, dimension=2)
    return Problem(surface, HALF_SPACE, Interactions(hard_wall=True), load, None, Options(solver))
