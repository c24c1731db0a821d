"""Thesis Fig. 3.11, and the curve it left open: the L_x/xi a Gaussian height distribution needs, against H.

A profile counts as Gaussian if the cumulative distribution of its heights is nowhere further than 0.02 from that of a
Gaussian of its own mean and rms height, in the mean over profiles. The distance falls as (L_x/xi)^-1/2, so that half of
it takes four times the length. Usage: height_distribution.py PICTURE.png
"""

import sys

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import kstest, norm, normaltest, skew, zscore
from self_affine_spectrum import SelfAffineSpectrum

from gfmd_numba.roughness import model_surfaces
from gfmd_numba.roughness.spectra import ExponentialSpectrum, KCorrelationSpectrum

DISTANCE, SURFACES, PER_LENGTH = 0.02, 200, 64
RATIOS = (25, 50, 100, 200, 400, 800)
HURSTS = (0.1, 0.2, 0.4, 0.6, 0.8, 1.0)
KINDS = {
    "plateau beyond $\\lambda_r$, $\\xi = \\lambda_r$": lambda h, n: SelfAffineSpectrum(1, h, 2 / PER_LENGTH, 1.0, n),
    "exponential model, $\\xi$ of (3.10)": lambda h, n: ExponentialSpectrum(1, h, 1.0),
    "K-correlation model, $\\xi$ of (3.13)": lambda h, n: KCorrelationSpectrum(1, h, 1.0),
}
COLOURS = ("#0072B2", "#D55E00", "#009E73")


def profiles(kind, hurst, ratio, seed):
    """Profiles of period ratio * xi, and the autocorrelation of the ensemble."""
    nx, largest = ratio * PER_LENGTH, ratio * PER_LENGTH // 2 - 1
    power = model_surfaces.psd_power(KINDS[kind](hurst, float(ratio)), nx, largest, float(ratio))
    return model_surfaces.surfaces(power, nx, largest, seed, range(SURFACES)), model_surfaces.periodic_autocorrelation(
        power, nx
    )


def distances(heights):
    """Largest difference of the cumulative distribution of each profile from a Gaussian one."""
    return kstest(zscore(heights, axis=-1), "norm", axis=-1, method="asymp").statistic


def needed(kind, hurst):
    """L_x/xi for a mean distance of 0.02 and its standard error; the exponent; skewness over theory; the distances.

    The skewness of a Gaussian profile scatters by sqrt(6 <R^3>), <R^3> the mean over the period.
    """
    found, theory, errors = [], [], []
    for i, ratio in enumerate(RATIOS):
        heights, correlation = profiles(kind, hurst, ratio, 100 + i)
        distance = distances(heights)
        found.append(distance.mean())
        errors.append(distance.std(ddof=1) / np.sqrt(SURFACES) / distance.mean())
        cubed = ((correlation / correlation[0]) ** 3).mean()
        theory.append(skew(heights, axis=-1).std() / np.sqrt(6 * cubed))
    found, errors = np.array(found), np.array(errors)
    fit, covariance = np.polyfit(np.log(RATIOS), np.log(found), 1, w=1 / errors, cov="unscaled")
    log_needed = (np.log(DISTANCE) - fit[1]) / fit[0]
    gradient = np.array([-log_needed, -1.0]) / fit[0]
    error = np.sqrt(gradient @ covariance @ gradient) * np.exp(log_needed)
    return np.exp(log_needed), error, fit[0], theory, found


figure = Figure((15.0, 4.6), dpi=120, layout="constrained")
axes = figure.subplots(1, 3)
plateau = next(iter(KINDS))
level = np.linspace(-4, 4, 61)
for axis, hurst in zip(axes, (0.4, 0.8), strict=False):
    print(f"Fig. 3.11, H = {hurst}: distance from a Gaussian (mean of {SURFACES} profiles), rejected at 5 %")
    for ratio, colour in zip((10, 20, 100, 400), ("#CC79A7", "#E69F00", "#56B4E9", "#000000"), strict=True):
        heights, _ = profiles(plateau, hurst, ratio, 1)
        density = np.histogram(zscore(heights, axis=-1)[0], level, density=True)[0]
        axis.stairs(density, level, color=colour, label=rf"$L_x/\xi$ = {ratio}")
        rejected = ""
        if ratio >= 20:
            rejected = f"{(normaltest(heights[:, ::PER_LENGTH], axis=-1).pvalue < 0.05).mean():.1%}"
        print(f"  L_x/xi = {ratio:4}: {distances(heights).mean():.4f}   {rejected}")
    axis.plot(level, norm.pdf(level), "--", color="#D55E00", label="Gaussian")
    axis.set(title=f"Fig. 3.11, H = {hurst}", xlabel="h/w", ylabel="p(h) w")
axes[0].legend(frameon=False)
print(f"\nL_x/xi needed for a mean distance of {DISTANCE}, from L_x/xi = {RATIOS}")
print("  model                                     H     L_x/xi needed     exponent   skewness: scatter over theory")
for kind, colour in zip(KINDS, COLOURS, strict=True):
    rows = []
    for hurst in HURSTS:
        value, error, exponent, theory, found = needed(kind, hurst)
        at = np.interp(400, RATIOS, found)
        rows.append((hurst, value, error))
        ratios = " ".join(f"{t:.2f}" for t in theory)
        print(f"  {kind:40} {hurst:4}   {value:7.0f} +- {error:4.0f}   {exponent:8.3f}    {ratios}   D(400) = {at:.4f}")
    h, values, errors = np.transpose(rows)
    axes[2].errorbar(h, values, errors, fmt="o-", ms=4, capsize=3, color=colour, label=kind)
axes[2].set(title=f"distance {DISTANCE}", xlabel="Hurst exponent H", ylabel=r"$L_x/\xi$ needed", yscale="log")
axes[2].legend(frameon=False, fontsize=8)
figure.savefig(sys.argv[1])
