"""Stacks of layers: limits, equal layers, and an independent reference in many digits, from 1e-6 to 1e6 in q h."""

from itertools import product

import numpy as np
import pytest
import slab_stiffness
from inner_fields import NAMES, inside

from gfmd_numba.elasticity import fields, moduli
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.layers import Stack
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.dynamics import verlet
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start
from gfmd_numba.solvers.table import Options
from gfmd_numba.theory.damping import critical_damping, stability_limit
from support.cases import some_of
from support.layered_reference import compliance, surface_and_inside

NUS = (-0.5, 0.0, 0.33, 0.4999, 0.5)
Q = np.geomspace(1e-6, 1e6, 121)
# thin and thick, on both sides of the change of method at q h = 1, and where all below has faded
FEW = np.array([1e-6, 0.03, 0.99, 1.01, 3.0, 45.0, 1e6])


def plane(modulus, nu):
    return modulus / (1 - nu**2)


def stack_of(layers, base):
    """Stack of layers (height, Young's modulus, nu), as it is: equal neighbours are not merged."""
    unit = plane(*layers[0][1:])
    materials = tuple(Material(plane(*layer[1:]) / unit, layer[2]) for layer in layers)
    rest = None if base is None else Material(plane(*base) / unit, base[1])
    return Stack(tuple(layer[0] for layer in layers), materials, rest)


def body_of(layers, base):
    stack = stack_of(layers, base)
    return ElasticBody(None, stack.height if base is None else None, stack)


def largest_error(layers, base, q=FEW):
    """Of S11, S13 (over the mean of the others) and S33, relative to the reference."""
    found = np.array(stack_of(layers, base).compliance_times_q(q)) / plane(*layers[0][1:])
    digits = [60 + max(0, int(-6 * np.log10(each))) * (len(layers) + 1) // 2 for each in q]
    true = np.array(
        [[float(each) for each in compliance(layers, base, k, d)] for k, d in zip(q, digits, strict=True)]
    ).T
    size = np.array([true[0], np.sqrt(true[0] * true[2]), true[2]])
    return (abs(found * [[1], [-1], [1]] - true) / size).max()


@pytest.mark.parametrize("nu", NUS)
@pytest.mark.parametrize("share", [0.5, 0.9, 1e-3])
def test_two_equal_layers_are_one_slab(nu, share):
    two = Stack((share, 1 - share), (Material(1.0, nu),) * 2, None)
    s11, _, s33 = two.compliance_times_q(Q)
    np.testing.assert_allclose(0.5 * slab_stiffness.slab_factor(Q, nu), 1 / s33, rtol=1e-13)
    np.testing.assert_allclose(slab_stiffness.condensed_elements(Q, nu), (1 / s11, 1 / s33), rtol=1e-13)


@pytest.mark.parametrize("nu", NUS)
def test_layers_on_a_half_space_of_the_same_material_are_a_half_space(nu):
    same = Material(1.0, nu)
    s11, s13, s33 = Stack((0.1, 1.0, 0.01), (same,) * 3, same).compliance_times_q(Q)
    np.testing.assert_allclose((s11, s33), 2.0, rtol=1e-14)
    np.testing.assert_allclose(s13, (1 - 2 * nu) / (1 - nu), rtol=0, atol=1e-14)


PAIRS = list(product((0.0, 0.33, 0.5), repeat=2))
CONTRASTS = [1e-4, 1e-2, 0.5, 30.0, 1e4]


EVERY = [(*pair, contrast) for contrast in CONTRASTS for pair in PAIRS]


@pytest.mark.parametrize(
    ("nu", "nu_below", "contrast"),
    [pytest.param(*each, marks=pytest.mark.long if i % 4 else ()) for i, each in enumerate(EVERY)],
)
def test_the_compliance_is_that_of_the_reference(nu, nu_below, contrast):
    """Each contrast on each base, and each pair of ratios on each, but not all of all: the reference takes its time."""
    layers = [(1.0, 70.0, nu), (0.6, 70.0 * contrast, nu_below)]
    bases = (None, (70.0 * contrast, nu_below), (70.0, 0.3))
    which = CONTRASTS.index(contrast) + PAIRS.index((nu, nu_below)) + PAIRS.index((nu, nu_below)) // 3
    assert largest_error(layers, bases[which % 3]) < 1e-13


@pytest.mark.long
def test_sandwiches_of_unequal_layers_are_those_of_the_reference():
    layers = [(0.05, 1.0, 0.25), (1.0, 1e-4, 0.5), (0.3, 1e3, 0.0), (2.0, 1.0, 0.4999)]
    assert largest_error(layers, None) < 2e-12  # seven orders of magnitude between neighbours
    assert largest_error(layers, (1e-2, 0.45)) < 2e-12


@pytest.mark.parametrize("contrast", [1e-8, 1e8])
def test_the_largest_contrast_that_scenes_allow_costs_few_digits(contrast):
    q = np.geomspace(1e-3, 10, 7)
    assert largest_error([(1.0, 1.0, 0.3), (1.5, contrast, 0.5)], None, q) < 1e-11
    assert largest_error([(1.0, 1.0, 0.5)], (contrast, 0.2), q) < 1e-11


def test_short_waves_feel_the_topmost_layer_and_long_ones_the_base():
    body = body_of([(0.1, 1.0, 0.3), (0.2, 50.0, 0.4)], (20.0, 0.25))
    k = body.condensed_stiffness(np.array([0.0, 1e-7, 1e4]))
    base = plane(20.0, 0.25) / plane(1.0, 0.3)
    np.testing.assert_allclose(k, [0.0, 0.5e-7 * base, 0.5e4], rtol=1e-5)
    np.testing.assert_allclose(k[2], 0.5e4, rtol=1e-15)


def test_long_waves_on_a_rigid_base_compress_the_layers_one_by_one():
    layers = [(0.1, 1.0, 0.3), (0.2, 50.0, 0.4), (0.05, 0.1, 0.0)]
    body = body_of(layers, None)
    unit = plane(1.0, 0.3)
    softness = sum(h * unit / plane(e, nu) / moduli.c11(nu) for h, e, nu in layers)
    k = body.condensed_stiffness(np.array([0.0, 1e-6]))
    np.testing.assert_allclose(k, 1 / softness, rtol=1e-9)
    assert body.uniform_stiffness()[1] == k[0]


def mean_stiffness(body):
    return body.condensed_stiffness(np.zeros(1))[0]


def test_only_a_stack_without_any_compressible_layer_has_a_rigid_mean():
    assert np.isinf(mean_stiffness(body_of([(0.1, 1.0, 0.5), (0.2, 50.0, 0.5)], None)))
    assert np.isfinite(mean_stiffness(body_of([(0.1, 1.0, 0.5), (0.2, 50.0, 0.49)], None)))
    assert np.isfinite(mean_stiffness(body_of([(0.1, 1.0, 0.5)], (2.0, 0.5))))


def test_the_stiffness_of_a_stack_over_q_has_neither_to_rise_nor_to_fall():
    q = 2 * np.pi * np.arange(1, 500)
    soft_on_hard = body_of([(0.01, 1.0, 0.5)], (1e3, 0.2)).condensed_stiffness(q)
    assert (np.diff(soft_on_hard) < 0).any()
    assert (np.diff(soft_on_hard) > 0).any()
    assert soft_on_hard.argmin() > 5  # no solver may take the first wave for the softest


def test_step_and_damping_are_those_of_the_softest_and_the_stiffest_of_all_waves():
    body = body_of([(0.01, 1.0, 0.5)], (1e3, 0.2))
    k = body.condensed_stiffness(grid.wavenumbers(256))
    punch = np.zeros((1, 256))
    batch = Batch(punch, SpectralResponse.of_normal(k), np.ones(1), HARD_WALL, Start.at_rest(punch))
    softest, stiffest = k[1:].min(), k.max()
    assert softest < 0.5 * k[1]
    options = Options("verlet")
    dt = options.number("time_step") * stability_limit(softest, stiffest, options.number("damping"))
    integrator = verlet(batch, options)._integrator
    assert integrator._push == pytest.approx(dt**2)
    assert integrator._memory == pytest.approx(1 - options.number("damping") * critical_damping(softest, dt) * dt**2)


def test_equal_neighbours_are_merged():
    a, b = Material(1.0, 0.3), Material(2.0, 0.4)
    assert ElasticBody.layered((0.1, 0.2), (a, a), None) == ElasticBody(0.3, 0.3)  # to the last digit
    assert ElasticBody.layered((0.1, 0.2), (a, a), a) == ElasticBody(0.3, None)
    merged = ElasticBody.layered((0.1, 0.2, 0.3, 0.4), (a, b, b, a), a)
    assert merged == ElasticBody(None, None, Stack((0.1, 0.5), (a, b), a))
    assert ElasticBody.layered((0.1,), (a,), b).aspect_ratio is None


STACKS = [
    ([(0.1, 1.0, 0.3), (0.2, 50.0, 0.45)], None),
    ([(0.1, 1.0, 0.5), (0.05, 1e-2, 0.0)], (1e3, 0.5)),
    ([(0.002, 400.0, 0.2), (3.0, 1.0, 0.49)], (70.0, 0.33)),
]


@pytest.mark.parametrize(("layers", "base"), STACKS)
def test_compliance_and_coupled_stiffness_of_a_stack_are_inverse_and_condense(layers, base):
    body = body_of(layers, base)
    k, s = body.response((33,)), body.compliance(grid.wavenumbers(33))
    waves = slice(0 if base is None else 1, None)
    determinant = k.elements[0][waves] * k.normal[waves] - k.elements[1][waves] ** 2
    for found, element in ((s.s11, k.normal), (s.s13, k.elements[1]), (s.s33, k.elements[0])):
        np.testing.assert_allclose(found[waves], element[waves] / determinant, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(k.condensed().normal, body.condensed_stiffness(grid.wavenumbers(33)), rtol=1e-12)


def test_stiffness_of_maps_is_that_of_profiles_at_the_length_of_the_wave_vector():
    body = body_of([(0.1, 1.0, 0.3), (0.2, 50.0, 0.45)], None)
    q = grid.magnitudes((6, 8))
    found = body.condensed_stiffness(q)
    np.testing.assert_array_equal(found.ravel(), body.condensed_stiffness(q.ravel()))
    np.testing.assert_allclose(found[0], body.condensed_stiffness(grid.wavenumbers(8)), rtol=1e-14)


def amplitudes_inside(body, layers, base, nx, n, depth):
    """All fields at a depth under tractions cos(qx) along x and 0.7 sin(qx) out of the body, found and true."""
    q, x = 2 * np.pi * n, np.arange(nx) / nx
    surface = fields.surface_under_tractions(np.stack((np.cos(q * x), 0.7 * np.sin(q * x))), body)
    cosine = {"u1", "strain5", "stress5"}
    waves = {name: grid.coefficients(each[0]) for name, each in vars(inside(surface, np.array([-depth]), body)).items()}
    found = {name: 2 * (each[n].real if name in cosine else -each[n].imag) for name, each in waves.items()}
    unit, left, (modulus, nu) = plane(*layers[0][1:]), depth, (1.0, 0.5) if base is None else base
    for height, own_modulus, own_nu in layers:
        if left <= height * (1 + 1e-9):
            modulus, nu = own_modulus, own_nu
            break
        left -= height
    true = surface_and_inside(layers, base, q, (unit, 0.7 * unit), [depth], digits=80)[1]
    u1, u3, t1, t3, s1 = (float(each) for each in (true.u1, true.u3, true.t1, true.t3, true.s1))
    return found, {
        "u1": u1,
        "u3": u3,
        "strain1": -q * u1,
        "strain3": ((1 - nu**2) * t3 - nu * (1 + nu) * s1) / modulus,
        "strain5": 2 * (1 + nu) * t1 / modulus,
        "stress1": s1 / unit,
        "stress2": nu * (s1 + t3) / unit,
        "stress3": t3 / unit,
        "stress5": t1 / unit,
    }


@pytest.mark.parametrize(("layers", "base"), STACKS)
@pytest.mark.parametrize("n", some_of([1, 2, 7], 1))
def test_fields_inside_are_those_of_the_reference(layers, base, n):
    body, total = body_of(layers, base), sum(layer[0] for layer in layers)
    first = layers[0][0]
    depths = [0.0, 0.3 * first, first, 1.0001 * first, 0.5 * (first + total), total]
    depths += [] if base is None else [1.001 * total, total + 0.3]
    _, above = amplitudes_inside(body, layers, base, 32, n, 0.0)
    for depth in depths:
        found, true = amplitudes_inside(body, layers, base, 32, n, depth)
        for kinds in (("u1", "u3"), ("strain1", "strain3", "strain5"), ("stress1", "stress2", "stress3", "stress5")):
            here, surface = (max(abs(each[kind]) for kind in kinds) for each in (true, above))
            for kind in kinds:
                assert found[kind] == pytest.approx(true[kind], abs=1e-11 * here + 1e-15 * surface), (depth, kind)


@pytest.mark.parametrize(("layers", "base"), STACKS)
def test_displacements_and_tractions_are_continuous_at_interfaces(layers, base):
    body, nx = body_of(layers, base), 64
    rng = np.random.default_rng(3)
    tractions = rng.standard_normal((2, nx))
    if base is not None:
        tractions -= tractions.mean(axis=1, keepdims=True)
    under = fields.surface_under_tractions(tractions, body)
    depth = layers[0][0]
    z = -depth * np.array([1.0, 1.0 + 1e-9])
    found = inside(under, z, body)
    for name in ("u1", "u3", "stress3", "stress5", "strain1"):
        above, below = getattr(found, name)
        np.testing.assert_allclose(below, above, atol=1e-6 * abs(above).max(), err_msg=name)
    assert abs(np.diff(found.stress1, axis=0)).max() > 0.1 * abs(found.stress1).max()
    if base is None:
        lowest = inside(under, np.array([body.base_z]), body)
        assert abs(lowest.u1).max() < 1e-14 * abs(found.u1).max()
        assert abs(lowest.u3).max() < 1e-14 * abs(found.u3).max()


def test_fields_of_two_equal_layers_are_those_of_the_slab():
    nx, slab = 64, ElasticBody(0.3, 0.3)
    two = ElasticBody(None, 0.3, Stack((0.1, 0.2), (Material(1.0, 0.3),) * 2, None))
    tractions = np.random.default_rng(3).standard_normal((2, nx))
    z = -0.3 * np.linspace(0, 1, 13)
    one, other = (inside(fields.surface_under_tractions(tractions, body), z, body) for body in (slab, two))
    for name in vars(one):
        expected = getattr(one, name)
        np.testing.assert_allclose(getattr(other, name), expected, atol=1e-12 * abs(expected).max(), err_msg=name)


@pytest.mark.parametrize("seed", range(0, 60, 2))
def test_no_stack_that_a_scene_allows_ends_in_anything_but_a_positive_stiffness(seed):
    rng = np.random.default_rng(seed)
    count = rng.integers(1, 6)
    heights = 10.0 ** rng.uniform(-12, rng.choice([0, 30]), count)
    nus = rng.choice([-0.999, -0.5, 0.0, 0.3, 0.499999, 0.5], count + 1)
    moduli_ = 10.0 ** rng.uniform(-4, 4, count + 1)
    layers = list(zip(heights, moduli_[:count], nus[:count], strict=True))
    base = None if rng.random() < 0.5 else (moduli_[count], nus[count])
    body = body_of(layers, base)
    q = 2 * np.pi * np.geomspace(1, 2**21, 64)
    s11, s13, s33 = body.stack.compliance_times_q(q)
    assert np.isfinite([s11, s13, s33]).all()
    assert (s11 > 0).all()
    assert (s33 > 0).all()
    assert (s11 * s33 - s13**2 > 0).all()
    surface = fields.surface_under_tractions(np.eye(8)[[0, 3]], body)
    for depth in (0.0, heights[0], float(heights.sum())):
        for _, _, waves in surface.waves(depth, body, NAMES):
            assert np.isfinite(waves).all()
