"""Friction of a rough elastic body under a level punch, to higher orders in its slope: finite elements, and stick."""

from itertools import pairwise

import numpy as np
import pytest
from finite_elements import Body, graded

import gfmd_numba

ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02}
EPS = {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}


def solved(order, roughness, loading, path, friction, residual=1e-9):
    """All steps of a path on a rough slab under a level rigid punch."""
    scene = {
        "body": {"poissons_ratio": 0.33, "aspect_ratio": 1.0, "roughness": roughness},
        "interface": {"hard_wall": {}, "friction": {"coefficient": friction}},
        "loading": loading,
    }
    file = {"scene": scene, "path": path, "numerics": {"topography_order": order, "residual": residual}}
    found = gfmd_numba.solve(file | ({"discretisation": EPS} if roughness is ROUGH else {}))
    assert (found["status"] == 0).all()
    return found


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:a deformable surface has an rms gradient")
def test_a_sinusoid_that_a_level_punch_slides_over_is_that_of_finite_elements():
    """Slip everywhere: each node of the true surface is pulled by friction times what it presses."""
    nx, columns, amplitude, friction = 512, 128, 0.02, 0.5
    heights = -amplitude * np.cos(2 * np.pi * np.arange(nx) / nx)
    wave = {"method": "measured", "heights": heights, "units": {"z": "L_x"}}
    depth, over = 0.33 * amplitude, nx // (2 * columns)
    found = [
        solved(order, wave, {"displacement": depth}, [{"sliding": 0.1}], friction).isel(step=1) for order in (0, 1, 2)
    ]

    def stretched(x, z):
        return 0 * x, heights[np.rint(x * nx).astype(int) % nx] * (z + 1.0)

    mesh = Body(columns, graded(1.0, 24, 0.5 / columns), 0.33, stretched)
    clearance, touching = (heights.max() - heights - depth)[::over], found[2]["pressure"].values[::over] > 0.0
    solution = mesh.press(clearance, touching, friction=friction)
    tangential, normal = mesh.along_top(solution)
    errors = []
    for each in found:
        np.testing.assert_allclose(each["tangential_traction"], friction * each["pressure"], atol=1e-9)
        errors.append(
            max(
                abs(each["tangential_displacement"].values[::over] - tangential).max(),
                abs(each["displacement"].values[::over] - normal).max(),
            )
        )
    assert errors[0] > 1e-4
    assert 0.5 < errors[0] / float(found[0]["next_order"]) < 2.0
    assert 0.5 < errors[1] / float(found[1]["next_order"]) < 2.0
    assert errors[2] < 5e-6  # the mesh's own error
    assert float(found[2]["pressure"].mean()) == pytest.approx(-mesh.traction(solution).mean(), rel=1e-3)


def test_sticking_nodes_of_the_true_surface_move_with_the_punch():
    found = solved(2, ROUGH, {"reduced_pressure": 0.05}, [{"sliding": 1e-3}, {"sliding": 1.1e-3}], 1.0)
    pressure, slip, moved = (found[name].values for name in ("pressure", "slip", "tangential_displacement"))
    stuck = (pressure[1] > 0.0) & (pressure[2] > 0.0) & (slip[2] == 0.0)
    assert stuck.sum() > 3
    np.testing.assert_allclose((moved[2] - moved[1])[stuck], 1e-4, atol=1e-9 * abs(moved).max())
    held = (pressure[0] > 0.0) & (slip[0] == 0.0)  # where a node was before it touched
    assert held.any()
    np.testing.assert_allclose(moved[0][held], 0.0, atol=1e-9 * abs(moved).max())
    inside = gfmd_numba.body_fields(found, [0.0]).isel(z=0)
    np.testing.assert_allclose(inside["displacement_1"], moved, atol=1e-9 * abs(moved).max())
    assert "energy_lost" not in found  # it is that of flat bodies


@pytest.mark.long
def test_each_order_is_off_by_what_the_next_one_adds():
    loads = {"reduced_pressure": 0.05}, [{"sliding": 1e-3}], 0.3
    found = [solved(order, ROUGH, *loads) for order in (0, 1, 2)]
    for low, high in pairwise(found):
        off = abs(low["tangential_displacement"] - high["tangential_displacement"]).max("x")
        assert (off < 5.0 * low["next_order"]).all()
    expected = np.array([float(each["next_order"][1]) for each in found])
    assert (expected[1:] < 0.1 * expected[:-1]).all()


def test_friction_too_weak_to_matter_leaves_the_frictionless_contact():
    """A coefficient of 1e-9 against the solution without friction."""
    rubbed = solved(2, ROUGH, {"displacement": 2e-4}, [{"sliding": 1e-3}], 1e-9).isel(step=1)
    scene = {
        "body": {"poissons_ratio": 0.33, "aspect_ratio": 1.0, "roughness": ROUGH},
        "interface": {"hard_wall": {}},
        "loading": {"displacement": 2e-4},
    }
    numerics = {"topography_order": 2, "residual": 1e-9}
    smooth = gfmd_numba.solve({"scene": scene, "numerics": numerics, "discretisation": EPS})
    for name in ("pressure", "displacement", "tangential_displacement"):
        np.testing.assert_allclose(rubbed[name], smooth[name], atol=1e-7 * float(abs(smooth[name]).max()))


def test_friction_acts_on_the_slopes_of_an_incompressible_half_space():
    """Flat, it would not move along x under a pressure."""
    scene = {
        "body": {"poissons_ratio": 0.5, "roughness": ROUGH},
        "interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}},
        "loading": {"reduced_pressure": 0.05},
    }
    flat, tilted = (
        gfmd_numba.solve({"scene": scene, "numerics": {"topography_order": order}, "discretisation": EPS})
        for order in (0, 1)
    )
    assert "friction" in flat.attrs["dropped_effects"]
    assert tilted.attrs["dropped_effects"] == ""
    assert abs(tilted["tangential_traction"]).max() > 1e-3 * tilted["pressure"].max()
