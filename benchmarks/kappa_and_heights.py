"""How much of the dependence of kappa on eps_t at H = 0.8 is that of the distribution of heights.

Self-affine surfaces of 1/eps_f = 256 and 1/eps_c = 4 are pressed to p* = 0.007, each also upside down, which turns its
skewness and keeps its spectrum. At each eps_t the mean kappa of such a pair is regressed on skewness^2 and kurtosis - 3
of its heights; where both are 0, the regression has kappa of Gaussian heights. Two ensembles: waves of Gaussian
amplitude, as everywhere else, and waves that all have their mean square, so that all surfaces have one spectrum and
differ in phases only. Short surfaces are the more, so that errors are alike.
Usage: kappa_and_heights.py [SURFACES AT EPS_T = 1]
"""

import sys

import numpy as np
from scipy.stats import kurtosis, skew

from gfmd_numba.contact import evaluation
from gfmd_numba.contact.state import Contact
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.roughness.amplitudes import complex_gaussian
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options

HURST, PRESSURE, SHORTEST, RESOLUTION, SEED = 0.8, 0.007, 256, 4, 2018
PERIODS = (1, 2, 4, 8, 16)  # L_x/lambda_l
BLOCK = 2**18  # nodes solved at once
RESAMPLED = 300


def gaussian(hurst, cut_on, cut_off, nx, seed, realisations):
    """Self-affine profiles with random amplitudes."""
    return self_affine.SelfAffineWaves(hurst, cut_on, cut_off).heights((nx,), seed, realisations)


def phases(hurst, cut_on, cut_off, nx, seed, realisations):
    """Surfaces as `gaussian` has them, but with waves of equal amplitude in all of them."""
    index = np.arange(1, cut_off + 1)
    envelope = np.maximum(index, cut_on) ** -(0.5 + hurst)
    envelope /= np.sqrt(2.0 * np.sum((2.0 * np.pi * index * envelope) ** 2))
    spectrum = np.zeros((len(realisations), nx // 2 + 1), dtype=complex)
    for row, realisation in zip(spectrum, realisations, strict=True):
        waves = complex_gaussian(seed, realisation, cut_off)
        row[index] = envelope * waves / abs(waves)
    return grid.signal(spectrum, nx)


def kappa(heights):
    punch = heights.max(axis=1, keepdims=True) - heights
    numerics = Options("active_set_newton", residual=1e-8)
    half_space = stiffness.half_space(grid.wavenumbers(heights.shape[1]))
    found = equilibrate(
        punch, SpectralResponse.of_normal(half_space), PRESSURE, numerics, Interactions(True), None, 0.0
    )
    assert (found.status == 0).all()
    return evaluation.measure(Contact(heights, punch, found))["kappa"]


def pairs(make, periods, surfaces):
    """Kappa of each surface and of it upside down, skewness and kurtosis of the first `[4, surface]`."""
    cut_off = SHORTEST * periods
    nx = 2 * cut_off * RESOLUTION
    rows = []
    for first in range(0, surfaces, BLOCK // nx):
        block = range(first, min(first + BLOCK // nx, surfaces))
        heights = make(HURST, periods, cut_off, nx, SEED, block)
        moments = skew(heights, axis=-1), kurtosis(heights, axis=-1, fisher=False)
        rows.append([kappa(heights), kappa(-heights), *moments])
    return np.concatenate(rows, axis=1)


def share(values, fitted):
    return 1.0 - ((values - fitted) ** 2).sum() / ((values - values.mean()) ** 2).sum()


def level(data):
    """Mean kappa and that of Gaussian heights `[2]`, both resampled `[RESAMPLED, 2]`, and the columns next to them."""
    up, down, skewness, kurtosis = data
    mean, turned = 0.5 * (up + down), 0.5 * (up - down)
    terms = np.column_stack([np.ones_like(mean), skewness**2, kurtosis - 3.0])

    def both(chosen):
        return mean[chosen].mean(), np.linalg.lstsq(terms[chosen], mean[chosen], rcond=None)[0][0]

    rng = np.random.default_rng(0)
    drawn = np.array([both(rng.integers(0, len(mean), len(mean))) for _ in range(RESAMPLED)])
    explained = share(mean, terms @ np.linalg.lstsq(terms, mean, rcond=None)[0])
    slope = (turned * skewness).sum() / (skewness**2).sum()
    nearly = mean[(abs(skewness) < 0.25) & (abs(kurtosis - 3.0) < 0.3)]
    of_nearly = f"{nearly.mean():.3f} ± {nearly.std(ddof=1) / np.sqrt(len(nearly)):.3f}" if len(nearly) >= 20 else "-"
    columns = (
        f"{kurtosis.mean():.2f} ± {kurtosis.std():.2f}   {skewness.std():.2f}   {explained:5.1%}   {slope:6.3f}   "
        f"{share(turned, slope * skewness):5.1%}   {len(mean):5} {len(nearly):4}   {of_nearly}"
    )
    return np.array(both(slice(None))), drawn, columns


def main(surfaces=8000):
    for name, make in (("Gaussian amplitudes", gaussian), ("one spectrum, random phases", phases)):
        print(f"\n{name}\n1/eps_t, kappa, of Gaussian heights, kurtosis, rms skewness, share of the scatter explained,")
        print("d kappa/d skewness, share of what turning does, surfaces, the nearly Gaussian among them, their kappa")
        levels = {}
        for periods in PERIODS:
            value, drawn, columns = levels[periods] = level(pairs(make, periods, surfaces // periods))
            errors = drawn.std(axis=0)
            cells = "".join(f"   {v:.3f} ± {error:.3f}" for v, error in zip(value, errors, strict=True))
            print(f"{periods:7}{cells}   {columns}", flush=True)
        last, drawn_last, _ = levels[PERIODS[-1]]
        for periods in PERIODS[:2]:
            change, changes = levels[periods][0] - last, levels[periods][1] - drawn_last
            part, parts = 1.0 - change[1] / change[0], 1.0 - changes[:, 1] / changes[:, 0]
            print(
                f"1/eps_t = {periods} less {PERIODS[-1]}: {change[0]:.3f} ± {changes[:, 0].std():.3f}, of Gaussian "
                f"heights {change[1]:.3f} ± {changes[:, 1].std():.3f}: heights explain {part:.0%} ± {parts.std():.0%}"
            )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
