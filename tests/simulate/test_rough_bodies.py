"""Bodies that are rough, or two of them: against mapped roughness, finite elements and each other."""

import numpy as np
import pytest
from finite_elements import Body, graded
from scipy.interpolate import CubicSpline

import gfmd_numba
from gfmd_numba.fourier import grid
from support.rough_bodies import BODY, ROUGH, X, measured, rough, scene


@pytest.mark.parametrize("loading", [{"reduced_pressure": 0.02}, {"displacement": 3e-4}])
@pytest.mark.parametrize("nu", [0.33, 0.5])
def test_two_step_gfmd_is_the_mapped_contact(loading, nu):
    body = BODY | {"poissons_ratio": nu}
    mapped = gfmd_numba.solve(scene(body=body, roughness=ROUGH, loading=loading))
    own = gfmd_numba.solve(scene(order=0, body=body | {"roughness": ROUGH}, loading=loading))
    np.testing.assert_allclose(own.pressure, mapped.pressure, atol=1e-12 * mapped.pressure.max().item())
    np.testing.assert_allclose(own.displacement, mapped.displacement, atol=2e-8 * abs(mapped.displacement).max().item())
    np.testing.assert_allclose(own.gap, mapped.gap, atol=1e-15)


def test_every_order_becomes_the_mapped_contact_as_the_slope_vanishes():
    """At the same reduced pressure the contact differs from the mapped one by the slope times its pressure."""
    differences = []
    for gradient in (1e-2, 1e-3, 1e-4):
        mapped = gfmd_numba.solve(scene(roughness=ROUGH | {"rms_gradient": gradient}))
        own = gfmd_numba.solve(scene(body=rough(rms_gradient=gradient)))
        differences.append(abs(own.displacement - mapped.displacement).max() / abs(mapped.displacement).max())
    np.testing.assert_allclose(np.divide(differences[:-1], differences[1:]), 10.0, rtol=0.2)


def test_fields_of_a_rough_body_bear_its_pressure_on_the_true_surface():
    contact = gfmd_numba.solve(scene(order=3, body=rough()))
    inside = gfmd_numba.body_fields(contact, [0.0, -0.5])
    nx = contact.sizes["x"]
    slope = grid.signal(1j * grid.wavenumbers(nx) * grid.coefficients(contact.body_height.values), nx)
    peak = contact.pressure.max().item()
    shear = inside.stress_5[0] - slope * inside.stress_1[0]
    normal = inside.stress_3[0] - slope * inside.stress_5[0]
    # waves beyond nx / 5 are left to order 0, and the slope brings some of them back
    low = np.arange(nx // 2 + 1) < nx // 5
    for found in (shear.values, (normal + contact.pressure).values):
        assert abs(grid.signal(grid.coefficients(found) * low, nx)).max() < 1e-3 * peak
    np.testing.assert_allclose(inside.formed_3[0], contact.body_height, atol=1e-15)
    assert abs(inside.formed_1[0]).max() < 1e-15
    assert abs(inside.displacement_3[1]).max() < 1e-8 * abs(contact.displacement).max()
    np.testing.assert_allclose(inside.displacement_3[0], contact.displacement, atol=1e-12)
    np.testing.assert_allclose(inside.displacement_1[0], contact.tangential_displacement, atol=1e-12)


@pytest.mark.long
def test_flattened_sinusoid_of_a_scene_is_that_of_finite_elements(tmp_path):
    nx, columns = 1024, 128
    heights = -0.005 * np.cos(2 * np.pi * np.arange(nx) / nx)
    body = {"poissons_ratio": 0.33, "aspect_ratio": 1.0, "roughness": measured(tmp_path, heights)}
    contact = gfmd_numba.solve(scene(body=body, loading={"displacement": 1.65e-3}))

    def stretched(x, z):
        return 0 * x, heights[np.rint(x * nx).astype(int) % nx] * (z + 1.0)

    mesh = Body(columns, graded(1.0, 24, 0.5 / columns), 0.33, stretched)
    solution = mesh.press((heights.max() - heights - 1.65e-3)[::4], contact.pressure.values[::4] > 0)
    tangential, normal = mesh.along_top(solution)
    assert abs(contact.tangential_displacement.values[::4] - tangential).max() < 1e-6
    assert abs(contact.displacement.values[::4] - normal).max() < 2e-6  # the mesh's own error
    # order 0 is expected, and found, to be off by the slope: 4e-6
    lowest = gfmd_numba.solve(scene(order=0, body=body, loading={"displacement": 1.65e-3}))
    off = abs(lowest.tangential_displacement.values[::4] - tangential).max()
    assert 0.5 < off / lowest.next_order < 2.0
    assert contact.next_order < 1e-8


def test_a_rough_punch_on_a_rough_body_meets_the_sum_of_the_heights(tmp_path):
    one, two = 2e-3 * np.cos(2 * np.pi * X), 1e-3 * np.cos(6 * np.pi * X)
    both = gfmd_numba.solve(
        scene(
            order=0,
            body=BODY | {"roughness": measured(tmp_path, one)},
            roughness=measured(tmp_path, two, "p.npy"),
            loading={"displacement": 1e-3},
        )
    )
    mapped = gfmd_numba.solve(scene(roughness=measured(tmp_path, one + two, "s.npy"), loading={"displacement": 1e-3}))
    np.testing.assert_allclose(both.pressure, mapped.pressure, atol=1e-11)


def test_random_punch_and_random_body_are_different_surfaces():
    contact = gfmd_numba.solve(scene(body=rough(), roughness=ROUGH))
    own, punch = contact.body_height, contact.height - contact.body_height
    assert abs(np.corrcoef(own, punch)[0, 1]) < 0.9
    assert contact.rms_gradient == pytest.approx(0.01 * np.sqrt(2), rel=0.3)


@pytest.mark.parametrize("aspect_ratio", [0.3, np.inf])
def test_two_equal_bodies_are_one_of_half_the_modulus(aspect_ratio):
    body = {"youngs_modulus": 2.0, "poissons_ratio": 0.33, "aspect_ratio": aspect_ratio}
    two = gfmd_numba.solve(scene(order=0, body=body | {"roughness": ROUGH}, counter_body=body))
    one = gfmd_numba.solve(scene(body=body | {"youngs_modulus": 1.0}, roughness=ROUGH))
    np.testing.assert_allclose(two.pressure, one.pressure, atol=1e-7 * one.pressure.max().item())
    np.testing.assert_allclose(two.displacement, one.displacement / 2, atol=1e-7 * abs(one.displacement).max().item())
    np.testing.assert_allclose(two.displacement, two.counter_body_displacement, atol=1e-18)
    np.testing.assert_allclose(two.tangential_displacement, two.counter_body_tangential_displacement, atol=1e-18)


@pytest.mark.filterwarnings("ignore:.*both bodies have the same heights")
def test_a_rough_body_against_its_mirror_image_is_one_against_a_flat_punch(tmp_path):
    body = BODY | {"roughness": measured(tmp_path, -0.005 * np.cos(2 * np.pi * X))}
    two = gfmd_numba.solve(scene(body=body, counter_body=body, loading={"displacement": 4e-3}))
    one = gfmd_numba.solve(scene(body=body, loading={"displacement": 2e-3}))
    np.testing.assert_allclose(two.pressure, one.pressure, atol=1e-7 * one.pressure.max().item())
    for name in ("displacement", "tangential_displacement"):
        scale = abs(one[name]).max().item()
        np.testing.assert_allclose(two[name], one[name], atol=1e-7 * scale)
        np.testing.assert_allclose(two[f"counter_body_{name}"], one[name], atol=1e-7 * scale)


def test_a_counter_body_far_stiffer_is_a_rigid_punch():
    stiff = {"youngs_modulus": 1e9, "poissons_ratio": 0.2, "aspect_ratio": 1.0, "roughness": ROUGH}
    two = gfmd_numba.solve(scene(order=0, counter_body=stiff, loading={"displacement": 1e-3}))
    one = gfmd_numba.solve(scene(roughness=ROUGH, loading={"displacement": 1e-3}))
    np.testing.assert_allclose(two.pressure, one.pressure, atol=1e-7 * one.pressure.max().item())
    assert abs(two.counter_body_displacement).max() < 1e-7 * abs(two.displacement).max()


@pytest.mark.parametrize("order", [0, pytest.param(2, marks=pytest.mark.long)])
def test_two_unlike_rough_bodies_touch_where_they_press_and_share_the_displacement(order):
    """Above order 0 each node touches what it meets where it has moved to."""
    other = {"youngs_modulus": 3.0, "poissons_ratio": 0.5, "aspect_ratio": 0.1, "roughness": ROUGH | {"hurst": 0.5}}
    contact = gfmd_numba.solve(scene(order=order, body=rough(), counter_body=other, loading={"displacement": 1e-3}))
    assert contact.status == 0
    places, facing = contact.x.values, contact.counter_body_height + contact.counter_body_displacement
    if order > 0:
        own, other_way = contact.tangential_displacement.values, contact.counter_body_tangential_displacement.values
        met = places
        for _ in range(20):
            met = places + own - np.interp(met, places, other_way, period=1.0)
        facing = CubicSpline(np.append(places, 1.0), np.append(facing, facing[0]), bc_type="periodic")(met % 1.0)
    gap = contact.height.max() - 1e-3 - contact.body_height - contact.displacement - facing
    touching = contact.pressure > 0
    accuracy = 1e-10 if order == 0 else 2e-6  # of the cubic spline
    assert abs(gap[touching]).max() < accuracy
    np.testing.assert_allclose(gap, contact.gap, atol=accuracy)
    np.testing.assert_allclose(contact.height, contact.body_height + contact.counter_body_height, atol=1e-16)
    for name in ("body", "counter_body"):
        inside = gfmd_numba.body_fields(contact, [-0.01, -0.1], name)
        # means over labels are those over places but for the slope
        np.testing.assert_allclose(inside.stress_3.mean("x"), -contact.pressure.mean(), rtol=1e-2)
    inside = gfmd_numba.body_fields(contact, [-0.1], "counter_body")
    assert abs(inside.displacement_3).max() < 1e-8 * abs(contact.displacement).max()  # its base


def test_finite_range_laws_act_on_rough_bodies():
    law = {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-6, "range": 5e-3}}
    mapped = gfmd_numba.solve(scene(roughness=ROUGH, interface=law))
    own = gfmd_numba.solve(scene(order=0, body=rough(), interface=law))
    np.testing.assert_allclose(own.pressure, mapped.pressure, atol=1e-7 * mapped.pressure.max().item())


def test_a_path_of_loads_on_a_rough_body_returns_where_it_was():
    steps = {"path": [{"reduced_pressure": 0.05}, {"reduced_pressure": 0.02}]}
    contact = gfmd_numba.solve(scene(body=rough()) | steps)
    np.testing.assert_allclose(contact.pressure[2], contact.pressure[0], atol=1e-5 * contact.pressure.max().item())
    assert gfmd_numba.body_fields(contact, [-0.1]).stress_3.dims == ("step", "z", "x")
