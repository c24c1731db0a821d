"""Rounds that approach a fixed point slowly are extrapolated; fast ones, and those that move apart, are left alone."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.contact.two_step import SlopeRounds

RNG = np.random.default_rng(3)
SIZE = 12
WAYS = np.linalg.qr(RNG.normal(size=(SIZE, SIZE)))[0]
WANTED = RNG.normal(size=SIZE)


def rounds_taken(factors, most=30):
    """Number of rounds until a linear map with these factors along its ways stands still to 1e-8."""
    rounds, x = SlopeRounds(), np.zeros(SIZE)
    for count in range(1, most + 1):
        found = WANTED + WAYS @ (factors * (WAYS.T @ (x - WANTED)))
        if abs(found - x).max() < 1e-8:
            np.testing.assert_allclose(x, WANTED, atol=1e-6)
            return count
        x = np.concatenate(rounds.following((x[:5], x[5:]), (found[:5], found[5:])))
    return None


def test_slow_rounds_end_soon_after_they_are_extrapolated():
    slow = np.concatenate(([0.8, -0.7, 0.5], np.full(SIZE - 3, 1e-3)))
    assert 8 < rounds_taken(slow) <= 16


def test_fast_rounds_are_taken_as_they_are():
    rounds, given = SlopeRounds(), (np.zeros((2, 3)), np.ones(4))
    for _ in range(8):
        found = 0.1 * given[0] + 1.0, 0.2 * given[1]
        assert rounds.following(given, found) is found
        given = found


@pytest.mark.parametrize("factor", [-1.1, -1.0, 0.95])
def test_rounds_that_jump_to_and_fro_or_come_nearer_ever_so_slowly_end_soon(factor):
    assert 8 < rounds_taken(np.concatenate(([factor], np.full(SIZE - 1, 0.1)))) <= 16


def test_rounds_that_move_apart_on_one_side_are_left_alone():
    assert rounds_taken(np.concatenate(([1.02], np.full(SIZE - 1, 0.1)))) is None


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_a_stiff_coating_that_valleys_thin_to_a_half_is_solved_at_the_first_order():
    """Plain rounds come nearer by a factor of 0.72 each, and 30 of them are not enough."""
    layers = [{"height": 5e-3, "youngs_modulus": 70.0, "poissons_ratio": 0.3}]
    scene = {
        "body": {
            "layers": layers,
            "base": {"youngs_modulus": 3.0, "poissons_ratio": 0.4},
            "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        },
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.03},
    }
    file = {
        "scene": scene,
        "seed": 3,
        "realisation": 2,
        "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2},
    }
    first, second = (gfmd_numba.solve(file | {"numerics": {"topography_order": order}}) for order in (1, 2))
    assert first["status"] == second["status"] == 0
    off = float(abs(first["displacement"] - second["displacement"]).max())
    assert off < 5.0 * float(first["next_order"])


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_steep_bodies_under_steep_punches_come_to_rest():
    """Plain rounds jump between two states for ever in the first scene, and come nearer by 8 % in the second."""

    def rough(hurst, gradient):
        return {"roughness": {"method": "psd", "hurst": hurst, "rms_gradient": gradient}}

    wall = {"interface": {"hard_wall": {}}}
    slab = {"poissons_ratio": 0.45, "aspect_ratio": 0.87}
    for body, punch, load, eps, seed in (
        ({"poissons_ratio": 0.12} | rough(0.33, 0.145), rough(0.61, 0.232), 0.0048, (1, 1 / 64, 1 / 2), 207942),
        (slab | rough(0.36, 0.12), rough(0.82, 0.214), 0.307, (1 / 4, 1 / 8, 1 / 2), 162640),
    ):
        scene = {"body": body} | punch | wall | {"loading": {"reduced_pressure": load}}
        discretisation = dict(zip(("eps_c", "eps_f", "eps_t"), eps, strict=True))
        found = gfmd_numba.solve({"scene": scene, "seed": seed, "discretisation": discretisation})
        assert found["status"] == 0
        assert found["next_order"] < 0.01 * abs(found["displacement"]).max()
