"""Thesis Fig. 3.12 and Tab. 3.2: cold-rolled aluminium after Plouraboué, from lambda_r = 50 um down to 50 nm.

The table's H = 0.7 and the text's H = 0.65 are both made. Usage: python benchmarks/cold_rolled_aluminium.py PICTURE.png
"""

import sys

import numpy as np
from matplotlib.figure import Figure
from self_affine_spectrum import SelfAffineSpectrum

from gfmd_numba.roughness import model_surfaces, statistics

RMS_HEIGHT, ROLL_OFF, SURFACES = 0.3, 50.0, 200  # um, um
# L_x, points, lambda_s, longest wavelength (um); 50: no waves beyond the roll-off in place of a plateau
CASES = ((100.0, 4096, 0.05, 100.0), (100.0, 4096, 0.05, 50.0), (10.0, 8192, 0.05, 10.0), (10.0, 8192, 0.01, 10.0))

figure = Figure((12.0, 4.0), dpi=120, layout="constrained")
axes = figure.subplots(1, 2)
print(f"{SURFACES} surfaces each, scaled to w = 0.3 um; spread is the standard deviation of one surface")
print("   L_x   points  lambda_s  longest   H asked   H fitted          w      rms gradient     sigma(theta) rad")
for period, nx, cut_on, longest in CASES:
    for hurst in (0.65, 0.7):
        roll_off = min(ROLL_OFF, period)  # beyond the period there are no waves
        model = SelfAffineSpectrum(1, hurst, cut_on, roll_off, longest)
        largest = min((nx - 1) // 2, int(period / cut_on * (1 + 1e-9)))
        power = model_surfaces.psd_power(model, nx, largest, period)
        heights = model_surfaces.surfaces(power, nx, largest, 2018, range(SURFACES))
        heights = statistics.scaled(heights, (period,), rms_height=RMS_HEIGHT)
        ends = (2 * np.pi / roll_off, 2 * np.pi * largest / period)
        fitted = np.array([statistics.hurst_exponent(h, *ends, (period,))[0] for h in heights])
        slope, angle = statistics.rms_gradient(heights, (period,)), statistics.typical_slope(heights, period)
        print(
            f"{period:4g} um {nx:7} {1e3 * cut_on:6g} nm {longest:5g} um {hurst:8}"
            f"   {fitted.mean():.3f} +- {fitted.std():.3f}   {statistics.rms_height(heights, (period,)).mean():.3f} um"
            f"   {slope.mean():.3f} +- {slope.std():.3f}   {angle.mean():.3f} +- {angle.std():.3f}"
        )
        if hurst == 0.65 and cut_on == 0.05 and longest == period:
            axis = axes[0 if period == 100 else 1]
            shown = slice(None, None, max(1, nx // 512))
            axis.plot((np.arange(nx) / nx * period)[shown], heights[0][shown], c="0.25", lw=0.9)
            axis.set(title=f"Fig. 3.12, $L_x$ = {period:g} µm, 512 points shown", xlabel="r (µm)", ylabel="h (µm)")
figure.savefig(sys.argv[1])
