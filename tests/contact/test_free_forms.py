"""Forms without a period: the balls, ellipsoids, cylinders and cones of contact mechanics, and their approach."""

import numpy as np
import pytest

import gfmd_numba
from support.hertz import ellipse


def pressed(form, dimension, load, points=512):
    scene = {
        "dimension": dimension,
        "periodic": False,
        "body": {"youngs_modulus": 1.0, "poissons_ratio": 0.0},
        "form": form | {"points": points},
        "interface": {"hard_wall": {}},
        "loading": {"line_load" if dimension == 1 else "force": load},
        "length": 1.0,
    }
    found = gfmd_numba.solve(scene)
    assert int(found["status"]) == 0
    return found


def test_a_ball_is_that_of_hertz():
    a, radius = 0.25, 5.0
    found = pressed({"radius": radius}, 2, 4.0 * a**3 / (3.0 * radius))
    assert float(found["approach"]) == pytest.approx(a**2 / radius, rel=1e-5)
    assert float(found["peak_pressure"]) == pytest.approx(2.0 * a / (np.pi * radius), rel=1e-5)
    assert float(found["contact_radius"]) == pytest.approx(a, rel=1e-3)


@pytest.mark.parametrize("ratio", [2.0, 5.0])
def test_two_radii_are_the_ellipse_of_hertz(ratio):
    a, peak = 0.25, 0.02
    exact = ellipse(a, ratio, peak)
    found = pressed(exact.form, 2, exact.load)
    assert float(found["approach"]) == pytest.approx(exact.approach, rel=1e-4)
    assert float(found["peak_pressure"]) == pytest.approx(peak, rel=1e-4)
    assert float(found["contact_area_fraction"]) == pytest.approx(np.pi * a**2 / ratio, rel=5e-3)


def test_a_cylinder_is_that_of_hertz():
    b, radius = 0.25, 5.0
    found = pressed({"radius": radius}, 1, 0.25 * np.pi * b**2 / radius)
    assert float(found["peak_pressure"]) == pytest.approx(0.5 * b / radius, rel=1e-4)
    assert float(found["contact_radius"]) == pytest.approx(b, rel=3e-3)


def test_a_cone_is_that_of_sneddon():
    slope, a = 0.02, 0.25
    found = pressed({"slope": slope}, 2, 0.5 * np.pi * a**2 * slope)
    assert float(found["approach"]) == pytest.approx(0.5 * np.pi * a * slope, rel=1e-3)
    assert float(found["contact_radius"]) == pytest.approx(a, rel=1e-3)
