"""Friction of a rough elastic map under a level punch at higher orders in its slope, and the fields below it."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis import plot_body
from gfmd_numba.analysis.plots.contact import plot_contact
from gfmd_numba.roughness import self_affine
from gfmd_numba.scene import InputError
from support.legible import faults

NX = 24
PROFILE = 0.02 * self_affine.SelfAffineWaves(0.8, 2, 6).heights((NX,), 1, range(1))[0]
PATH = [{"reduced_pressure": 0.1, "sliding": 1e-4}, {"sliding": 5e-5}]
BUMPS = np.add.outer(PROFILE, np.roll(PROFILE[::-1], 5))
FIELDS = ("pressure", "displacement", "gap", "slip")


def solved(dimension, heights, path, order=2, friction=0.3, **body):
    """All steps of a path on a rough slab under a level rigid punch."""
    scene = {
        "dimension": dimension,
        "body": {
            "poissons_ratio": 0.33,
            "aspect_ratio": 0.5,
            "roughness": {"method": "measured", "heights": heights, "units": {"z": "L_x"}},
        }
        | body,
        "interface": {"hard_wall": {}, "friction": {"coefficient": friction}},
        "loading": {"reduced_pressure": 0.05},
    }
    found = gfmd_numba.solve({"scene": scene, "path": path, "numerics": {"topography_order": order, "residual": 1e-10}})
    assert (found["status"] == 0).all()
    return found


@pytest.fixture(scope="module")
def bumps():
    return solved(2, BUMPS, [{"sliding": 1e-4, "sliding_y": 2e-4}, {"sliding": -1e-4}])


def close(found, expected, scale, name):
    np.testing.assert_allclose(found, expected, atol=1e-8 * float(abs(scale).max()), err_msg=name)


@pytest.mark.long
@pytest.mark.parametrize(("order", "along"), [(2, "x"), (3, "y")])
def test_a_rough_ridge_rubs_as_its_profile_does(order, along):
    ridge = np.tile(PROFILE, (NX, 1))
    expected = solved(1, PROFILE, PATH, order)
    if along == "x":
        found, end = solved(2, ridge, PATH, order).isel(y=3), ""
    else:
        path = [{name.replace("sliding", "sliding_y"): value for name, value in step.items()} for step in PATH]
        found, end = solved(2, ridge.T.copy(), path, order).isel(x=3), "_y"
    assert (expected["stick_fraction"] > 0.0).all()
    assert (expected["stick_fraction"] < 1.0).any()
    for name in FIELDS:
        close(found[name], expected[name], expected["displacement" if name == "slip" else name], name)
    for name in ("tangential_displacement", "tangential_traction"):
        close(found[name + end], expected[name], expected[name], name)
    close(found["next_order"], expected["next_order"], expected["next_order"], "next_order")


@pytest.mark.long
def test_a_map_turned_by_a_right_angle_rubs_like_itself(bumps):
    """Turned, its y is the x of the map before, and its x is minus the y; node 0 stays node 0."""
    rotated = np.roll(np.rot90(BUMPS), 1, axis=0)
    turned = solved(2, rotated, [{"sliding": 2e-4, "sliding_y": -1e-4}, {"sliding_y": 1e-4}])

    def back(name):
        return np.rot90(np.roll(turned[name].values, -1, axis=1), -1, axes=(1, 2))

    for name in FIELDS:
        close(back(name), bumps[name], bumps["displacement" if name == "slip" else name], name)
    for name in ("tangential_displacement", "tangential_traction"):
        close(-back(name + "_y"), bumps[name], bumps[name], name)
        close(back(name), bumps[name + "_y"], bumps[name], name)


@pytest.mark.long
def test_sticking_nodes_of_the_true_surface_move_with_the_punch_in_both_directions(bumps):
    found = solved(2, BUMPS, [{"sliding": 1e-4, "sliding_y": 2e-4}, {"sliding_y": 3e-4}], friction=2.0)
    pressure, slip = found["pressure"].values, found["slip"].values
    stuck = (pressure[1] > 0.0) & (pressure[2] > 0.0) & (slip[2] == 0.0)
    assert stuck.sum() > 3
    for end, way in (("", 0.0), ("_y", 1e-4)):
        moved = np.diff(found[f"tangential_displacement{end}"].values, axis=0)[1]
        np.testing.assert_allclose(moved[stuck], way, atol=1e-12)


@pytest.mark.long
def test_each_order_is_off_by_what_the_next_one_adds():
    path = [{"sliding": 1e-4, "sliding_y": 2e-4}]
    found = [solved(2, BUMPS, path, order) for order in (0, 1, 2, 3)]
    for low, high in pairwise(found):
        for name in ("displacement", "tangential_displacement", "tangential_displacement_y"):
            off = abs(low[name] - high[name]).max(("y", "x"))
            assert (off < 5.0 * low["next_order"]).all()
    expected = np.array([float(each["next_order"][1]) for each in found])
    assert (expected[1:] < 0.5 * expected[:-1]).all()


@pytest.mark.long
def test_friction_at_a_higher_order_is_drawn_and_records_no_energy_of_flat_bodies(bumps):
    assert "energy_lost" not in bumps
    assert faults(plot_contact(bumps)) == []


@pytest.mark.long
def test_fields_below_a_map_of_higher_order_begin_with_the_displacements_of_its_surface():
    contact = solved(2, BUMPS, [])
    y = contact.y[7].item()
    fields = gfmd_numba.body_fields(contact, [0.0, -0.1], y=y)
    line = contact.sel(y=y)
    for number, name in (("1", "tangential_displacement"), ("2", "tangential_displacement_y"), ("3", "displacement")):
        close(fields[f"displacement_{number}"].isel(z=0), line[name], contact["displacement"], name)
    for field in fields.data_vars.values():
        assert np.isfinite(field).all()


@pytest.mark.long
def test_sections_planes_and_the_largest_stress_of_a_map_of_higher_order_are_of_one_field(bumps):
    z = [-0.01, -0.2, -0.5]
    planes = gfmd_numba.body_fields(bumps, planes=z)
    for where in ({"x": 0.25}, {"y": 0.5}):
        section = gfmd_numba.body_fields(bumps, z, **where)
        for name in ("displacement_2", "stress_6", "strain_1", "von_mises"):
            close(section[name], planes[name].sel(where), planes[name], name)
    np.testing.assert_allclose(planes["peak_von_mises"][:, 0], planes["von_mises"].max(("y", "x"))[:, 0], rtol=1e-9)
    held = planes.sel(z=-0.5)
    for name in ("displacement_1", "displacement_2", "displacement_3"):
        close(held[name], 0.0, planes[name], name)
    assert faults(plot_body(planes)) == []


@pytest.mark.long
def test_fields_at_higher_orders_say_how_much_memory_they_take(bumps, monkeypatch):
    monkeypatch.setattr("psutil.virtual_memory", lambda: SimpleNamespace(total=8 * NX * NX * 100))
    with pytest.raises(
        InputError, match=r"contact: you gave 24 x 24 nodes; gfmd allows a grid .* a section below it needs"
    ):
        gfmd_numba.body_fields(bumps, [0.0])
