"""What a scene reduces to: a slab counts as a half-space only where that changes less than asked for."""

import mpmath
import numpy as np
import pytest

from gfmd_numba.contact.evaluation import contact_area_fraction
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.reduction import reduce
from gfmd_numba.contact.rough_surfaces import FacingSurfaces
from gfmd_numba.contact.solution import solve
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.scene import Numerics, Scene
from gfmd_numba.solvers.table import Options

SURFACE = RandomSurface(SelfAffineWaves(0.8, 2, 32), 128, 0)


def exact_stiffening(nu, aspect_ratio):
    """Relative excess of the layer's stiffness over the half-space's for the longest wave, by mpmath."""
    with mpmath.workdps(80):
        kappa, x = 3 - 4 * mpmath.mpf(nu), 4 * mpmath.pi * aspect_ratio
        ratio = (2 * kappa * mpmath.cosh(x) + 1 + kappa**2 + x**2) / (2 * kappa * mpmath.sinh(x) - 2 * x)
        return float(ratio - 1)


def reduced(nu, aspect_ratio, effects, interface=None):
    scene = {
        "body": {"poissons_ratio": nu, "aspect_ratio": float(aspect_ratio)},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": interface or {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.01},
    }
    return reduce(Scene.model_validate(scene), FacingSurfaces(SURFACE, 0.01), Numerics(effects=effects))


@pytest.mark.parametrize("nu", [-0.5, 0.2, 0.33, 0.5])
@pytest.mark.parametrize("aspect_ratio", [0.01, 0.1, 1, 1.2, 1.5, 2, 2.5, 3, 3.5, 4, 6])
@pytest.mark.parametrize("effects", ["exact", 1e-4, 1e-3])
def test_a_slab_is_dropped_below_the_tolerance_only(nu, aspect_ratio, effects):
    effect = exact_stiffening(nu, aspect_ratio)
    assert ElasticBody(nu, aspect_ratio).deviation() == pytest.approx(effect, rel=2e-3, abs=0.0)
    problem, found = reduced(nu, aspect_ratio, effects)
    dropped = effect <= (np.finfo(float).eps / 2 if effects == "exact" else effects)
    assert (problem.body.aspect_ratio is None) == dropped
    assert any(e.state == "dropped" and e.name.startswith("slab") for e in found) == dropped


def test_with_adhesion_nothing_that_matters_is_dropped():
    """A jump into contact may hang on any small difference."""
    law = {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-6, "range": 0.1}}
    assert reduced(0.33, 1.5, 1e-3)[0].body.aspect_ratio is None
    assert reduced(0.33, 1.5, 1e-3, law)[0].body.aspect_ratio == 1.5


@pytest.mark.parametrize("aspect_ratio", [0.3, 1.0])
def test_dropping_a_slab_changes_the_mean_area_by_less_than_its_stiffening(aspect_ratio):
    surface = RandomSurface(SelfAffineWaves(0.8, 1, 64), 512, 3)
    numerics = Options("conjugate_gradients")
    areas = [
        contact_area_fraction(solve(Problem(surface, body, Interactions(True), 0.3, None, numerics), range(40)))
        for body in (ElasticBody(None, None), ElasticBody(0.33, aspect_ratio))
    ]
    change = areas[1] / areas[0] - 1.0
    assert abs(change.mean()) < ElasticBody(0.33, aspect_ratio).deviation()
    # it is no null experiment
    assert aspect_ratio == 1.0 or change.mean() < -0.03 * ElasticBody(0.33, aspect_ratio).deviation()
