"""Thesis Fig. 3.5 and 3.7, and the xi/lambda below which mounds may be left out, as a number.

Usage: python benchmarks/surface_models.py PICTURE.png
"""

import sys

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

from gfmd_numba.roughness.spectra import ExponentialSpectrum, KCorrelationSpectrum, Mounded

MODELS = {"exponential": ExponentialSpectrum, "K-correlation": KCorrelationSpectrum}
COLOURS = dict(zip(MODELS, ("#0072B2", "#D55E00"), strict=True))
TOLERANCE = 0.1


def draw(path):
    figure = Figure((14.0, 7.0), dpi=120, layout="constrained")
    axes = figure.subplot_mosaic("AAAABBBBCCCC;DDDEEEFFFGGG")
    distance = np.linspace(1e-6, 4.0, 400)
    for name, hurst in zip("ABC", (1.0, 0.5, 0.1), strict=True):
        for label, model in MODELS.items():
            axes[name].semilogy(distance, model(1, hurst, 1.0).autocorrelation(distance), c=COLOURS[label], label=label)
        axes[name].set(title=f"Fig. 3.5, H = {hurst:g}", xlabel=r"$\rho/\xi$", ylabel=r"$R$", ylim=(1e-3, 1.0))
    q = np.linspace(0.0, 8.0, 400)
    for name, separation in zip("DEFG", (2.0, 8.0, 10.0, 12.0), strict=True):
        for label, model in MODELS.items():
            plain = model(1, 1.0, 1.0)
            axes[name].semilogy(q, plain.psd(q), "--", c=COLOURS[label], label=f"{label}, self-affine")
            axes[name].semilogy(q, Mounded(plain, separation).psd(q), c=COLOURS[label], label=f"{label}, mounded")
        title = rf"Fig. 3.7, $\xi$ = 1 µm, $\lambda$ = {separation:g} µm"
        axes[name].set(title=title, xlabel="q (1/µm)", ylabel=r"$C/w^2$ (µm)", ylim=(1e-5, 1.0))
    axes["A"].legend(frameon=False)
    axes["D"].legend(frameon=False, fontsize=8)
    figure.savefig(path)


def deviation(model, ratio, lowest):
    """Largest |ln(C_mounded / C)| from q = lowest/xi to 1000/xi."""
    q = np.geomspace(lowest, 1e3, 600)
    return abs(np.log(Mounded(model, 1.0 / ratio).psd(q) / model.psd(q))).max()


def largest_ratio(model, lowest):
    off = lambda ratio: deviation(model, ratio, lowest) - np.log1p(TOLERANCE)  # noqa: E731
    return brentq(off, 1e-3, 1.0, rtol=1e-3)


draw(sys.argv[1])
print("Largest xi/lambda at which the mounded spectrum is within 10 % of the self-affine one at every q from q_low to")
print("1000/xi, and the deviation at the thesis's xi/lambda = 0.1")
print("  d  model           H     all q >= 0.01/xi   all q >= 1/xi     at 0.1: all q    q >= 1/xi    q >= 10/xi")
for dimension in (1, 2):
    for label, kind in MODELS.items():
        for hurst in (0.3, 0.5, 0.8, 0.95):
            model = kind(dimension, hurst, 1.0)
            ratios = [largest_ratio(model, lowest) for lowest in (0.01, 1.0)]
            at = [np.expm1(deviation(model, 0.1, lowest)) for lowest in (0.01, 1.0, 10.0)]
            print(
                f"  {dimension}  {label:14} {hurst:4}  {ratios[0]:14.3f} {ratios[1]:18.3f}   "
                f"{at[0]:14.1%} {at[1]:12.1%} {at[2]:12.1%}"
            )
gaussian = ExponentialSpectrum(1, 1.0, 1.0)
print("Exponential, H = 1: C_mounded/C = exp(-(pi xi/lambda)^2) cosh(pi q xi^2/lambda) grows without bound:")
for ratio in (0.1, 0.05, 0.02):
    q = np.array([1.0, 5.0, 10.0])
    ratios = Mounded(gaussian, 1.0 / ratio).psd(q) / gaussian.psd(q)
    print(f"  xi/lambda = {ratio}: " + ", ".join(f"{r:.3g} at q = {k:g}/xi" for r, k in zip(ratios, q, strict=True)))
