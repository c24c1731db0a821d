"""The law of gap and slip on maps: its slip is a vector, and it acts alike in every direction."""

import numpy as np
import pytest
from mpmath import exp, mpf, workdps

from gfmd_numba import kernels
from gfmd_numba.interface import vector_slip
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from support.kernel_twins import both

LAW = XuNeedlemanLaw(0.3, 0.2, 0.4)
GAP, X, Y = (each.ravel() for each in np.meshgrid(np.linspace(-0.21, 1.0, 7), np.linspace(-0.8, 0.8, 7), [0.0, 0.3]))


def energy(gap, x, y):
    """Energy of gaps and slips, independent of the law's own lengths of slip."""
    g, overlap = np.maximum(gap, 0.0) / 0.2, np.minimum(gap, 0.0) / 0.2
    return 0.3 * (1.0 - (1.0 + overlap) * np.exp(-overlap) - (1.0 + g) * np.exp(-g - (x * x + y * y) / 0.16))


def tractions(gap, x, y):
    """Tractions along x, y and towards the punch."""
    slip = np.stack((x, y))
    drag = vector_slip.tangential_traction(LAW, gap, slip)
    return np.stack((*drag, LAW.normal_traction(gap, vector_slip.length(slip))))


def test_tractions_are_derivatives_of_the_energy_by_gap_and_both_slips():
    h, state = 1e-6, np.stack((GAP, X, Y))
    found = tractions(*state)
    for row, component in zip((2, 0, 1), np.eye(3)[:, :, np.newaxis], strict=True):
        slope = (energy(*(state + h * component)) - energy(*(state - h * component))) / (2.0 * h)
        np.testing.assert_allclose(found[row], slope, atol=1e-9)


def test_second_derivatives_are_those_of_the_tractions():
    h, state = 1e-6, np.stack((GAP, X, Y))
    xx, xy, yy, xz, yz, zz = LAW.stiffness(GAP, np.stack((X, Y)))
    expected = [(zz, xz, yz), (xz, xx, xy), (yz, xy, yy)]
    for row, component in zip(expected, np.eye(3)[:, :, np.newaxis], strict=True):
        change = (tractions(*(state + h * component)) - tractions(*(state - h * component))) / (2.0 * h)
        for found, slope in zip(row, change[[2, 0, 1]], strict=True):
            np.testing.assert_allclose(found, slope, atol=1e-8)


@pytest.mark.parametrize("step", [1.0, 1e-6, 1e-14])
def test_the_change_of_the_energy_does_not_cancel(step):
    """Against mpmath, also from no slip at all and back to none."""
    rng = np.random.default_rng(2)
    gap, slip = rng.uniform(-0.3, 1.0, 60), rng.normal(size=(2, 60))
    closing, dragged = 0.3 * step * rng.normal(size=60), step * rng.normal(size=(2, 60))
    slip[:, :10], dragged[:, 10:20] = 0.0, slip[:, 10:20]

    def exact(i):
        with workdps(60):
            g, x, y, c, a, b = (mpf(float(each[i])) for each in (gap, *slip, closing, *dragged))

            def of(g, x, y):
                g = g / mpf(0.2)
                opened, overlap = max(g, 0), min(g, 0)
                decay = exp(-opened - (x**2 + y**2) / mpf(0.4) ** 2)
                return 1 - (1 + overlap) * exp(-overlap) - (1 + opened) * decay

            return float(mpf(0.3) * (of(g - c, x - a, y - b) - of(g, x, y)))

    found = LAW.energy_change(gap, slip, closing, dragged)
    np.testing.assert_allclose(found, [exact(i) for i in range(60)], rtol=1e-7, atol=1e-14 * step)


@pytest.mark.parametrize("kernel", both(kernels.xu_needleman_pull))
def test_the_kernel_of_maps_is_the_law(kernel):
    rng = np.random.default_rng(0)
    rows, active, n = 3, np.array([0, 2]), 13
    u, ku = rng.normal(size=(2, rows, 3, 16))
    punch, dragged = rng.normal(size=(rows, 16)), rng.normal(size=(2, n))
    expected = ku.copy()
    for i in active:
        gap, slip = punch[i, :n] - u[i, 2, :n], dragged - u[i, :2, :n]
        expected[i, :, :n] -= tractions(gap, *slip)
    kernel(kernels.SurfaceState(u, ku, punch, np.zeros(rows), u[:, :2]), punch, dragged, active, n, 0.3, 0.2, 0.4)
    np.testing.assert_allclose(ku, expected, rtol=1e-12)
