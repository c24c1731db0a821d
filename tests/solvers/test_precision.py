"""Single precision: the same contact within what its residual says, and a certificate that holds in double."""

from dataclasses import replace

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.contact.evaluation import gap, measure
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import solve
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine_waves import SelfAffineWaves
from gfmd_numba.scene import InputError
from gfmd_numba.solvers.equilibrium import begin
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start
from gfmd_numba.solvers.options import Options

SOLVERS = ("active_set_newton", "conjugate_gradients", "verlet", "gronbech_jensen", "fire")
NX = 1024
TIGHT = Options("active_set_newton", residual=1e-12)
PROBLEM = Problem(
    RandomSurface(SelfAffineWaves(0.5, 2, 128), NX, 7), ElasticBody(None, None), Interactions(True), 0.05, None, TIGHT
)
MAP = replace(PROBLEM, surface=RandomSurface(SelfAffineWaves(0.8, 2, 8), 64, 7, 2))


def single(problem, solver, residual=1e-3):
    return solve(replace(problem, numerics=Options(solver, residual=residual, precision="single")), range(4))


@pytest.mark.parametrize(
    ("problem", "solver"),
    [*((PROBLEM, solver) for solver in SOLVERS), *((MAP, solver) for solver in SOLVERS[:2])],
)
def test_kappa_differs_by_no_more_than_the_residual_allows(problem, solver):
    found, exact = measure(single(problem, solver)), measure(solve(problem, range(4)))
    assert not found["status"].any()
    assert (abs(found["kappa"] - exact["kappa"]) <= found["kappa_residual_error"]).all()
    np.testing.assert_allclose(found["kappa"], exact["kappa"], rtol=2e-2)


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_certificate_holds_in_double_precision(solver):
    contact = single(PROBLEM, solver)
    assert contact.equilibrium.pressure.dtype == np.float32
    u = contact.equilibrium.displacement.astype(np.float64)
    spectrum = np.fft.rfft(u) * stiffness.half_space(grid.wavenumbers(NX))
    spectrum[:, 0] = 0.0
    traction = PROBLEM.mean_pressure - np.fft.irfft(spectrum, NX)
    pressure = np.where(gap(contact) <= 0.0, np.maximum(traction, 0.0), 0.0)
    local = abs(traction - pressure).max(axis=1) / pressure.max(axis=1)
    rounding = 1e-8 * NX
    assert (gap(contact) >= 0.0).all()
    assert (local <= contact.equilibrium.residual + rounding).all()
    assert (abs(pressure.mean(axis=1) / PROBLEM.mean_pressure - 1.0) <= contact.equilibrium.residual + rounding).all()


def test_all_large_arrays_of_a_solver_are_of_the_precision_of_the_punch():
    punch = np.abs(np.sin(np.arange(2 * NX)).reshape(2, NX)).astype(np.float32)
    solver = begin(
        Batch(punch, stiffness.half_space(grid.wavenumbers(NX)), np.full(2, 0.05), HARD_WALL, Start.at_rest(punch)),
        Options("active_set_newton", residual=1e-3),
    )
    field = solver.field
    arrays = (*field.sources, field.result, solver.wall, solver.gap, solver.compliance)
    assert {array.dtype for array in arrays} == {np.dtype(np.float32)}
    assert field.spectrum.dtype == np.complex64


def test_precision_is_part_of_the_identity():
    loose = replace(PROBLEM, numerics=Options("verlet", residual=1e-3))
    assert replace(loose, numerics=Options("verlet", residual=1e-3, precision="single")).identity != loose.identity


@pytest.mark.parametrize(
    "effect", [{"friction": {"coefficient": 0.3}}, {"exponential": {"work_of_adhesion": 1e-6, "range": 0.01}}]
)
def test_what_does_not_know_single_precision_refuses_it(effect):
    scene = {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}, **effect},
        "loading": {"reduced_pressure": 0.05},
    }
    numerics = {"precision": "single", "residual": 1e-3}
    with pytest.raises(
        InputError,
        match=r"numerics.precision: given '?single'?; allowed: .double.; .single. needs",
    ):
        gfmd_numba.solve(
            {"scene": scene, "numerics": numerics, "discretisation": {"eps_c": 0.25, "eps_f": 0.125, "eps_t": 0.5}}
        )
