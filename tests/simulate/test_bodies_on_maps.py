"""Rough elastic bodies, and two of them, on maps: the mapped punch, the profile of a ridge, compliances that add."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis.plots.contact import plot_contact
from gfmd_numba.elasticity import topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine

ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
BODY = {"youngs_modulus": 1.0, "poissons_ratio": 0.33, "aspect_ratio": 0.5}
HALF = {"youngs_modulus": 1.0, "poissons_ratio": 0.2}
MAP = {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2}
NX = 32
LAYERED = ElasticBody.layered((0.05, 0.3), (Material(1.0, 0.3), Material(5.0, 0.1)), None)


def solved(dimension=2, loading=None, numerics=None, **parts):
    scene = {"dimension": dimension, "interface": {"hard_wall": {}}, "loading": loading or {"reduced_pressure": 0.05}}
    file = {"scene": scene | parts, "numerics": {"residual": 1e-10} | (numerics or {})}
    return gfmd_numba.solve(file | ({"discretisation": MAP} if ROUGH["method"] in str(parts) else {}))


def heights(values):
    return {"method": "measured", "heights": values, "units": {"z": "L_x"}}


@pytest.mark.parametrize("loading", [{"displacement": 2e-3}])
def test_a_rough_map_is_pressed_like_its_mapped_punch(loading):
    mapped = solved(body=BODY, roughness=ROUGH, loading=loading)
    own = solved(body=BODY | {"roughness": ROUGH}, loading=loading)
    assert own["status"] == mapped["status"] == 0
    np.testing.assert_allclose(own["pressure"], mapped["pressure"], atol=1e-9 * float(mapped["pressure"].max()))
    # the field of a punch on a slab counts from the unloaded body too
    scale = float(abs(mapped["displacement"]).max())
    np.testing.assert_allclose(own["displacement"], mapped["displacement"], atol=1e-6 * scale)
    assert 0.0 < float(own["next_order"]) < 0.05 * scale
    assert "body_forming_traction" not in own
    assert len(plot_contact(own).axes) == 9


@pytest.mark.parametrize("law", [{}, {"exponential": {"work_of_adhesion": 1e-5, "range": 5e-3}}])
def test_two_bodies_of_a_ridge_are_those_of_the_profile(law):
    first, second = (0.01 * each for each in self_affine.SelfAffineWaves(0.8, 2, 8).heights((NX,), 1, range(2)))
    interface = {"hard_wall": {}} | law
    pair = [
        solved(
            dimension,
            body=BODY | {"roughness": heights(made(first))},
            counter_body=HALF | {"roughness": heights(made(second))},
            interface=interface,
            numerics={"topography_order": 0},
        )
        for dimension, made in ((1, np.array), (2, lambda profile: np.tile(profile, (NX, 1))))
    ]
    expected, found = pair
    for name in ("pressure", "displacement", "counter_body_displacement", "gap", "counter_body_height"):
        scale = float(abs(expected[name]).max())
        np.testing.assert_allclose(found[name][3], expected[name], atol=1e-8 * scale, err_msg=name)
    assert 0.0 < float(found["next_order"]) < float(expected["next_order"])  # which holds the tangential one


def test_compliances_of_two_half_spaces_add():
    """Two bodies share a load as one of half the contact modulus bears it, half the displacement each."""
    rough = BODY | {"aspect_ratio": np.inf, "roughness": ROUGH}
    other = {"youngs_modulus": 1.0, "poissons_ratio": 0.33}
    one, two = solved(body=rough), solved(body=rough, counter_body=other)
    np.testing.assert_allclose(two["pressure"], 0.5 * one["pressure"], atol=1e-8 * float(one["pressure"].max()))
    scale = float(abs(one["displacement"]).max())
    for name in ("displacement", "counter_body_displacement"):
        np.testing.assert_allclose(two[name], 0.5 * one["displacement"], atol=1e-7 * scale)


def test_a_path_of_two_bodies_returns_to_where_it_was():
    path = solved(body=BODY | {"roughness": ROUGH}, counter_body=HALF, loading={"reduced_pressure": 0.02})
    file = {
        "scene": {
            "dimension": 2,
            "body": BODY | {"roughness": ROUGH},
            "counter_body": HALF,
            "interface": {"hard_wall": {}},
            "loading": {"reduced_pressure": 0.02},
        },
        "path": [{"reduced_pressure": 0.1}, {"reduced_pressure": 0.02}],
        "discretisation": MAP,
        "numerics": {"residual": 1e-10},
    }
    found = gfmd_numba.solve(file)
    scale = float(path["pressure"].max())
    for step in (0, 2):
        np.testing.assert_allclose(found["pressure"].values[step], path["pressure"].values, atol=1e-8 * scale)


@pytest.mark.long
@pytest.mark.parametrize(("order", "along"), [(1, "y"), (2, "x")])
def test_higher_orders_of_a_ridge_are_those_of_the_profile(order, along):
    first, second = (0.025 * each for each in self_affine.SelfAffineWaves(0.8, 2, 8).heights((NX,), 1, range(2)))
    expected, found = (
        solved(
            dimension,
            body=BODY | {"aspect_ratio": 0.2, "roughness": heights(made(first))},
            counter_body=HALF | {"roughness": heights(made(second))},
            numerics={"topography_order": order},
        )
        for dimension, made in (
            (1, np.array),
            (2, lambda profile: np.tile(profile, (NX, 1)) if along == "x" else np.tile(profile, (NX, 1)).T.copy()),
        )
    )
    assert expected["status"] == found["status"] == 0
    cut = found.isel({"y" if along == "x" else "x": 3})
    for name in ("pressure", "displacement", "counter_body_displacement", "gap"):
        scale = float(abs(expected[name]).max())
        np.testing.assert_allclose(cut[name], expected[name], atol=1e-7 * scale, err_msg=name)


@pytest.mark.long
def test_the_first_order_is_nearer_to_the_second_than_order_0_is():
    steep = ROUGH | {"rms_gradient": 0.025}
    orders = [solved(body=BODY | {"roughness": steep}, numerics={"topography_order": order}) for order in (0, 1, 2)]
    off = [float(abs(found["displacement"] - orders[2]["displacement"]).max()) for found in orders[:2]]
    assert off[1] < 0.2 * off[0]
    # under the pressure of each order the next one is expected to add what it adds, but for what pressures change
    assert 0.3 < float(orders[0]["next_order"]) / off[0] < 3.0
    assert int(orders[1]["n_transforms"]) >= 3 * int(orders[0]["n_transforms"])  # the cost of all rounds
    assert float(orders[2]["next_order"]) < float(orders[1]["next_order"]) < float(orders[0]["next_order"])


def test_a_film_at_order_0_is_told_to_take_a_higher_one():
    film = BODY | {"aspect_ratio": 0.02, "roughness": ROUGH}
    with pytest.warns(UserWarning, match="take a numerics.topography_order of 1 or 2"):
        solved(body=film)


def smooth(rng):
    waves = grid.coefficients(rng.normal(size=NX))
    waves[0], waves[6:] = 0.0, 0.0
    return grid.signal(waves, NX)


@pytest.mark.parametrize("body", [ElasticBody(0.3, None), ElasticBody(0.3, 0.4), ElasticBody(0.5, 0.4)])
def test_what_the_next_order_adds_to_a_ridge_is_what_it_adds_to_the_profile(body):
    rng = np.random.default_rng(0)
    p, h = smooth(rng), 0.01 * smooth(rng)
    expected = topography.respond(p, h, body, 1).u3
    ridges = [np.tile(each, (20, 1)) for each in (p, h)]
    along = topography.respond(*ridges, body, 1)
    across = topography.respond(*(each.T.copy() for each in ridges), body, 1)
    np.testing.assert_allclose(along.u3, np.tile(expected, (20, 1)), atol=1e-14)
    np.testing.assert_allclose(across.u3.T, along.u3, atol=1e-14)
    assert along.highest_order == pytest.approx(abs(expected).max())
    assert topography.respond(*ridges, body, 0).highest_order == 0.0


@pytest.mark.parametrize("body", [ElasticBody(0.3, 0.4), ElasticBody(0.5, 0.4), LAYERED])
def test_what_the_next_order_adds_under_drag_is_what_it_adds_to_the_profile(body):
    rng = np.random.default_rng(2)
    p, h, t = smooth(rng), 0.01 * smooth(rng), smooth(rng) + 0.5
    expected = topography.respond(p, h, body, 1, t[np.newaxis]).u3
    assert abs(expected - topography.respond(p, h, body, 1).u3).max() > 0.1 * abs(expected).max()
    ridges = [np.tile(each, (20, 1)) for each in (p, h, t)]
    pressure, heights, drag = ridges
    along = topography.respond(pressure, heights, body, 1, np.array([drag, 0 * drag]))
    across = topography.respond(pressure.T, heights.T, body, 1, np.array([0 * drag.T, drag.T]))
    np.testing.assert_allclose(along.u3, np.tile(expected, (20, 1)), atol=1e-14)
    np.testing.assert_allclose(across.u3.T, along.u3, atol=1e-14)
    # drag along a ridge shears it without moving it up
    sideways = topography.respond(0 * pressure, heights, body, 1, np.array([0 * drag, drag]))
    assert abs(sideways.u3).max() < 1e-16


def test_the_first_order_under_drag_turns_with_its_ridge():
    rng, body = np.random.default_rng(3), ElasticBody(0.2, None)
    p, h, t = smooth(rng), 0.01 * smooth(rng), smooth(rng)
    diagonal = np.add.outer(np.arange(NX), np.arange(NX)) % NX
    drag = np.sqrt(0.5) * np.array([t[diagonal], t[diagonal]])
    found = topography.respond(p[diagonal], h[diagonal], body, 1, drag).u3
    np.testing.assert_allclose(found, topography.respond(p, h, body, 1, t[np.newaxis]).u3[diagonal], atol=1e-14)


def test_the_first_order_of_a_half_space_turns_with_its_ridge_and_knows_no_length():
    rng, body = np.random.default_rng(1), ElasticBody(0.3, None)
    p, h = smooth(rng), 0.01 * smooth(rng)
    diagonal = np.add.outer(np.arange(NX), np.arange(NX)) % NX
    found = topography.respond(p[diagonal], h[diagonal], body, 1).u3
    np.testing.assert_allclose(found, topography.respond(p, h, body, 1).u3[diagonal], atol=1e-14)


def test_the_first_order_of_crossed_waves_is_its_closed_form():
    """Pressure p = cos(q x) on a half-space under heights h = cos(k y), from Flamant's stresses and strains.

    At the surface sigma_x = -p, sigma_y = -2 nu p and strain_z = -c p, c = (1 - 2 nu) / (1 - nu) / E*; a tangential
    traction s moves it up by c div s / Q^2, Q^2 = q^2 + k^2, and s is the divergence of h sigma.
    """
    nu, q, k = 0.3, 2.0, 3.0
    x = 2.0 * np.pi * np.arange(NX) / NX
    p, h = np.tile(np.cos(q * x), (NX, 1)), np.tile(0.01 * np.cos(k * x), (NX, 1)).T
    c = (1.0 - 2.0 * nu) / (1.0 - nu)
    expected = c * p * h * ((q**2 + 2.0 * nu * k**2) / (q**2 + k**2) - 1.0)
    found = topography.respond(p, h, ElasticBody(nu, None), 1)
    np.testing.assert_allclose(found.u3, expected, atol=1e-14)
    assert found.highest_order == pytest.approx(abs(expected).max())
