"""The tables of solvers and laws say what the code does, and equal problems have one identity."""

import subprocess
import sys
from pkgutil import resolve_name

import numpy as np
import pytest

from gfmd_numba.contact.reduction import reduce
from gfmd_numba.contact.rough_surfaces import FacingSurfaces
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.scene import Interface, Numerics, Scene
from gfmd_numba.scene.interface_records import LAWS
from gfmd_numba.solvers.equilibrium import begin
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start
from gfmd_numba.solvers.table import ABILITIES, MAX_ITERATIONS, RESIDUAL, SOLVERS, Options, able, automatic

SCENE = {
    "body": {"poissons_ratio": 0.3, "aspect_ratio": 1.0},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.05},
}


def identity(**numerics):
    surfaces = FacingSurfaces(RandomSurface(SelfAffineWaves(0.8, 2, 32), 128, 0), 0.01)
    return reduce(Scene.model_validate(SCENE), surfaces, Numerics(**numerics))[0].identity


@pytest.mark.long
def test_tables_are_data():
    code = "import sys, gfmd_numba.solvers.table, gfmd_numba.scene.interface_records; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numpy", "numba", "dask", "scipy", "xarray"} & set(done.stdout.split())


def test_scene_files_name_the_laws_of_the_table_and_the_defaults_of_the_solvers():
    assert list(Interface.model_fields) == [*LAWS, "wear"]  # which is no law of tractions
    assert {law.ability for law in LAWS.values()} < set(ABILITIES)
    assert (Numerics().residual, Numerics().max_iterations) == (RESIDUAL, MAX_ITERATIONS)


@pytest.mark.parametrize("name", SOLVERS)
def test_what_a_row_names_exists(name):
    solver = SOLVERS[name]
    assert solver.can <= set(ABILITIES)
    assert solver.successor is None or (solver.successor in SOLVERS and solver.gives_up_after is not None)
    assert bool(solver.coupled) == bool({"friction", "cohesive law"} & solver.can)
    assert all(callable(resolve_name(path)) for path in solver.condensed + solver.coupled)
    assert all(callable(resolve_name(law.implementation)) for law in LAWS.values() if law.implementation is not None)


@pytest.mark.parametrize("name", SOLVERS)
def test_every_solver_has_the_same_surface(name):
    punch = 0.01 * (1.0 - np.cos(2.0 * np.pi * np.arange(32) / 32))[np.newaxis]
    stiffness = 0.5 * 2.0 * np.pi * np.arange(17.0)
    solver = begin(
        Batch(punch, SpectralResponse.of_normal(stiffness), np.array([0.01]), HARD_WALL, Start.at_rest(punch)),
        Options(name),
    )
    for _ in range(5):  # a residual not yet expected to be small may stay unknown
        solver.advance(np.arange(1))
        residual = solver.residual(np.arange(1))
    assert np.isfinite(residual).all()
    assert solver.state.u.shape[1] == 1
    assert solver.n_transforms[0] > 0


def test_auto_is_the_first_that_can():
    assert automatic(1, ["hard wall"]) == automatic(2, ["hard wall"]) == "active_set_newton"
    assert automatic(1, ["hard wall", "normal law"]) == automatic(2, ["normal law"]) == "truncated_newton"
    assert automatic(1, ["cohesive law"]) == automatic(1, ["rigid mean", "normal law"]) == "truncated_newton"
    assert able(["prescribed"]) == ("verlet",)
    assert able(["dimension 2", "friction"]) == ("frictional_newton", "verlet")


def test_an_option_that_the_solver_lacks_is_no_part_of_it():
    assert Options("active_set_newton").damping is None
    assert Options("fire").time_step == 0.95
    with pytest.raises(ValueError, match="fire has no damping"):
        Options("fire", damping=0.5)


def test_equal_problems_have_one_identity():
    assert identity() == identity(solver="active_set_newton") == identity(effects="exact")
    assert identity(solver="verlet") == identity(solver="verlet", time_step=0.95, damping=0.5)
    assert identity(solver="verlet") != identity(solver="verlet", damping=0.25)
