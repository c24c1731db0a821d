"""Figs 6.14-6.19: principal stiffnesses of the coupled half-space and slab, and the softest; PNG path as argument."""

import sys

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import slab_stiffness
import slowest_mode
import textbook

from gfmd_numba.elasticity import moduli

Q1 = 2 * np.pi  # k = 1
HEIGHTS = np.geomspace(0.01, 10, 121)
COLUMN = HEIGHTS[:, None]
S = np.linspace(0.005, 0.97, 120)
CASES = {"f1'": ("tab:green", r"$f_{1'}$"), "f3'": ("tab:blue", r"$f_{3'}$"), "f3''": ("tab:red", r"$f_{3''}$")}


def poissons_ratio(s):
    return 1 - 0.5 / (1 - s)  # (6.51)


def label_plot(axis, title, **properties):
    axis.set(**properties)
    axis.set_title(title, fontsize=9)


def contours(axis, s, heights, values, title):
    """Contours of log10 of a stiffness over C44/L_x."""
    levels = np.arange(-1.0, 4.01, 0.25)
    picture = axis.contourf(s, heights, np.log10(values), levels=levels, cmap="viridis", extend="both")
    label_plot(axis, title, xlabel="$s$", ylabel="$a$", yscale="log")
    return picture


def half_space(ratio_axis, axis):
    nu = poissons_ratio(S)
    a11, a13, _ = slab_stiffness.half_space_elements(nu)
    ratio_axis.semilogy(S, (a11 - a13) / (a11 + a13))
    label_plot(ratio_axis, "6.14 coupled half-space", xlabel="$s$", ylabel=r"$\kappa_{3'}/\kappa_{1'}$")
    nu = np.linspace(-0.9, 0.5, 200)
    a11, a13, _ = slab_stiffness.half_space_elements(nu)
    for value, name in ((a11 + a13, r"$\kappa_{1'}$"), (a11 - a13, r"$\kappa_{3'}$")):
        axis.plot(nu, Q1 * value / (1 - nu**2), label=name)
    label_plot(axis, "6.15 coupled half-space, $k = 1$", xlabel=r"$\nu$", ylabel=r"$\kappa L_x/E$", ylim=(0, 20))
    axis.legend(fontsize=8)
    print("6.15  nu        ", "".join(f"{x:9}" for x in (-0.5, 0.0, 0.2, 0.3, 0.4, 0.49, 0.5)))
    for sign, name in ((1, "kappa_1'"), (-1, "kappa_3'")):
        values = [
            Q1 * float(a + sign * b) / (1 - x**2)
            for x in (-0.5, 0.0, 0.2, 0.3, 0.4, 0.49, 0.5)
            for a, b, _ in [slab_stiffness.half_space_elements(x)]
        ]
        print(f"      {name} L_x/E", "".join(f"{value:9.4f}" for value in values))


def first_waves(axes):
    nu = poissons_ratio(S)
    smaller, larger = (Q1 * part / moduli.c44(nu) for part in textbook.principal_elements(Q1 * COLUMN, nu))
    for axis, values, name in ((axes[0], larger, "1'"), (axes[1], smaller, "3'")):
        picture = contours(axis, S, HEIGHTS, values, rf"6.16 $k = 1$: $\log_{{10}} \kappa_{{{name}}} L_x/C_{{44}}$")
    return picture


def first_over_uniform(axis):
    heights, printed = np.geomspace(0.005, 2, 300), np.array([0.01, 0.1, 0.5, 1.0])
    print("6.17  ratio at a =                          ", "".join(f"{a:10}" for a in printed))
    for s, colour in ((0.5, "tab:blue"), (0.0, "tab:orange")):
        nu = poissons_ratio(s)
        for part, name in ((1, "1'"), (0, "3'")):
            for mode in (0, 1) if s else (0,):  # for s = 0 the uniform normal mode is rigid: ratio 0
                style = ("-", "--")[mode] if part == 0 else (":", "-.")[mode]
                label = rf"$\kappa_{{{name}}}/\kappa_{2 * mode + 1}(0)$, $s = {s:g}$"
                ratio = [
                    Q1 * textbook.principal_elements(Q1 * a, nu)[part] / slab_stiffness.uniform_stiffness(nu, a)[mode]
                    for a in (heights, printed)
                ]
                axis.loglog(heights, ratio[0], style, color=colour, label=label)
                text = f"kappa_{name}(1)/kappa_{2 * mode + 1}(0), s = {s:g}"
                print(f"      {text:38}", "".join(f"{value:10.4f}" for value in ratio[1]))
    axis.axhline(1, color="0.7")
    label_plot(axis, "6.17 first wave over uniform mode", xlabel="$a$", ylabel="ratio", ylim=(0.5, 200))
    axis.legend(fontsize=6)


def switches(axis):
    heights, s = np.geomspace(0.005, 5, 401), np.linspace(0.002, 0.995, 400)
    for case, (colour, name) in CASES.items():
        axis.contour(s, heights, slowest_mode.switch(case, heights[:, None], s), levels=[0.0], colors=colour)
        axis.plot([], [], color=colour, label=f"{name}$(a, s) = 0$")
    axis.contour(s, heights, slowest_mode.switch("f3", heights[:, None], s), levels=[0.0], colors="0.6", linestyles=":")
    axis.plot([], [], ":", color="0.6", label="$f_3$ of Fig. 6.12")
    coarse_a, coarse_s = heights[::8], np.linspace(0.01, 0.985, 60)
    waves = [[slowest_mode.slab_coupled(nu, a).wave_index > 0 for nu in poissons_ratio(coarse_s)] for a in coarse_a]
    axis.contour(coarse_s, coarse_a, np.array(waves, dtype=float), levels=[0.5], colors="tab:red", linestyles="--")
    axis.plot([], [], "--", color="tab:red", label=CASES["f3''"][1] + " with all $k$")
    label_plot(axis, "6.18 first wave against uniform modes", xlabel="$s$", ylabel="$a$", yscale="log", ylim=(0.005, 5))
    axis.legend(fontsize=7, loc="upper center")
    columns = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
    heights = np.geomspace(0.002, 3, 20001)
    print("6.18  a on the curve at s =", "".join(f"{x:16.2f}" for x in columns))
    for case in CASES:
        crossings = []
        for x in columns:
            found = heights[1:][np.diff(np.sign(slowest_mode.switch(case, heights, x))) != 0]
            crossings.append(f"{', '.join(f'{a:.4f}' for a in found) or '-':>16}")
        print(f"      {case:4}                 ", "".join(crossings))


def softest(axis):
    heights, s = np.geomspace(0.01, 10, 61), np.linspace(0.01, 0.97, 61)
    nu = poissons_ratio(s)
    values = np.array([[slowest_mode.slab_coupled(x, a).stiffness for x in nu] for a in heights]) / moduli.c44(nu)
    ordinary = [slowest_mode.slab_coupled(x, a).wave_index for x in nu[s <= 0.5] for a in heights]
    print(f"6.19  softest mode for 0 <= nu <= 1/2 and 0.01 <= a <= 10: wave index {min(ordinary)} to {max(ordinary)}")
    return contours(axis, s, heights, values, r"6.19 softest: $\log_{10} \kappa_\mathrm{cr} L_x/C_{44}$")


figure, axes = plt.subplots(2, 4, figsize=(16, 7.5), layout="constrained")
half_space(axes[0, 0], axes[0, 1])
figure.colorbar(first_waves(axes[0, 2:]), ax=axes[0, 2:], fraction=0.03, pad=0.01)
first_over_uniform(axes[1, 0])
switches(axes[1, 1])
figure.colorbar(softest(axes[1, 2]), ax=axes[1, 2], fraction=0.06, pad=0.02)
axes[1, 3].remove()
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1], dpi=110)
