"""The Prony series of a generalised Maxwell body, against quadrature."""

import numpy as np
import pytest
from scipy.integrate import quad

from gfmd_numba.elasticity.prony import PronySeries
from support.viscoelastic import THREE, modulus

SERIES = PronySeries(*zip(*THREE, strict=True))


def test_its_modulus_falls_from_the_glassy_one_to_the_relaxed_one():
    for time in (0.0, 0.03, 1.0, 20.0):
        assert SERIES.modulus(time) == pytest.approx(modulus(THREE, time), rel=1e-14)
    assert SERIES.modulus(0.0) == SERIES.factor(0.0) == 4.5
    assert SERIES.modulus(1e4) == pytest.approx(1.0)
    assert SERIES.factor(1e9) == pytest.approx(1.0, abs=1e-7)


@pytest.mark.parametrize("duration", [0.0, 1e-9, 1e-4, 4.9e-4, 5.1e-4, 0.03, 1.0, 40.0])
def test_springs_and_dashpots_of_a_step_are_those_of_quadrature(duration):
    """The stretch of a spring is w exp(-s) + r (1 - exp(-s)), s the time over the relaxation time, r = du / x."""
    kept, joined = SERIES.shares(duration)
    losses = SERIES.losses(duration)
    for i, time in enumerate(SERIES.times):
        x = duration / time
        assert kept[i] == pytest.approx(np.exp(-x), rel=1e-14)
        if x == 0.0:
            assert joined[i] == 1.0
            assert not losses[:, i].any()
            continue
        old, new = (lambda s: np.exp(-s)), (lambda s, x=x: -np.expm1(-s) / x)
        assert joined[i] == pytest.approx(new(x), rel=1e-13)
        pairs = ((old, old), (old, new), (new, new))
        expected = [quad(lambda s, f=f, g=g: f(s) * g(s), 0.0, x, epsabs=0.0, epsrel=1e-11)[0] for f, g in pairs]
        np.testing.assert_allclose(losses[:, i], expected, rtol=1e-8)
