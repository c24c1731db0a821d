"""What a scene reduces to: a slab counts as a half-space only where double precision cannot tell them apart."""

import mpmath
import numpy as np
import pytest

from gfmd_numba.problem import RandomSurface, reduce, stiffening
from gfmd_numba.scene import Numerics, Scene

SURFACE = RandomSurface(0.8, 2, 32, 128, 0)


def exact_stiffening(nu, aspect_ratio):
    """Relative excess of the layer's stiffness over the half-space's for the longest wave, by mpmath."""
    with mpmath.workdps(80):
        kappa, x = 3 - 4 * mpmath.mpf(nu), 4 * mpmath.pi * aspect_ratio
        ratio = (2 * kappa * mpmath.cosh(x) + 1 + kappa**2 + x**2) / (2 * kappa * mpmath.sinh(x) - 2 * x)
        return float(ratio - 1)


@pytest.mark.parametrize("nu", [-0.5, 0.2, 0.33, 0.5])
@pytest.mark.parametrize("aspect_ratio", [0.01, 0.1, 1, 2, 2.5, 3, 3.5, 4, 6])
def test_a_slab_is_dropped_below_double_precision_only(nu, aspect_ratio):
    scene = {
        "body": {"poissons_ratio": nu, "aspect_ratio": float(aspect_ratio)},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.01},
    }
    effect = exact_stiffening(nu, aspect_ratio)
    assert stiffening(nu, aspect_ratio) == pytest.approx(effect, rel=2e-3)
    problem, effects = reduce(Scene.model_validate(scene), SURFACE, 0.01, Numerics())
    dropped = effect <= np.finfo(float).eps / 2
    assert (problem.body.aspect_ratio is None) == dropped
    assert any(e.state == "dropped" and e.name.startswith("slab") for e in effects) == dropped
