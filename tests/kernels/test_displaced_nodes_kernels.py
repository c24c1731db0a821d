"""Kernels of splines at displaced nodes compared with scipy's splines, and with each other."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from gfmd_numba.kernels import displaced_nodes

SHAPE = (7, 9)


def matrix(way, n):
    """What each coefficient is worth at each node `[node, coefficient]`, from scipy's basic spline on 7 knots."""
    spline = BSpline.basis_element(np.arange(-3.0, 4.0), extrapolate=False)
    distance = (np.arange(n) + way)[:, np.newaxis] - np.arange(-4 * n, 5 * n)
    return np.nan_to_num(spline(distance)).reshape(n, 9, n).sum(axis=1)


def test_splines_are_read_as_scipy_does():
    rng = np.random.default_rng(0)
    splines, ways = rng.normal(size=SHAPE), np.zeros((2, *SHAPE))
    ways[0], ways[1] = 2.0 * rng.normal(size=SHAPE[1]), 2.0 * rng.normal(size=SHAPE[0])[:, np.newaxis]
    found = np.empty(SHAPE)
    displaced_nodes.read(splines, ways, found)
    expected = matrix(ways[1, :, 0], SHAPE[0]) @ splines @ matrix(ways[0, 0], SHAPE[1]).T
    np.testing.assert_allclose(found, expected, atol=1e-13)


def test_handing_back_is_the_adjoint_of_reading():
    rng = np.random.default_rng(1)
    splines, forces, ways = rng.normal(size=SHAPE), rng.normal(size=SHAPE), 3.0 * rng.normal(size=(2, *SHAPE))
    read, handed_back = np.empty(SHAPE), np.zeros(SHAPE)
    displaced_nodes.read(splines, ways, read)
    displaced_nodes.hand_back(forces, ways, handed_back)
    assert np.sum(read * forces) == pytest.approx(np.sum(splines * handed_back))
