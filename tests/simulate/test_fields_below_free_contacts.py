"""Fields in the body below contacts without a period, from a scene to a picture."""

import numpy as np
import pytest
import yaml

import gfmd_numba
from support.command_line import gfmd

pytestmark = pytest.mark.usefixtures("undrawn")

RADIUS = 4.0


def pressed(a, dimension, points, nu=0.3, **more):
    """Ball or cylinder that touches over a half-width a of a window of 1 m, E* = 1 Pa; and the peak pressure."""
    load = 4.0 * a**3 / (3.0 * RADIUS) if dimension == 2 else np.pi * a**2 / (4.0 * RADIUS)
    scene = {
        "dimension": dimension,
        "periodic": False,
        "body": {"youngs_modulus": 1.0 - nu**2, "poissons_ratio": nu},
        "form": {"radius": RADIUS, "points": points},
        "interface": {"hard_wall": {}},
        "loading": {"line_load" if dimension == 1 else "force": load},
        "length": 1.0,
    }
    return scene | more, 2.0 * a / (np.pi * RADIUS) if dimension == 2 else 0.5 * a / RADIUS


@pytest.mark.parametrize(
    ("dimension", "points", "largest", "at"),
    [pytest.param(2, 64, 0.310, 0.48, marks=pytest.mark.long), (1, 256, 0.300, 0.786)],
)
def test_shear_is_largest_below_the_surface_as_hertz_has_it(dimension, points, largest, at):
    """Johnson, Contact Mechanics, 3.4 and 4.2: half the difference of the principal stresses on the axis."""
    a = 0.2
    scene, peak = pressed(a, dimension, points)
    depth = np.linspace(0.4, 0.88, 13)
    inside = gfmd_numba.body_fields(gfmd_numba.solve(scene), -a * depth)
    axis = inside.isel(x=points // 2)
    shear = 0.5 * abs(axis["stress_3"] - axis["stress_1"]).values / peak
    assert shear.max() == pytest.approx(largest, abs=5e-4)
    assert depth[shear.argmax()] == pytest.approx(at, abs=0.02)
    if dimension == 2:
        np.testing.assert_allclose(inside["peak_von_mises"] / peak, 2.0 * shear, rtol=3e-3)


@pytest.mark.long
def test_at_the_surface_they_are_what_was_solved():
    """Of a cylinder dragged under friction, and of a ball: tractions, and displacements from the same reference."""
    friction = {"interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}}}
    cylinder, peak = pressed(0.2, 1, 256, **friction)
    contact = gfmd_numba.solve({"scene": cylinder, "path": [{"sliding": 0.002}]})
    found = gfmd_numba.body_fields(contact, [0.0]).isel(z=0)
    assert found.sizes["step"] == 2
    np.testing.assert_allclose(found["stress_3"], -contact["pressure"], atol=1e-6 * peak)
    np.testing.assert_allclose(found["stress_5"], contact["tangential_traction"], atol=1e-6 * peak)
    depth = abs(contact["displacement"]).max().item()
    np.testing.assert_allclose(found["displacement_3"], contact["displacement"], atol=2e-4 * depth)
    np.testing.assert_allclose(found["displacement_1"], contact["tangential_displacement"], atol=2e-4 * depth)
    ball, peak = pressed(0.2, 2, 64)
    contact = gfmd_numba.solve(ball)
    found = gfmd_numba.body_fields(contact, planes=[0.0]).isel(z=0)
    np.testing.assert_allclose(found["stress_3"], -contact["pressure"], atol=1e-6 * peak)
    deepest = abs(contact["displacement"]).max().item()
    np.testing.assert_allclose(found["displacement_3"], contact["displacement"], atol=1e-6 * deepest)


@pytest.mark.long
def test_lengths_and_moduli_scale_what_is_inside():
    scene, _ = pressed(0.2, 2, 32)
    one = gfmd_numba.body_fields(gfmd_numba.solve(scene), [-0.1], x=0.5)
    small = scene | {"length": 1e-3, "form": {"radius": 1e-3 * RADIUS, "points": 32}}
    small |= {"body": {"youngs_modulus": 1e9 * 0.91, "poissons_ratio": 0.3}}
    small |= {"loading": {"force": scene["loading"]["force"] * 1e3}}
    other = gfmd_numba.body_fields(gfmd_numba.solve(small), [-1e-4], x=0.5e-3)
    np.testing.assert_allclose(other["stress_3"], 1e9 * one["stress_3"], rtol=1e-6)
    np.testing.assert_allclose(other["displacement_3"], 1e-3 * one["displacement_3"], rtol=1e-6)
    at_end = gfmd_numba.body_fields(gfmd_numba.solve(small), [-1e-4], x=1e-3)
    assert at_end["x"].item() == pytest.approx(1e-3 * 31 / 32)


@pytest.mark.long
def test_the_command_draws_them(tmp_path):
    scene, _ = pressed(0.2, 1, 32)
    (tmp_path / "ball.yaml").write_text(yaml.safe_dump(scene))
    gfmd("solve", tmp_path / "ball.yaml", "-o", tmp_path / "ball.nc")
    gfmd("fields", tmp_path / "ball.nc", "-o", tmp_path / "inside.nc")
    assert (tmp_path / "inside.png").exists()
