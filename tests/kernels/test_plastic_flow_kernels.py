"""Kernels of plastic flow against NumPy: the return to the yield surface, and waves below a surface."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from gfmd_numba import kernels
from gfmd_numba.kernels import Hardening, Waves
from support.kernel_twins import both

VOCE = Hardening(1.0, 0.1, 0.5, 0.05)


def yield_stress(hardening, equivalent):
    stress, slope, rise, strain = hardening
    return stress + slope * equivalent - rise * np.expm1(-equivalent / strain)


def returned(strain, before, equivalent, hardening, shear):
    """Plastic strains `[3, 3]` of one point, with the equivalent one found by bisection."""
    trial = 2.0 * shear * (strain - before)
    size = np.sqrt(1.5 * (trial**2).sum())
    if size <= yield_stress(hardening, equivalent):
        return before

    def excess(added):
        return size - 3.0 * shear * added - yield_stress(hardening, equivalent + added)

    added = brentq(excess, 0.0, size / (3.0 * shear), xtol=1e-15)
    return before + 1.5 * added * trial / size


def tensor(components):
    xx, zz, xz, xy, yz = (*components, 0.0, 0.0)[:5]
    return np.array([[xx, xy, xz], [xy, -xx - zz, yz], [xz, yz, zz]])


@pytest.mark.parametrize("kernel", both(kernels.return_to_yield))
@pytest.mark.parametrize("hardening", [Hardening(1.0), Hardening(1.0, 0.3), VOCE], ids=["perfect", "linear", "voce"])
@pytest.mark.parametrize("components", [3, 5])
def test_strains_return_to_the_yield_surface(kernel, hardening, components):
    rng, shear = np.random.default_rng(1), 0.35
    strain, before = 2.0 * rng.normal(size=(components, 40)), 0.5 * rng.normal(size=(components, 40))
    strain[:, ::4] = before[:, ::4] + 0.1 * strain[:, ::4]
    equivalent = np.where(rng.random(40) < 0.5, 0.0, rng.random(40))
    found = strain.copy()
    kernel(found, before, equivalent, hardening, shear)
    for i in range(40):
        expected = returned(tensor(strain[:, i]), tensor(before[:, i]), equivalent[i], hardening, shear)
        np.testing.assert_allclose(tensor(found[:, i]), expected, rtol=1e-12, atol=1e-12)
    assert 0 < np.count_nonzero((found == before).all(axis=0)) < 40  # some points stay elastic


class Below:
    """Waves of one wave number below a surface, as the first-order system y' = N y + F tau for (U, W, S, T, V, S_2)."""

    def __init__(self, nu):
        mu, ratio, soft = (1.0 - nu) / 2.0, nu / (1.0 - nu), (1.0 - 2.0 * nu) / (1.0 - nu) ** 2
        self.mu, self.ratio, self.soft = mu, ratio, soft
        self.system = np.zeros((6, 6))
        for place, value in {
            (0, 1): -1.0,
            (0, 2): 1.0 / mu,
            (1, 0): ratio,
            (1, 3): soft,
            (2, 0): 1.0,
            (2, 3): -ratio,
            (3, 2): 1.0,
            (4, 5): 1.0 / mu,
            (5, 4): mu,
        }.items():
            self.system[place] = value

    def strains(self, q, angle, thickness, tau, pressure):
        """Mean strains and normal stresses of each sublayer, and the displacement out of the surface."""
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        turned = [turn @ tensor(each) @ turn.T for each in tau.T]
        sources = [
            np.array([t[0, 2] * 1j / self.mu, self.soft * t[2, 2], t[0, 0] - self.ratio * t[2, 2], 0.0, 0.0, t[0, 1]])
            + np.array([0.0, 0.0, 0.0, 0.0, t[1, 2] * 1j / self.mu, 0.0])
            for t in turned
        ]
        through, gained, pieces = np.eye(6), np.zeros(6, complex), []
        for h, source in zip(q * thickness, sources, strict=True):
            whole = np.zeros((7, 7), dtype=complex)
            whole[:6, :6], whole[:6, 6] = self.system, source
            pieces.append((h, whole))
            step = expm(h * whole)
            through, gained = step[:6, :6] @ through, step[:6, :6] @ gained + step[:6, 6]
        # nothing grows below: (N + 1)^2 y = 0 there
        fades = np.linalg.matrix_power(self.system + np.eye(6), 2)
        y = np.zeros(6, complex)
        y[3] = -pressure
        free = [0, 1, 4]
        y[free] = np.linalg.lstsq(fades @ through[:, free], -fades @ (through @ y + gained), rcond=None)[0]
        out, found = -y[1] / q, []
        for (h, whole), t in zip(pieces, turned, strict=True):
            twice = np.block([[whole, np.eye(7)], [np.zeros((7, 7)), whole * 0.0]])
            step, start = expm(h * twice), np.append(y, 1.0)
            u, _, s13, s33, v, s23 = (step[:7, 7:] @ start)[:6] / h
            y = (step[:7, :7] @ start)[:6]
            e = np.zeros((3, 3), dtype=complex)
            e[0, 0], e[2, 2] = -u, self.ratio * u + self.soft * (s33 + t[2, 2])
            e[0, 2] = e[2, 0] = -0.5j * (s13 + 1j * t[0, 2]) / self.mu
            e[0, 1] = e[1, 0] = -0.5 * v
            e[1, 2] = e[2, 1] = -0.5j * (s23 + 1j * t[1, 2]) / self.mu
            e = turn.T @ (e - np.eye(3) * np.trace(e) / 3.0) @ turn
            found.append([e[0, 0], e[2, 2], e[0, 2], e[0, 1], e[1, 2], s33])
        return np.transpose(found), out


@pytest.mark.parametrize("nu", [-0.4, 0.0, 0.3, 0.5])
@pytest.mark.parametrize(("q", "angle"), [(0.01, 2.0), (3.0, 0.7), (30.0, -1.1)])
def test_waves_are_those_of_the_first_order_system(nu, q, angle):
    rng, thickness = np.random.default_rng(2), np.array([0.1, 0.03, 0.2])
    tau = rng.normal(size=(5, 3)) + 1j * rng.normal(size=(5, 3))
    waves = Waves.of(*np.array([[q], [np.cos(angle)], [np.sin(angle)]]), thickness, nu, 0.5 * (1.0 - nu))
    found, surface, out = (np.zeros(shape, dtype=complex) for shape in ((6, 3, 1), (3, 1), (1,)))
    kernels.waves_upwards(tau[..., np.newaxis], waves, found, surface)
    kernels.reflect(surface, waves, out)
    pressure = 0.3 - 0.2j
    kernels.strains(tau[..., np.newaxis], np.array([pressure]), waves, found, surface)
    expected, _ = Below(nu).strains(q, angle, thickness, tau, pressure)
    np.testing.assert_allclose(found[..., 0], expected, atol=1e-9)
    np.testing.assert_allclose(out[0], Below(nu).strains(q, angle, thickness, tau, 0.0)[1], rtol=1e-9, atol=1e-12 / q)


@pytest.mark.parametrize("name", ["waves_upwards", "reflect", "strains"])
def test_compiled_waves_are_those_of_python(name):
    rng, n = np.random.default_rng(3), 4
    given = rng.random((3, n))
    given[0, :2] = -1.0, 0.0
    waves = Waves.of(*given, np.array([0.1, 0.2]), 0.3, 0.35)
    draws = [rng.normal(size=(5, 2, n)) + 1j * rng.normal(size=(5, 2, n)) for _ in range(2)]
    rows = rng.normal(size=(4, n)) + 1j * rng.normal(size=(4, n))
    results = []
    for kernel in (each.values[0] for each in both(getattr(kernels, name))):
        tau, found, surface, pressure = draws[0].copy(), draws[1].copy(), rows[:3].copy(), rows[3].copy()
        given = {
            "waves_upwards": (tau, waves, found, surface),
            "reflect": (surface, waves, pressure),
            "strains": (tau, pressure, waves, found, surface),
        }[name]
        kernel(*given)
        results.append((found, surface, pressure))
    for one, other in zip(*results, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-13, atol=1e-14)
