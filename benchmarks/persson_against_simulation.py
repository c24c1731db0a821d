"""Persson's theory compared with simulated line contacts from light to full contact: areas and pressure distributions.

Contacts of 20 surfaces (L_x/lambda_l = 2, lambda_l/lambda_s = 512, lambda_s/2 dx = 8, so nx = 16384) on a half-space
and on slabs. Usage: persson_against_simulation.py PICTURE.png
"""

import sys

import numpy as np
from matplotlib.figure import Figure

from gfmd_numba.contact import evaluation, solution
from gfmd_numba.contact.problem import Problem
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.table import Options
from gfmd_numba.theory import persson

SURFACES, SEED = 20, 2018
HURSTS = {0.3: "#0072B2", 0.8: "#D55E00"}
BODIES = {
    "half-space": ElasticBody(None, None),
    "slab, a = 0.1, nu = 0.33": ElasticBody(0.33, 0.1),
    "slab, a = 0.02, nu = 0.49": ElasticBody(0.49, 0.02),
}
PRESSURES = (0.001, 0.003, 0.007, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0)
SHOWN = {0.02: 0, 0.1: 1, 0.5: 2}  # pressures whose distributions are drawn
LEVELS = np.linspace(0.0, 5.0, 51)


def press(hurst, body, load):
    """Measures of the contacts, the histogram of their pressures over s per node, and the mean squares of these."""
    numerics = Options("active_set_newton", residual=1e-8)
    surface = RandomSurface(SelfAffineWaves(hurst, 2, 1024), 16384, SEED)
    pressed = solution.solve(Problem(surface, body, Interactions(True), load, None, numerics), range(SURFACES))
    assert (pressed.equilibrium.status == 0).all()
    values = evaluation.measure(pressed)
    ratio = pressed.equilibrium.pressure / values["full_contact_rms_pressure"][:, np.newaxis]
    histogram = np.histogram(ratio[pressed.equilibrium.touching], LEVELS)[0] / (ratio.size * np.diff(LEVELS))
    return values, histogram, (pressed.equilibrium.pressure**2).mean(axis=1)


figure = Figure((14.0, 8.4), dpi=120, layout="constrained")
axes = figure.subplots(2, len(BODIES))
for (name, body), (areas, densities) in zip(BODIES.items(), axes.T, strict=True):
    for hurst, colour in HURSTS.items():
        print(f"\n{name}, H = {hurst}")
        print("     p*     p/s    a_r simulated     Persson   simulated/Persson    <p^2> simulated/Persson")
        drawn = []
        for load in PRESSURES:
            values, histogram, squares = press(hurst, body, load)
            s, area = values["full_contact_rms_pressure"], values["contact_area_fraction"]
            theory = persson.contact_area_fraction(load, s)
            error = area.std(ddof=1) / np.sqrt(SURFACES)
            ratio, spread = (area / theory).mean(), (area / theory).std(ddof=1) / np.sqrt(SURFACES)
            m = load / s  # the second moment of (4.9)
            moment = (
                squares / ((s**2 + load**2) * theory + load * s * np.sqrt(2 / np.pi) * np.exp(-(m**2) / 2))
            ).mean()
            print(
                f"  {load:5}  {load / s.mean():6.3f}  {area.mean():7.4f} +- {error:6.4f}   {theory.mean():7.4f}"
                f"   {ratio:8.3f} +- {spread:5.3f}   {moment:12.3f}"
            )
            drawn.append((load, area.mean(), error, theory.mean()))
            if load in SHOWN:
                densities.stairs(histogram, LEVELS, color=colour, alpha=0.9, lw=1.3)
                curve = persson.pressure_density(LEVELS, load / s.mean(), 1.0)
                densities.plot(LEVELS, curve, "--", color="0.25" if hurst == 0.3 else "0.6", lw=1.2)
        load, area, error, theory = np.transpose(drawn)
        areas.errorbar(load, area, error, fmt="o", ms=4.5, color=colour, capsize=2, label=f"H = {hurst}, simulated")
        areas.plot(load, theory, "--", color=colour, lw=1.3, label=f"H = {hurst}, Persson")
    areas.set(title=name, xscale="log", yscale="log", xlabel=r"$p^* = \bar p/(\bar g E^*)$", ylabel="$a_r$")
    densities.set(xlabel=r"$p/p_\mathrm{rms}$ of full contact", ylabel="density of pressures", ylim=(0, None))
axes[0, 0].legend(frameon=False)
axes[1, 0].set_title("p* = 0.02, 0.1, 0.5 (from below); dashed: Persson", fontsize=10)
figure.savefig(sys.argv[1])
