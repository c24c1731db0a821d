"""Laws that hold for any contact: it moves and turns with its punch, knows no unit, and has the least energy."""

import numpy as np
import pytest
import slab_stiffness
from hypothesis import given, settings
from hypothesis import strategies as st

from gfmd_numba.contact.area_correction import HALF_SPACE
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine
from support.contacts import press

quick = settings(derandomize=True, deadline=None, max_examples=12)


@st.composite
def punches(draw):
    """Heights `[1, nx]` of a rough punch, white noise and smooth ones among them, on even, odd and prime grids."""
    nx = draw(st.sampled_from([16, 31, 64, 101, 128]))
    hurst, realisation = draw(st.floats(0, 1)), draw(st.integers(0, 1000))
    return self_affine.SelfAffineWaves(hurst, draw(st.integers(1, 2)), nx // 4).heights(
        (nx,), 0, range(realisation, realisation + 1)
    )


@st.composite
def bodies(draw):
    """Poisson's ratio and aspect ratio of a body."""
    return draw(st.sampled_from([-0.99, 0.0, 0.33, 0.499999, 0.5])), draw(st.sampled_from([0.01, 0.1, 1.0, 1e4]))


solvers = st.sampled_from(["verlet", "conjugate_gradients", "active_set_newton"])
loads = st.floats(-3, 1.5).map(lambda exponent: 10**exponent)


def body_of(kind, nx):
    return slab_stiffness.slab(grid.wavenumbers(nx), *kind)


def energy(u, body, load):
    """Elastic energy of displacements `[..., nx]` less the work of the load, per area."""
    weight = np.concatenate(([0.0], 0.5 * grid.multiplicity(u.shape[-1])[1:] * body[1:]))
    return (np.abs(grid.coefficients(u)) ** 2 * weight).sum(axis=-1) - load * u.mean(axis=-1)


@given(heights=punches(), kind=bodies(), load=loads, shift=st.integers(1, 1000), solver=solvers)
@quick
def test_a_contact_moves_and_turns_with_its_punch(heights, kind, load, shift, solver):
    body = body_of(kind, heights.shape[1])
    plain = press(heights, load, solver, body)
    for change in (lambda a: np.roll(a, shift, axis=1), lambda a: a[:, ::-1]):
        moved = press(change(heights), load, solver, body)
        np.testing.assert_array_equal(moved.touching, change(plain.touching))
        np.testing.assert_allclose(moved.pressure, change(plain.pressure), atol=1e-7 * plain.pressure.max())


@given(heights=punches(), kind=bodies(), load=loads, exponent=st.integers(-200, 200), solver=solvers)
@quick
def test_a_contact_knows_no_unit(heights, kind, load, exponent, solver):
    """By powers of two nothing rounds: every bit is the same."""
    body, scale = body_of(kind, heights.shape[1]), 2.0**exponent
    plain, other = press(heights, load, solver, body), press(scale * heights, scale * load, solver, body)
    np.testing.assert_array_equal(other.pressure, scale * plain.pressure)
    np.testing.assert_array_equal(other.displacement, scale * plain.displacement)
    assert other.n_iterations[0] == plain.n_iterations[0]


@given(heights=punches(), kind=bodies(), load=loads, factor=st.floats(1.01, 100))
@quick
def test_what_touches_goes_on_touching_under_more_load(heights, kind, load, factor):
    body = body_of(kind, heights.shape[1])
    light, heavy = press(heights, load, body=body), press(heights, factor * load, body=body)
    assert (heavy.touching >= light.touching).all()


@given(heights=punches(), kind=bodies(), load=loads, seed=st.integers(0, 99), size=st.floats(-6, 0))
@quick
def test_equilibrium_has_the_least_energy(heights, kind, load, seed, size):
    """Of all displacements that do not penetrate; the sum over waves, not the solver, says what energy is."""
    nx, rng = heights.shape[1], np.random.default_rng(seed)
    body, punch = body_of(kind, nx), heights.max() - heights
    u = press(heights, load, body=body).displacement
    least = energy(u, body, load)
    others = np.minimum(u + 10.0**size * np.ptp(heights) * rng.normal(size=(50, nx)).cumsum(axis=1) / nx, punch)
    others = np.concatenate([others, np.minimum(u + 10.0**size * rng.normal(size=(50, 1)), punch)])
    assert (energy(others, body, load) >= least - 1e-9 * abs(least)).all()


@given(first=punches(), seed=st.integers(0, 99), kind=bodies())
@quick
def test_full_contact_superposes_and_is_reciprocal(first, seed, kind):
    nx, load = first.shape[1], 1e4
    second = self_affine.SelfAffineWaves(0.5, 1, nx // 4).heights((nx,), 7, range(seed, seed + 1))
    body = body_of(kind, nx)
    load = 10.0 * (body[1:].max() * (np.ptp(first) + np.ptp(second)))  # no suction anywhere
    a, b, both = (press(h, load, body=body).pressure - load for h in (first, second, first + second))
    np.testing.assert_allclose(both, a + b, atol=1e-7 * load)
    assert (a * second).mean() == pytest.approx((b * first).mean(), rel=1e-6, abs=1e-8 * load)


@given(seed=st.integers(0, 99), hurst=st.floats(0, 1), load=st.floats(0.03, 1.0))
@quick
def test_refinement_changes_no_more_than_the_error_said(seed, hurst, load):
    areas, errors = [], []
    for nx in (256, 1024):
        touching = press(
            self_affine.SelfAffineWaves(hurst, 1, 16).heights((nx,), 5, range(seed, seed + 1)), load
        ).touching[0]
        edges = 2 * np.count_nonzero(touching & ~np.roll(touching, 1))
        areas.append((touching.sum() - HALF_SPACE.excess * edges) / nx)
        errors.append(np.sqrt(edges / 12) / nx)
    # stretches may merge between two grids: an edge is then off by up to a spacing rather than by its deviation
    assert abs(areas[0] - areas[1]) < 5 * np.hypot(*errors) + 2 / 256
