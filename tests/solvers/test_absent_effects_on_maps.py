"""What a scene of a map does not call for costs it nothing: no transform, no array."""

import tracemalloc

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.contact.plastic_flow import PlasticFlow
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.eigenstrain import Sublayers
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.equilibrium import begin, equilibrate
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start
from gfmd_numba.solvers.table import Options
from support.maps import body, rough

ADHESIVE = Interactions(True, ExponentialLaw(2e-4, 5e-3))
RUBBING, HALF_SPACE = Interactions(True, friction=0.3), ElasticBody(0.3, None)
NODES = 128 * 128
SCENE = {
    "dimension": 2,
    "body": {"poissons_ratio": 0.3},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.05},
}


def begun(solver, interface, steps=2):
    """A solver after a few iterations on a map, and the peak of its memory in bytes a node."""
    punch = rough(128)
    stiff = HALF_SPACE.response((128, 128))
    stiff = stiff.condensed() if interface.friction is None else stiff
    batch = Batch(punch, stiff, np.array([0.05]), interface, Start.at_rest(punch))
    tracemalloc.start()
    made = begin(batch, Options(solver))
    for _ in range(steps):
        made.advance(np.arange(1))
        made.residual(np.arange(1))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return made, peak / NODES


@pytest.mark.parametrize("solver", ["verlet", "gronbech_jensen", "fire"])
def test_a_step_of_damped_dynamics_takes_two_transforms_with_and_without_a_law(solver):
    for interface in (HARD_WALL, ADHESIVE):
        made, _ = begun(solver, interface)
        assert made.n_transforms.tolist() == [2 + 2 * 2]


@pytest.mark.parametrize(("solver", "less"), [("truncated_newton", 8.0), ("verlet", 0.0)])
def test_a_hard_wall_alone_takes_fewer_bytes_a_node_than_with_an_attraction(solver, less):
    begun(solver, HARD_WALL), begun(solver, ADHESIVE)  # plans and kernels are made
    (alone, fewer), (_, more) = begun(solver, HARD_WALL), begun(solver, ADHESIVE)
    assert fewer < more - less + 0.2
    assert more < 24 * 8  # what plans and checks of memory count with
    if solver == "truncated_newton":
        assert alone._bound is alone._wall


def test_without_friction_a_step_has_a_third_of_the_transforms_and_of_the_bytes():
    """Of each displacement one transform and back; friction has three, and 3 x 3 symbols, anchors and slip."""
    begun("verlet", HARD_WALL), begun("verlet", RUBBING)  # plans and kernels are made
    (alone, fewer), (rubbing, more) = begun("verlet", HARD_WALL), begun("verlet", RUBBING)
    assert 3 * alone.n_transforms == rubbing.n_transforms
    assert alone.state.anchor.size == 0
    assert fewer < 6 * 8  # six arrays of the size of the map, as many as before friction was there
    assert fewer < more / 3


def test_without_friction_no_tangential_stiffness_and_no_slip_is_ever_made(monkeypatch):
    def made(*given):
        raise AssertionError("what friction alone needs was made")

    monkeypatch.setattr(ElasticBody, "response", made)
    monkeypatch.setattr(ElasticBody, "compliance_across", made)
    eps = {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2}
    found, absent = (
        gfmd_numba.solve({"scene": SCENE | {"interface": {"hard_wall": {}} | given}, "discretisation": eps})
        for given in ({}, {"friction": None})
    )
    assert int(found["n_transforms"]) == int(absent["n_transforms"])
    np.testing.assert_array_equal(found["pressure"], absent["pressure"])
    assert not any(str(name).startswith(("tangential", "slip")) for name in found.variables)
    rubbing = {"hard_wall": {}, "friction": {"coefficient": 0.3}}
    with pytest.raises(AssertionError, match="friction alone"):
        gfmd_numba.solve({"scene": SCENE | {"interface": rubbing}, "discretisation": eps})


def test_without_a_yield_stress_nothing_that_flows_is_ever_made(monkeypatch):
    """The same transforms with `plasticity` null as without, no sublayer, no memory and no result of a flow."""

    def made(*given):
        raise AssertionError("what plastic flow alone needs was made")

    monkeypatch.setattr(Sublayers, "__init__", made)
    monkeypatch.setattr(PlasticFlow, "begin", made)
    eps = {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2}
    bodies = SCENE["body"], SCENE["body"] | {"plasticity": None}
    path = [{"reduced_pressure": 0.1}, {"reduced_pressure": 0.01}]
    found, absent = (
        gfmd_numba.solve({"scene": SCENE | {"body": body}, "discretisation": eps, "path": path}) for body in bodies
    )
    assert found["n_transforms"].values.tolist() == absent["n_transforms"].values.tolist()
    np.testing.assert_array_equal(found["pressure"], absent["pressure"])
    of_flow = {"equivalent_plastic_strain", "residual_displacement", "flow_residual", "plastic_volume", "depth"}
    assert not of_flow & set(found.variables)
    flows = SCENE["body"] | {"plasticity": {"yield_stress": 0.01}}
    with pytest.raises(AssertionError, match="plastic flow alone"):
        gfmd_numba.solve({"scene": SCENE | {"body": flows}, "discretisation": eps})


def test_the_hard_wall_of_a_map_has_the_solver_of_hard_walls_and_no_fields_of_other_effects():
    found = gfmd_numba.solve({"scene": SCENE, "discretisation": {"eps_c": 1 / 2, "eps_f": 1 / 16, "eps_t": 1 / 2}})
    assert found.attrs["solver"] == "active_set_newton"
    absent = {"relative_softening", "next_order", "body_height", "energy_lost", "stability", "tangential_traction"}
    assert not absent & set(found.variables)


def test_a_law_that_does_next_to_nothing_leaves_the_contact_of_the_hard_wall():
    punch, stiff = rough(64), body((64, 64))
    faint = Interactions(True, ExponentialLaw(1e-14, 1e-3))
    found = equilibrate(punch, SpectralResponse.of_normal(stiff), 0.05, Options("truncated_newton"), faint)
    expected = equilibrate(punch, SpectralResponse.of_normal(stiff), 0.05, Options("active_set_newton"))
    np.testing.assert_array_equal(found.touching, expected.touching)
    np.testing.assert_allclose(found.pressure, expected.pressure, atol=1e-6 * expected.pressure.max())
