"""Thesis Fig. 3.9 and 3.10: the four generators against theory over 200 surfaces, their ranking, and what they cost.

Usage: python benchmarks/surface_generators.py PICTURE.png
"""

import sys
import time
from functools import partial

import numpy as np
from matplotlib.figure import Figure
from self_affine_spectrum import SelfAffineSpectrum

from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import model_surfaces, self_affine, statistics
from gfmd_numba.roughness.recursive import Recursion
from gfmd_numba.roughness.spectra import ExponentialSpectrum
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options

SURFACES, BATCHES = 200, 8
PERIOD, ROLL_OFF = 10.0, 5.0  # um
RECURSIVE = {"RMD": "midpoint_displacement", "SRA": "successive_addition"}
COLOURS = {"theory": "#000000", "PSDM": "#0072B2", "FFM": "#009E73", "RMD": "#D55E00", "SRA": "#E69F00"}


def recursion(name, dimension, hurst, nx):
    return Recursion(RECURSIVE[name], dimension, hurst, 2 / nx, ROLL_OFF / PERIOD)


def asked(dimension, hurst, nx):
    """Mean power of the spectrum with cut-on just below Nyquist, roll-off and plateau, of period 1."""
    model = SelfAffineSpectrum(dimension, hurst, 2 / (nx - 2), ROLL_OFF / PERIOD, 1.0)
    return model_surfaces.psd_power(model, nx, nx // 2 - 1)


def autocorrelations(heights):
    """Autocorrelation of each surface up to half a period, not normalised: its mean is that of the ensemble."""
    dimension = heights.ndim - 1
    power = statistics.power(heights, (1.0,) * dimension)
    power[(slice(None), *(0,) * dimension)] = 0.0
    found = np.array([model_surfaces.periodic_autocorrelation(p, heights.shape[-1]) for p in power])
    return np.array([statistics.radial_mean(r, (1.0,) * dimension)[1] for r in found])


def grid_sum(power, nx):
    """Sum over all waves, of which the layout of the transform keeps half."""
    return float((power * grid.multiplicity(nx)).sum())


def compare(name, dimension, hurst, nx, power, draw):
    """One line: deviation of the mean autocorrelation from theory, in w^2 and in sampling errors, in every batch."""
    power = power / grid_sum(power, nx) if name in RECURSIVE else power  # scaled to w = 1 over all waves
    periodic = model_surfaces.periodic_autocorrelation(power, nx)
    theory = statistics.radial_mean(periodic, (1.0,) * dimension)[1]
    seen = power > 1e-12 * power.max()
    means, noises, scores = [], [], []
    for seed in range(BATCHES):
        heights = draw(seed)
        found = autocorrelations(heights)
        means.append(found.mean(axis=0))
        noises.append(found.var(axis=0, ddof=1).mean() / SURFACES)
        squares = statistics.power(heights, (1.0,) * dimension).mean(axis=0)[seen]
        scores.append((squares / power[seen] - 1) * np.sqrt(SURFACES))
    deviations = ((np.array(means) - theory) ** 2).mean(axis=1)
    ratio = np.sqrt(deviations / noises)
    print(
        f"  {name:5} {dimension}  {hurst:4} {nx:6}   {np.sqrt(deviations.mean()):8.4f} {np.sqrt(np.mean(noises)):8.4f}"
        f"   {np.sqrt((ratio**2).mean()):6.2f} ({ratio.min():.2f} - {ratio.max():.2f})"
        f"   {(abs(np.array(scores)) < 2).mean():8.1%} {np.std(scores):9.2f}"
    )
    return theory / theory[0], np.mean(means, axis=0) / np.mean(means, axis=0)[0]


def ranking(axis):
    print(
        f"{BATCHES} batches of {SURFACES} surfaces: rms deviation of a batch's mean autocorrelation from theory, up to"
    )
    print(
        "half a period, its sampling error, their ratio in rms (least - largest); waves whose mean power is within two"
    )
    print("sampling errors (95 % if exact), scatter of all waves in sampling errors (1 if exact)")
    print("  name  d     H     nx   deviation    error     ratio              within 2 s   scatter")
    for dimension, nx in ((1, 4096), (2, 128)):
        largest = nx // 2 - 1
        for hurst in (0.3, 0.5, 0.9):
            power = asked(dimension, hurst, nx)
            draws = {"PSDM": partial(model_surfaces.surfaces, power, nx, largest)}
            draws |= {
                name: partial(recursion(name, dimension, hurst, nx).heights, (nx,) * dimension) for name in RECURSIVE
            }
            for name, draw in draws.items():
                batch = partial(draw, realisations=range(SURFACES))
                theory, mean = compare(name, dimension, hurst, nx, power, lambda seed, batch=batch: batch(seed=seed))
                if (dimension, hurst) == (1, 0.9):
                    axis.plot(np.arange(mean.size) / nx * PERIOD, mean, c=COLOURS[name], label=name)
            if (dimension, hurst) == (1, 0.9):
                axis.plot(np.arange(mean.size) / nx * PERIOD, theory, "--", c=COLOURS["theory"], label="theory")
            power = model_surfaces.filter_power(ExponentialSpectrum(dimension, hurst, 0.05), nx, largest)
            batch = partial(model_surfaces.surfaces, power, nx, largest, realisations=range(SURFACES))
            compare("FFM", dimension, hurst, nx, power, lambda seed, batch=batch: batch(seed=seed))
    axis.set(title=f"Fig. 3.10a, H = 0.9, mean of {BATCHES * SURFACES}", xlabel=r"$\rho$ (µm)", ylabel=r"$R(\rho)$")
    axis.legend(frameon=False)


def filtered(axis):
    """Fig. 3.10b: one profile of 2^19 points by both spectral methods, and the filter as (3.26) prints it."""
    nx, ratio = 2**19, 400
    distance = np.arange(nx // 2 + 1) / nx * ratio
    near = distance < 5
    print(f"Fig. 3.10b, one profile of 2^19 points, L_x/xi = {ratio}: rms deviation from theory up to 5 xi")
    for hurst, style in ((0.5, "-"), (1.0, "--")):
        model = ExponentialSpectrum(1, hurst, 1 / ratio)
        theory = model.autocorrelation(distance / ratio)
        axis.plot(distance[near], theory[near], style, c=COLOURS["theory"], label=f"theory, H = {hurst:g}")
        powers = {
            "PSDM": model_surfaces.psd_power(model, nx, nx // 2 - 1),
            "FFM": model_surfaces.filter_power(model, nx, nx // 2 - 1),
        }
        powers["R * R"] = powers["FFM"] ** 2
        for name, power in powers.items():
            heights = model_surfaces.surfaces(power, nx, nx // 2 - 1, 7, range(1))
            found = statistics.radial_mean(statistics.autocorrelation(heights)[0], (1.0,))[1]
            deviation = np.sqrt(((found - theory)[near] ** 2).mean())
            print(f"  H = {hurst}: {name:6} {deviation:.4f}")
            axis.plot(distance[near], found[near], style, c=COLOURS.get(name, "#CC79A7"), label=name, lw=1)
    axis.set(title="Fig. 3.10b, one profile", xlabel=r"$\rho/\xi$", ylabel="R")
    axis.legend(frameon=False, fontsize=8)


def maps(axes):
    nx, hurst, w = 1024, 0.9, 0.15
    print("Fig. 3.9, maps of 2^20 points: rms gradient along the row and kurtosis of its second differences")
    for axis, (name, _) in zip(axes, RECURSIVE.items(), strict=False):
        heights = recursion(name, 2, hurst, nx).heights((nx, nx), 1, range(1))
        heights = statistics.scaled(heights, (PERIOD,) * 2, rms_height=w)[0]
        axis.imshow(heights, extent=(0, PERIOD, 0, PERIOD), origin="lower", cmap="cividis")
        axis.set(title=f"Fig. 3.9a, {name}", xlabel="$r_1$ (µm)", ylabel="$r_2$ (µm)")
        row = heights[:, round(0.6 * nx)]
        r = np.arange(nx) / nx * PERIOD
        axes[2].plot(r, row, c=COLOURS[name], label=name, lw=0.9)
        axes[3].plot(r[512:612], row[512:612], c=COLOURS[name], label=name, lw=0.9)
        second = np.diff(heights, 2, axis=0)
        kurtosis = (second**4).mean() / (second**2).mean() ** 2
        print(f"  {name}: {statistics.rms_gradient(heights, (PERIOD,) * 2):.3f}   {kurtosis:.1f} (3 if stationary)")
    axes[2].set(title="Fig. 3.9b, profile at $r_1$ = 6 µm", xlabel="$r_2$ (µm)", ylabel="h (µm)")
    axes[3].set(title="Fig. 3.9c, part of it", xlabel="$r_2$ (µm)", ylabel="h (µm)")
    axes[2].legend(frameon=False)


def best(call, repeats=5):
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        call()
        times.append(time.perf_counter() - started)
    return min(times)


def costs():
    nx, n = 2**15, 30
    heights = self_affine.SelfAffineWaves(0.8, 2, nx // 4).heights((nx,), 1, range(n))
    punch = heights.max(axis=1, keepdims=True) - heights
    body = stiffness.half_space(grid.wavenumbers(nx))
    seconds = {}
    for solver in ("verlet", "conjugate_gradients"):
        numerics = Options(solver, max_iterations=20, residual=1e-12)
        equilibrate(punch[:1], SpectralResponse.of_normal(body), 0.05, numerics)
        seconds[solver] = best(
            lambda numerics=numerics: equilibrate(punch, SpectralResponse.of_normal(body), 0.05, numerics), 3
        )
    print(f"\n{n} profiles of 2^15 points on one core; 20 iterations take", end=" ")
    print(", ".join(f"{value * 1e3:.0f} ms ({solver})" for solver, value in seconds.items()))
    power = asked(1, 0.8, nx)
    exponential = model_surfaces.filter_power(ExponentialSpectrum(1, 0.8, 0.01), nx, nx // 2 - 1)
    calls = {
        "self_affine": lambda: self_affine.SelfAffineWaves(0.8, 2, nx // 4).heights((nx,), 1, range(n)),
        "PSDM": lambda: model_surfaces.surfaces(power, nx, nx // 2 - 1, 1, range(n)),
        "FFM": lambda: model_surfaces.surfaces(exponential, nx, nx // 2 - 1, 1, range(n)),
        "RMD": lambda: recursion("RMD", 1, 0.8, nx).heights((nx,), 1, range(n)),
        "SRA": lambda: recursion("SRA", 1, 0.8, nx).heights((nx,), 1, range(n)),
    }
    for name, call in calls.items():
        taken = best(call)
        ratios = ", ".join(f"{taken / value:.3f} ({solver})" for solver, value in seconds.items())
        print(f"  {name:12} {taken * 1e3:6.0f} ms, over 20 iterations: {ratios}")


figure = Figure((18.0, 8.0), dpi=110, layout="constrained")
axes = figure.subplots(2, 4).ravel()
costs()
maps(axes[:4])
ranking(axes[4])
filtered(axes[5])
for axis in axes[6:]:
    axis.set_visible(False)
figure.savefig(sys.argv[1])
