"""Fig. 6.4: dynamic regimes of two Verlet schemes, by lines and by the roots of a step; PNG path as argument."""

import sys

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import regimes

SCHEMES = {
    "position Störmer-Verlet": (regimes.position_verlet, "black"),
    "Grønbech-Jensen": (regimes.gronbech_jensen, "tab:blue"),
}
x, y = np.meshgrid(np.linspace(0, 5, 502)[1:], np.linspace(0, 4, 402)[1:])
figure, axes = plt.subplots(1, 3, figsize=(12, 4.4), layout="constrained", sharey=True)
line = np.linspace(0, 4, 401)
axes[0].plot(line, 2 * np.sqrt(line), color="tab:red", label="oscillator, $dt \\to 0$")
print("share of the plane 0 < K dt^2 <= 5, 0 < c dt <= 4 in each regime, and where the lines disagree with the roots")
for panel, (name, (scheme, colour)) in zip(axes[1:], SCHEMES.items(), strict=True):
    axes[0].plot(line, scheme.critical(line), color=colour, label=f"{name}, critical")
    limit = np.minimum(scheme.stability(line), 9.0)
    axes[0].plot([*line, 4.0], [*limit, 0.0], "--", color=colour, label=f"{name}, stability limit")
    names = regimes.regime(scheme.polynomial(x, y))
    index = np.select([names == r for r in regimes.Regime], range(3))
    panel.contourf(x, y, index, levels=[-0.5, 0.5, 1.5, 2.5], colors=["#cfe3f5", "#fde3c2", "#d9d9d9"])
    growth = regimes.growth(scheme.polynomial(x, y))
    levels = panel.contour(x, y, growth, levels=[0.2, 0.4, 0.6, 0.8, 0.9, 1.0], colors="black", linewidths=0.7)
    panel.clabel(levels, levels=levels.levels[:-1], fontsize=7)
    panel.set_title(f"{name}: growth factor of a step", fontsize=10)
    with np.errstate(invalid="ignore"):
        by_lines = np.select([(x > 4) | (y > scheme.stability(x)), y > scheme.critical(x)], [2, 1], 0)
    shares = "  ".join(f"{r} {np.mean(names == r):.3f}" for r in regimes.Regime)
    print(f"{name:24}  {shares}  disagreeing points {np.count_nonzero(by_lines != index)} of {index.size}")
axes[0].set_title("boundaries of the regimes", fontsize=10)
letters = dict(zip("ABC", ("under-damped", "over-damped", "unstable"), strict=True))
for panel, places in (
    (axes[1], [(1.2, 0.5), (0.35, 1.2), (3.3, 2.5)]),
    (axes[2], [(2.0, 0.62), (2.0, 3.4), (4.5, 2.0)]),
):
    for letter, place in zip(letters, places, strict=True):
        panel.text(*place, letter, ha="center", va="center", weight="bold")
axes[0].set(ylabel=r"$c\,dt = \eta\,dt^2$", ylim=(0, 4))
names = ", ".join(f"{letter} {name}" for letter, name in letters.items())
figure.legend(loc="outside lower center", ncols=5, fontsize=8, title=names, title_fontsize=9)
for axis in axes:
    axis.set(xlabel=r"$\kappa\,dt^2$", xlim=(0, 5))
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1], dpi=150)
