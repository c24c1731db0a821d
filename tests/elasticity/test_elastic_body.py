"""One elastic body: what it gives fits together, and a half-space is the limit of slabs."""

import numpy as np
import pytest

from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.fourier import grid

BODIES = [ElasticBody(nu, a) for nu in (0.0, 0.33, 0.49) for a in (None, 0.1, 2.0)]


@pytest.mark.parametrize("body", BODIES)
def test_compliance_is_the_inverse_of_the_coupled_stiffness(body):
    k, s = body.response((33,)), body.compliance(grid.wavenumbers(33))
    waves = slice(0 if body.aspect_ratio else 1, None)  # nothing holds the mean of a half-space
    determinant = k.elements[0][waves] * k.normal[waves] - k.elements[1][waves] ** 2
    for found, element in ((s.s11, k.normal), (s.s13, k.elements[1]), (s.s33, k.elements[0])):
        np.testing.assert_allclose(found[waves], element[waves] / determinant, rtol=1e-9)


@pytest.mark.parametrize("body", BODIES)
def test_the_coupled_stiffness_condenses_to_that_of_the_normal_displacement(body):
    np.testing.assert_allclose(
        body.response((33,)).condensed().normal, body.condensed_stiffness(grid.magnitudes((33,))), rtol=1e-12
    )


@pytest.mark.parametrize("nu", [0.0, 0.33, 0.5])
def test_a_deep_slab_is_a_half_space_but_for_its_mean(nu):
    deep, limit = ElasticBody(nu, 20.0), ElasticBody(nu, None)
    shape = (6, 8)
    np.testing.assert_allclose(
        deep.condensed_stiffness(grid.magnitudes(shape)).flat[1:],
        limit.condensed_stiffness(grid.magnitudes(shape)).flat[1:],
        rtol=1e-14,
    )
    assert limit.uniform_stiffness() == (0.0, 0.0)
    assert deep.uniform_stiffness()[0] == pytest.approx((1 - nu) / 40)


def test_a_frictionless_half_space_needs_no_poissons_ratio():
    body = ElasticBody(None, None)
    np.testing.assert_array_equal(body.condensed_stiffness(grid.magnitudes((8,))), grid.wavenumbers(8) / 2)
    with pytest.raises(ValueError, match="Poisson's ratio"):
        body.response((8,))


def test_two_equal_bodies_in_series_are_as_stiff_as_one_in_the_modulus_of_both():
    own = ElasticBody(0.3, 0.2).condensed_stiffness(grid.magnitudes((16,)))
    np.testing.assert_allclose(stiffness.in_series(own, own, 0.5), own)
    soft = stiffness.in_series(own, 2.0 * own, 0.25)
    np.testing.assert_allclose(1.0 / soft, 0.75 / own + 0.25 / (2.0 * own))


@pytest.mark.parametrize(("heights", "worst"), [((0.02, 0.05), 2), ((2e-3, 1e-3), 30)])
def test_the_deviation_of_layers_is_that_of_their_worst_wave(heights, worst):
    """Which is a wave of some heights of the layers, however short these make it."""
    body = ElasticBody.layered(heights, (Material(1.0, 0.3), Material(10.0, 0.3)), Material(0.9, 0.3))
    q = 2.0 * np.pi * np.arange(1.0, 400.0)
    each = abs(body.condensed_stiffness(q) / (0.5 * q) - 1.0)
    assert each.argmax() + 1 >= worst
    assert body.deviation() == pytest.approx(each.max(), rel=1e-2)
