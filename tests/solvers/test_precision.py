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
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.scene import InputError
from gfmd_numba.solvers.equilibrium import begin
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start
from gfmd_numba.solvers.table import Options

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
        Batch(
            punch,
            SpectralResponse.of_normal(stiffness.half_space(grid.wavenumbers(NX))),
            np.full(2, 0.05),
            HARD_WALL,
            Start.at_rest(punch),
        ),
        Options("active_set_newton", residual=1e-3),
    )
    field = solver.field
    arrays = (*field.sources, field.result, solver.wall, solver.gap, solver.compliance)
    assert {array.dtype for array in arrays} == {np.dtype(np.float32)}
    assert field.spectrum.dtype == np.complex64


def test_precision_is_part_of_the_identity():
    loose = replace(PROBLEM, numerics=Options("verlet", residual=1e-3))
    assert replace(loose, numerics=Options("verlet", residual=1e-3, precision="single")).identity != loose.identity


PSD = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
SLAB = {"youngs_modulus": 1.0, "poissons_ratio": 0.3, "aspect_ratio": 0.5}
EPS = {1: {"eps_c": 1 / 4, "eps_f": 1 / 32, "eps_t": 1 / 2}, 2: {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2}}
WALL = {"hard_wall": {}}
LAWS = {
    "exponential": {"exponential": {"work_of_adhesion": 1e-6, "range": 2e-3}},
    "repulsion": {"exponential": {"work_of_adhesion": -1e-4, "range": 0.02}},
    "cohesive": {"cohesive": {"work_of_adhesion": 1e-6, "normal_length": 4e-3, "tangential_length": 4e-3}},
    "friction": {"friction": {"coefficient": 0.3}},
    "sticking": {"friction": {"coefficient": float("inf")}},
}
LAWS["friction and law"] = LAWS["friction"] | LAWS["exponential"]


def both_precisions(dimension, path=(), order=None, **parts):
    """What a scene comes to in single and in double precision."""
    scene = {"dimension": dimension, "body": SLAB, "interface": WALL, "loading": {"reduced_pressure": 0.05}} | parts
    file = {"scene": scene, "discretisation": EPS[dimension], "path": list(path)}
    numerics = {} if order is None else {"topography_order": order}
    single, double = ({"precision": "single", "residual": 1e-3}, {"residual": 1e-7})
    found = [gfmd_numba.solve(file | {"numerics": numerics | each}) for each in (single, double)]
    for each in found:
        assert (each["status"] == 0).all()
    return found


def near(found, exact, names, tolerance):
    for name in names:
        if name in exact:
            difference = float(abs(found[name] - exact[name]).max())
            assert difference <= tolerance * float(abs(exact[name]).max()), name


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("law", LAWS)
def test_every_law_has_the_tractions_of_double_precision(law, dimension):
    """Along a path that also drags the punch, on profiles of 512 nodes and maps of 32 x 32."""
    drags = {"cohesive", "friction"} & LAWS[law].keys()
    path = [{"displacement": 1e-3}, {"displacement": 8e-4} | ({"sliding": 1e-4} if drags else {})]
    found = both_precisions(dimension, path, roughness=PSD, interface=WALL | LAWS[law], loading={"displacement": 6e-4})
    near(*found, ("pressure", "displacement", "contact_area_fraction"), 1e-2)
    if drags:
        rubbed, exact = (each["tangential_traction"] for each in found)
        assert abs(rubbed - exact).max() < 3e-3 * found[1]["pressure"].max()


@pytest.mark.parametrize(("dimension", "order"), [(1, 0), (1, 2), (2, 0), (2, 1)])
@pytest.mark.parametrize("counter_body", [None, SLAB | {"roughness": PSD}], ids=["punch", "two bodies"])
def test_rough_bodies_have_the_fields_of_double_precision(dimension, order, counter_body):
    parts = {} if counter_body is None else {"counter_body": counter_body}
    found = both_precisions(dimension, (), order, body=SLAB | {"roughness": PSD}, **parts)
    near(*found, ("pressure", "displacement", "counter_body_displacement", "kappa"), 3e-3)
    near(*found, ("next_order",), 1e-2)


def test_pull_off_and_what_it_costs_are_those_of_double_precision():
    path = [{"displacement": value} for value in np.linspace(2e-4, -4e-3, 8).tolist()]
    law = {"exponential": {"work_of_adhesion": 3e-6, "range": 3e-3}}
    found = both_precisions(1, path, roughness=PSD, interface=WALL | law, loading={"displacement": 6e-4})
    near(*found, ("pull_off_pressure", "pressure", "stability"), 2e-3)
    near(*found, ("energy_lost", "hysteresis"), 1e-2)


def test_a_body_displaced_without_a_punch_bears_the_tractions_of_double_precision(tmp_path):
    x = np.arange(128) / 128
    np.save(tmp_path / "held.npy", np.where(abs(x - 0.5) < 0.2, -1e-3 * np.cos(2 * np.pi * x), np.nan))
    scene = {"body": SLAB, "boundary": {"normal_displacement": str(tmp_path / "held.npy")}}
    numerics = ({"precision": "single", "residual": 1e-3}, {"residual": 1e-3})
    found = [gfmd_numba.solve({"scene": scene, "numerics": each}) for each in numerics]
    near(*found, ("normal_traction", "tangential_displacement", "normal_displacement"), 1e-3)
    assert found[0]["status"] == 0


def test_tractions_alone_on_a_body_need_no_precision():
    scene = {"body": SLAB, "boundary": {"tangential_traction": 1e-3}}
    with pytest.raises(InputError, match=r"numerics.precision: you gave '?single'?; gfmd allows nothing where tr"):
        gfmd_numba.solve({"scene": scene, "points": 8, "numerics": {"precision": "single", "residual": 1e-3}})


def test_heights_too_coarse_for_a_law_are_told():
    law = {"exponential": {"work_of_adhesion": 1e-14, "range": 3e-8}}
    scene = {"body": SLAB, "roughness": PSD, "interface": WALL | law, "loading": {"reduced_pressure": 0.05}}
    numerics = {"precision": "single", "residual": 1e-3}
    with pytest.warns(UserWarning, match="single precision rounds the heights"):
        gfmd_numba.solve({"scene": scene, "discretisation": EPS[1], "numerics": numerics})


def test_all_large_arrays_of_the_newton_methods_with_laws_are_of_the_precision_of_the_punch():
    punch = np.abs(np.sin(np.arange(2 * NX)).reshape(2, NX)).astype(np.float32)
    law, body = ExponentialLaw(1e-3, 0.1), ElasticBody(0.3, 1.0)
    cohesive, start, load = XuNeedlemanLaw(1e-3, 0.1, 0.1), Start.at_rest(punch), np.full(2, 0.05)
    for stiffness_, laws in (
        (body.response((NX,)).condensed(), Interactions(True, normal_law=law)),
        (body.response((NX,)), Interactions(True, cohesive=cohesive)),
    ):
        solver = begin(Batch(punch, stiffness_, load, laws, start), Options("truncated_newton", residual=1e-3))
        arrays = {name: each for name, each in vars(solver).items() if getattr(each, "nbytes", 0) and each.strides[-1]}
        large = {name: each.dtype for name, each in arrays.items() if each.size >= 2 * NX}
        assert set(large.values()) <= {np.dtype(np.float32)}, large
