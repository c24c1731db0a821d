"""Figs 6.7-6.13: stiffness of the modes of a slab loaded in one direction, and the softest; PNG path as argument."""

import sys

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import slab_stiffness
import slowest_mode

from gfmd_numba.elasticity import moduli
from gfmd_numba.theory import damping

Q1 = 2 * np.pi  # k = 1
HEIGHTS = np.geomspace(0.01, 10, 121)
COLUMN = HEIGHTS[:, None]
S = np.linspace(0.005, 0.97, 120)
DIRECTIONS = ("tangential", "normal")
SYMBOLS = (r"\kappa_1", r"\kappa_3")
COLOURS = ("tab:orange", "tab:blue")


def poissons_ratio(s):
    return 1 - 0.5 / (1 - s)  # (6.51)


def contours(axis, x, heights, values, title, label="$s$"):
    """Contours of log10 of a normalised stiffness."""
    levels = np.arange(-1.0, 4.01, 0.25)
    picture = axis.contourf(x, heights, np.log10(values), levels=levels, cmap="viridis", extend="both")
    label_plot(axis, title, xlabel=label, ylabel="$a$", yscale="log")
    return picture


def label_plot(axis, title, **properties):
    axis.set(**properties)
    axis.set_title(title, fontsize=9)


def uniform_modes(axes):
    c44 = moduli.c44(poissons_ratio(S))
    nu = np.linspace(-0.9, 0.49, 121)
    for i, symbol in enumerate(SYMBOLS):
        values = slab_stiffness.uniform_stiffness(poissons_ratio(S), COLUMN)[i] / c44
        picture = contours(axes[i], S, HEIGHTS, values, rf"6.7 uniform: $\log_{{10}} {symbol} L_x/C_{{44}}$")
        values = slab_stiffness.uniform_stiffness(nu, COLUMN)[i] / (1 - nu**2)  # over E, in E*
        contours(axes[2 + i], nu, HEIGHTS, values, rf"6.7 uniform: $\log_{{10}} {symbol} L_x/E$", r"$\nu$")
    return picture


def half_space(axis):
    """Unit modulus and L_x = nx grid spacings, the units of 6.5.1; the printed units are not stated fully."""
    dt = np.geomspace(0.01, 10, 100)
    for nx in (512, 2048, 8192):
        axis.loglog(dt, damping.critical_damping(np.pi / nx, dt), label=f"$E^* = 1$, $L_x = {nx}$")
    label_plot(axis, "6.8 half-space, normal", xlabel=r"$\Delta t$", ylabel=r"$\eta_\mathrm{cr}$")
    axis.legend(fontsize=7)


def incompressible(axis):
    heights = np.geomspace(0.03, 4, 400)
    first = Q1 * slab_stiffness.condensed_elements(Q1 * heights, 0.5)[1]
    softest = np.array([slowest_mode.incompressible_slab(a).stiffness for a in heights])
    axis.loglog(heights, first, label="$k = 1$ (6.74)")
    axis.loglog(heights, softest, "k--", label="softest of all $k$")
    axis.axhline(np.pi, color="0.7", label="half-space")
    label_plot(axis, "6.9 incompressible slab, normal", xlabel="$a$", ylabel=r"$\kappa L_x/E^*$")
    axis.legend(fontsize=7)
    print("6.9   a                 ", "".join(f"{a:10}" for a in (0.05, 0.1, 0.25, 0.5, 1.0, 2.0)))
    rows = [
        (Q1 * slab_stiffness.condensed_elements(np.array(Q1 * a), 0.5)[1], slowest_mode.incompressible_slab(a))
        for a in (0.05, 0.1, 0.25, 0.5, 1.0, 2.0)
    ]
    print("      kappa(1) L_x/E*   ", "".join(f"{first:10.4f}" for first, _ in rows))
    print("      softest wave      ", "".join(f"{mode.stiffness:10.4f}" for _, mode in rows))
    print("      its index         ", "".join(f"{mode.wave_index:10}" for _, mode in rows))
    print(f"      k = 1 is not the softest below a = {heights[softest < first * (1 - 1e-9)].max():.3f}")


def first_waves(axes):
    nu = poissons_ratio(S)
    for i, symbol in enumerate(SYMBOLS):
        values = Q1 * slab_stiffness.condensed_elements(Q1 * COLUMN, nu)[i] / moduli.c44(nu)
        title = rf"6.10 {DIRECTIONS[i]} load, $k = 1$: $\log_{{10}} {symbol} L_x/C_{{44}}$"
        picture = contours(axes[i], S, HEIGHTS, values, title)
    return picture


def first_over_uniform(axis):
    heights, printed = np.geomspace(0.005, 2, 200), np.array([0.01, 0.1, 0.5, 1.0])
    print("6.11  kappa(1)/kappa(0) at a =", "".join(f"{a:10}" for a in printed))
    for s, direction in ((0.5, 0), (0.5, 1), (0.0, 0)):  # the fourth, s = 0 and normal, is zero: the slab is rigid
        nu = poissons_ratio(s)
        curves = [
            Q1
            * slab_stiffness.condensed_elements(Q1 * a, nu)[direction]
            / slab_stiffness.uniform_stiffness(nu, a)[direction]
            for a in (heights, printed)
        ]
        axis.loglog(heights, curves[0], label=f"{DIRECTIONS[direction]}, $s = {s:g}$")
        print(f"      {DIRECTIONS[direction]:10}  s = {s:<8}  ", "".join(f"{value:10.4f}" for value in curves[1]))
    axis.axhline(1, color="0.7")
    label_plot(axis, "6.11 first wave over uniform mode", xlabel="$a$", ylabel=r"$\kappa(k=1)/\kappa(k=0)$")
    axis.legend(fontsize=7)


def switches(axis):
    heights, s = np.geomspace(0.005, 5, 401), np.linspace(0.002, 0.995, 400)
    coarse_a, coarse_s = heights[::8], np.linspace(0.01, 0.985, 60)
    for i, case in enumerate(("f1", "f3")):
        axis.contour(s, heights, slowest_mode.switch(case, heights[:, None], s), levels=[0.0], colors=COLOURS[i])
        axis.plot([], [], color=COLOURS[i], label=f"$f_{case[1]}(a, s) = 0$: {DIRECTIONS[i]}")
        waves = [
            [slowest_mode.one_direction(poissons_ratio(x), a, DIRECTIONS[i]).wave_index > 0 for x in coarse_s]
            for a in coarse_a
        ]
        axis.contour(coarse_s, coarse_a, np.array(waves, dtype=float), levels=[0.5], colors=COLOURS[i], linestyles="--")
    axis.plot([], [], "k--", label="the same with all $k$")
    label_plot(
        axis, "6.12 softest: A a wave, B the uniform mode", xlabel="$s$", ylabel="$a$", yscale="log", ylim=(0.005, 5)
    )
    axis.legend(fontsize=7, loc="upper center")
    heights = np.geomspace(0.002, 3, 20001)
    print("6.12  a on the curve at s =", "".join(f"{x:8.3f}" for x in (0.05, 0.1, 0.2, 0.3, 0.6, 0.7, 0.8, 0.9, 0.95)))
    for case in ("f1", "f3"):
        crossings = []
        for x in (0.05, 0.1, 0.2, 0.3, 0.6, 0.7, 0.8, 0.9, 0.95):
            found = heights[1:][np.diff(np.sign(slowest_mode.switch(case, heights, x))) != 0]
            crossings.append(f"{found[-1]:8.4f}" if len(found) else "       -")
        print(f"      {case}                  ", "".join(crossings))


def softest(axes):
    heights, s = np.geomspace(0.01, 10, 61), np.linspace(0.01, 0.97, 61)
    for i, direction in enumerate(DIRECTIONS):
        modes = [[slowest_mode.one_direction(nu, a, direction).stiffness for nu in poissons_ratio(s)] for a in heights]
        values = np.array(modes) / moduli.c44(poissons_ratio(s))
        title = rf"6.13 softest, {direction} load: $\log_{{10}} \kappa_\mathrm{{cr}} L_x/C_{{44}}$"
        picture = contours(axes[i], s, heights, values, title)
    return picture


figure, axes = plt.subplots(3, 4, figsize=(15, 11), layout="constrained")
figure.colorbar(uniform_modes(axes[0]), ax=axes[0], fraction=0.03, pad=0.01)
figure.colorbar(first_waves(axes[1, 2:]), ax=axes[1], fraction=0.03, pad=0.01)
figure.colorbar(softest(axes[2, 2:]), ax=axes[2], fraction=0.03, pad=0.01)
half_space(axes[1, 0])
incompressible(axes[1, 1])
first_over_uniform(axes[2, 0])
switches(axes[2, 1])
for letter, x, y in (("A", 0.06, 0.02), ("B", 0.5, 0.1), ("A", 0.9, 0.02)):
    axes[2, 1].text(x, y, letter, weight="bold", ha="center")
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1], dpi=110)
