"""Bodies that flow inside: conditions, first yield, unloading, increments and sublayers."""

import numpy as np
import pytest
from plastic_flow import elements, first_yield, parabola, pressed, random_scene, violations

from gfmd_numba.contact import evaluation, plastic_measures
from gfmd_numba.contact.plastic_flow import Mixing, PlasticState, plastic_state, stresses
from gfmd_numba.contact.state import relative_difference
from gfmd_numba.elasticity.eigenstrain import Sublayers
from gfmd_numba.elasticity.plastic_sublayers import PlasticSublayers
from gfmd_numba.kernels import Hardening

PRESSURE = 0.04  # Hertz's p0 of a cylinder of radius 1 whose contact is 0.16 wide
LOAD = 0.5 * np.pi * 0.08 * PRESSURE


def cylinder(loads, increments=1, ratio=2.5, hardening=0.02, nodes=64):
    plasticity = PlasticSublayers(Hardening(PRESSURE / ratio, hardening), None, 12, increments)
    return pressed(parabola(nodes, 1), [LOAD * each for each in loads], plasticity)


@pytest.mark.parametrize("seed", range(1, 4))
def test_random_bodies_hold_yield_condition_flow_rule_contact_and_balance(seed):
    heights, loads, plasticity, nu = random_scene(np.random.default_rng(seed))
    found = violations(pressed(heights, loads, plasticity, nu), heights, loads, plasticity)
    assert found["status"] == 0.0
    assert found["yield"] < 1e-5
    assert found["flow rule"] < 3e-5
    assert found["contact"] < 1e-7
    assert found["balance"] < 1e-7


def test_without_flow_the_contact_is_elastic():
    flows, elastic = cylinder([1.0], ratio=1.5)[0], cylinder([1.0], ratio=1e-3)[0]
    assert plastic_measures.plastic_volume(flows) == 0.0
    np.testing.assert_array_equal(flows.equilibrium.pressure, elastic.equilibrium.pressure)


def test_unloading_is_elastic_and_leaves_a_dent_and_compression():
    first, off, again = cylinder([1.0, 1e-4, 1.0])
    flow, rest = plastic_state(first), plastic_state(off)
    np.testing.assert_array_equal(flow.strain, rest.strain)
    np.testing.assert_allclose(again.equilibrium.pressure, first.equilibrium.pressure, atol=1e-6 * PRESSURE)
    middle = 32
    assert rest.residual_displacement[0].argmin() == middle
    assert rest.residual_displacement[0, middle] < -2.0 * rest.residual_displacement.max() < 0.0
    _, along = stresses(off)
    most = rest.equivalent[:, 0, middle].argmax()
    assert along[most, 0, middle] < -0.1 * PRESSURE / 2.5


@pytest.mark.long
def test_errors_fall_with_the_increments_and_are_told():
    exact = cylinder([1.0], 32)[0].equilibrium.pressure
    found = [cylinder([1.0], n)[0] for n in (4, 8)]
    errors = [abs(each.equilibrium.pressure - exact).sum() / abs(exact).sum() for each in found]
    assert errors[0] > 1.4 * errors[1]
    for each, error in zip(found, errors, strict=True):
        assert plastic_state(each).error > 0.8 * error
    assert np.isnan(plastic_state(cylinder([1.0], 2)[0]).error)


def test_the_error_told_knows_no_unit():
    coarse, fine = np.array([1.0, 2.0, 0.0]), np.array([1.0, 2.5, 0.5])
    for unit in (1e-9, 1.0, 1e9):
        assert relative_difference(unit * coarse, unit * fine) == pytest.approx(0.25, rel=1e-14)
    assert relative_difference(coarse, fine, 8.0) == 0.125
    assert relative_difference(0.0 * coarse, 0.0 * fine) == 0.0


def test_more_load_flows_deeper_than_the_first_step_of_a_path_alone_would_ask_for():
    first, last = cylinder([0.5, 1.0])
    flow = plastic_state(last)
    assert flow.equivalent[-1].max() == 0.0
    assert plastic_measures.plastic_volume(last) > plastic_measures.plastic_volume(first) > 0.0


def test_sublayers_fill_the_depth_and_are_fine_below_the_surface():
    plasticity = PlasticSublayers(Hardening(1.0), None, 16, 1)
    for depth in (0.1, 0.7):
        found = plasticity.thicknesses(depth, 64)
        assert found.sum() == pytest.approx(depth, rel=1e-14)
        assert found[0] <= 1.0 / 64 + 1e-12
        assert (np.diff(found) >= -1e-15).all()


def test_mixing_reaches_the_fixed_point_of_a_map_that_turns():
    rng = np.random.default_rng(1)
    body = Sublayers((1, 4), np.array([0.1, 0.2]), 0.3)
    start = PlasticState.untouched(body, (1, 4))
    turn, _ = np.linalg.qr(rng.normal(size=(24, 24)))
    weight = np.sqrt(np.broadcast_to(body.waves.thickness[:, np.newaxis], (3, 2, 4))).ravel()
    matrix, goal = 0.95 * turn * weight / weight[:, np.newaxis], rng.normal(size=24)
    strain, mixing = start.strain, Mixing(start)
    for _ in range(200):
        returned = (goal + matrix @ (strain.ravel() - goal)).reshape(strain.shape)
        strain = mixing.next(strain, returned)
    np.testing.assert_allclose(strain.ravel(), goal, atol=1e-3)


def test_first_yield_is_where_johnson_has_it(capsys):
    first_yield(("cylinder",))
    assert float(capsys.readouterr().out.split()[5]) == pytest.approx(1.79, rel=5e-3)


@pytest.mark.long
def test_first_yield_of_a_ball_is_where_johnson_has_it(capsys):
    first_yield(("ball",))
    assert float(capsys.readouterr().out.split()[5]) == pytest.approx(1.60, rel=1e-2)


@pytest.mark.long
def test_a_sinusoid_flows_as_finite_elements_do(capsys):
    elements(((32, 24),), (0.0,), ())
    told = capsys.readouterr().out
    for name in ("peak pressure", "from the middle", "largest plastic strain"):
        assert abs(float(told.split(f"{name} ")[1].split("%")[0])) < 1.0


def test_edges_above_what_has_flowed_are_where_the_last_nodes_put_them():
    """Pressure ends at a finite value there: nodes are counted right in the mean, and each edge is uncertain."""
    flows, elastic = cylinder([0.45, 0.9], ratio=10.0, hardening=0.0)[-1], cylinder([0.9], ratio=1.5)[0]
    assert evaluation.contact_area_fraction(flows) == evaluation.contact_area_fraction_counted(flows)
    assert evaluation.contact_area_fraction(elastic) < evaluation.contact_area_fraction_counted(elastic)
    for contact in (flows, elastic):
        np.testing.assert_allclose(evaluation.contact_area_fraction_error(contact), np.sqrt(2.0 / 12.0) / 64)
    assert evaluation.kappa_edges_error(flows) > 0.0
