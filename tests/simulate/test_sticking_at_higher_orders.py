"""Friction that needs more than one Newton's method at orders above 0: sticking, with a law of the gap, by dynamics.

Finite elements whose nodes stick, very large coefficients, laws without strength, and one solver against the other.
"""

from dataclasses import replace

import numpy as np
import pytest
from finite_elements import Body, graded

import gfmd_numba
from gfmd_numba.contact import solution
from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.scene import load_scene
from gfmd_numba.solvers.equilibrium import Equilibrium, Tangential
from support.cases import some_of

NX = 256
ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.03}
EPS = {1: {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}, 2: {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2}}
LAWS = {
    "attraction": {"exponential": {"work_of_adhesion": 2e-6, "range": 5e-3}},
    "repulsion": {"exponential": {"work_of_adhesion": -2e-6, "range": 5e-3}},
}


def scene(dimension, order, friction, path=(), loading=None, roughness=ROUGH, law=None, **numerics):
    """Scene file of a rough slab under a level rigid punch."""
    file = {
        "scene": {
            "dimension": dimension,
            "body": {"poissons_ratio": 0.33, "aspect_ratio": 1.0, "roughness": roughness},
            "interface": {"hard_wall": {}}
            | ({"friction": {"coefficient": friction}} if friction else {})
            | (law or {}),
            "loading": loading or {"reduced_pressure": 0.05},
        },
        "path": list(path),
        "numerics": {"topography_order": order, "residual": 1e-10} | numerics,
    }
    return file | ({"discretisation": EPS[dimension]} if roughness is ROUGH else {})


def solved(*args, **kwargs):
    found = gfmd_numba.solve(scene(*args, **kwargs))
    assert (found["status"] == 0).all()
    return found


def close(found, expected, tolerance, names=("pressure", "displacement", "tangential_displacement")):
    for name in names:
        scale = float(abs(expected[name]).max())
        np.testing.assert_allclose(found[name], expected[name], atol=tolerance * scale, err_msg=name)


def pressed_on_mesh(found, heights, depth, columns):
    """Finite elements that stick to the punch, and the steps over their top nodes."""

    def stretched(x, z):
        return 0 * x, heights[np.rint(x * NX).astype(int) % NX] * (z + 1.0)

    mesh = Body(columns, graded(1.0, 24, 0.5 / columns), 0.33, stretched)
    over = NX // (2 * columns)
    clearance, touching = (heights.max() - heights - depth)[::over], found["pressure"].values[::over] > 0.0
    return mesh, mesh.press(clearance, touching, friction=np.inf), over


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")
def test_tractions_of_a_sinusoid_that_sticks_everywhere_are_those_of_finite_elements():
    heights = -0.02 * np.cos(2 * np.pi * np.arange(NX) / NX)
    wave, depth = {"method": "measured", "heights": heights, "units": {"z": "L_x"}}, 0.12
    orders = [solved(1, order, np.inf, loading={"displacement": depth}, roughness=wave) for order in (0, 1, 2, 3)]
    mesh, solution, over = pressed_on_mesh(orders[0], heights, depth, 64)
    corner = slice(None, None, 2)
    pressure = -mesh.traction(solution)[corner]
    along = replace(solution, reaction=solution.reaction.copy())
    along.reaction[mesh.top] = solution.reaction[mesh._partners()]
    shear = mesh.traction(along)[corner]
    off = [
        max(
            abs(each["pressure"].values[:: 2 * over] - pressure).max(),
            abs(each["tangential_traction"].values[:: 2 * over] - shear).max(),
        )
        for each in orders
    ]
    assert abs(shear).max() > 5e-3
    assert off[0] > 2e-3
    assert off[1] < 0.05 * off[0]
    assert off[2] < 0.5 * off[1]
    assert off[3] < 5e-5, off


@pytest.mark.long
def test_sticking_is_friction_of_a_very_large_coefficient():
    path = [{"sliding": 2e-5}, {"reduced_pressure": 0.04}]
    stuck, rough = (solved(2, 2, friction, path) for friction in (np.inf, 1e6))
    close(stuck, rough, 1e-7, ("pressure", "displacement", "tangential_displacement", "tangential_traction"))


@pytest.mark.long
def test_a_law_with_friction_too_weak_to_matter_is_that_of_the_frictionless_contact():
    loads = {"loading": {"displacement": 4e-4}, "law": LAWS["attraction"]}
    rubbed, smooth, bare = (
        solved(1, 2, 1e-9, **loads),
        solved(1, 2, 0.0, **loads),
        solved(1, 2, 0.0, loading=loads["loading"]),
    )
    close(rubbed, smooth, 1e-7)
    assert abs(smooth["pressure"] - bare["pressure"]).max() > 1e-3 * smooth["pressure"].max()


@pytest.mark.long
@pytest.mark.parametrize(("dimension", "friction"), [(1, np.inf), (2, 0.3)])
def test_a_law_without_strength_changes_nothing_at_a_higher_order(friction, dimension):
    path = [{"sliding": 5e-5}]
    faint = {"exponential": {"work_of_adhesion": 1e-18, "range": 5e-3}}
    names = ("pressure", "displacement", "tangential_displacement", "tangential_traction")
    close(solved(dimension, 1, friction, path, law=faint), solved(dimension, 1, friction, path), 1e-7, names)


@pytest.mark.parametrize(
    ("dimension", "friction", "law"),
    some_of([(1, np.inf, None), (1, 0.3, "attraction"), (2, 0.3, None), (2, np.inf, "repulsion")], 1, 2),
)
def test_newtons_method_finds_what_dynamics_find_from_where_these_hold_the_nodes(dimension, friction, law):
    """Dynamics anchor a node where it touches down, which Newton's method is then told, under the same topography."""
    file, document = load_scene(scene(dimension, 2, friction, law=LAWS.get(law), solver="verlet"))
    problem, _ = read_contact(file, document).reduced
    (found,) = solve_path(problem, 0)
    dynamics = found.equilibrium
    assert dynamics.status[0] == 0
    newton = replace(problem.numerics, solver="frictional_newton", time_step=None, damping=None)
    carried = found.correction.shifted[np.newaxis]
    held = replace(found.correction, since=found.correction.shifted)
    again = found.before.remembering("slopes", held).begun_at(found, repeats=True)
    same = solution.solve(replace(problem, numerics=newton), again).equilibrium
    assert same.status[0] == 0
    peak, most = dynamics.pressure.max(), abs(dynamics.tangential.displacement).max()
    assert abs(carried).max() > 1e-3 * most
    np.testing.assert_allclose(same.pressure, dynamics.pressure, atol=1e-7 * peak)
    np.testing.assert_allclose(same.tangential.traction, dynamics.tangential.traction, atol=1e-7 * peak)
    np.testing.assert_allclose(same.tangential.displacement, dynamics.tangential.displacement, atol=1e-7 * most)


@pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")
def test_nodes_that_stick_in_one_round_and_are_pulled_off_in_the_next_come_to_rest():
    """Of a map by Newton's method."""
    steep = {"method": "psd", "hurst": 0.4169370501475905, "rms_gradient": 0.08662045240807235}
    file = scene(2, 1, np.inf, loading={"reduced_pressure": 0.04666773428580432}, residual=1e-8)
    file["scene"]["body"] = {"poissons_ratio": 0.3607014095476777, "roughness": steep}
    found = gfmd_numba.solve(file | {"seed": 667889})
    assert int(found["status"]) == 0
    assert abs(found["tangential_traction"]).max() > 0.1 * found["pressure"].max()


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")
def test_dynamics_that_anchor_a_node_at_other_times_in_each_round_come_to_rest():
    rough = {"method": "psd", "hurst": 0.9778354607340756, "rms_gradient": 0.040583234000964925}
    loading = {"reduced_pressure": 0.21221496922279026}
    file = scene(1, 2, 1.0760107044645624, loading=loading, solver="verlet", residual=1e-8)
    body = {"poissons_ratio": -0.04296479698162137, "aspect_ratio": 0.7626582124716615, "roughness": rough}
    file["scene"]["body"] = body
    eps = {"eps_c": 1 / 4, "eps_f": 1 / 32, "eps_t": 1 / 2}
    found = gfmd_numba.solve(file | {"seed": 629286, "discretisation": eps})
    assert int(found["status"]) == 0
    assert abs(found["tangential_traction"]).max() > 0.1 * found["pressure"].max()


def test_nodes_that_were_carried_slip_from_where_they_did_and_open_ones_touch_down_where_they_are():
    punch = np.zeros((1, 3))
    touching = np.array([[True, True, False]])
    tangential = Tangential(np.array([[[3.0, 4.0, 5.0]]]), np.zeros((1, 1, 3)), np.array([[[0.0, 1.0, 0.0]]]), 0.5)
    rest = np.zeros(1)
    found = Equilibrium(np.full((1, 3), -1.0), 1.0 * touching, touching, tangential, rest, rest, rest, rest, rest, rest)
    start = solution.continued(found, punch, np.array([[[0.1, 0.2, 0.3]]]))
    np.testing.assert_array_equal(start.displacement, [[0.0, 0.0, -1.0]])
    np.testing.assert_allclose(start.tangential[0], [[2.9, 3.8, 4.7]])
    np.testing.assert_allclose(start.anchor[0], [[2.9, 2.8, 4.7]])
