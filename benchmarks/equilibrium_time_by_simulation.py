"""Figs 6.20-6.23, Tabs 6.1 and 6.2, (6.105)-(6.108): the fastest damping by marching modes; PNG path as argument.

Modes start from the step (6.98), u = 0.01 / (1 + k) of L_x, and are marched until |u| <= 1e-16 L_x for good (6.99). The
damping with the least equilibrium time is searched; no analytic expression enters, they are printed for comparison.
Units are those of 6.5.1: lengths in grid spacings, L_x = nx, unit mass; E = 0.7 stands for 70 GPa (the unit of stress
is not stated; 100 GPa gives times as printed in Fig. 6.20).
"""

import sys

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import slab_stiffness
from equilibrium_time import fastest_damping_ratio, steps_to_equilibrium
from regimes import update_matrix

BASE = {"nx": 2048, "E": 0.7, "dt": 0.25, "nu": 0.2, "a": 1.0}
RANGES = {
    "nx": np.array([128, 256, 512, 1024, 2048]),
    "E": 0.7 * np.array([0.25, 0.5, 1, 2, 4]),
    "dt": np.array([0.125, 0.25, 0.5, 1.0]),
    "nu": np.array([0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.49]),
    "a": np.array([0.25, 0.5, 1, 2, 4]),
}
LABELS = {"nx": "$nx$", "E": "$E$", "dt": r"$\Delta t$", "nu": r"$\nu$", "a": "$a$"}
STEP, REST = 0.01, 1e-16  # in L_x


def waves(nx):
    """Every mode is marched in the thesis; under-damped ones decay alike, so these speak for all."""
    return np.array([1, 2, 3, 4, 8, 32, nx // 8, nx // 2])


def half_space(nx, E, dt):
    """Stiffness of the modes (6.67), E standing for E*, and where they start."""
    k = waves(nx)
    return (np.pi * k * E / nx)[:, None, None], STEP / (1 + k)[:, None], dt


def slab(nx, E, dt, nu, a):
    """The same for both components (6.57), (6.64); -i u_3 in place of u_3 makes the matrices real."""
    k, modulus = waves(nx), E / (1 - nu**2)
    q = 2 * np.pi * k / nx
    a11, a13, a33 = (modulus * q * m for m in slab_stiffness.slab_elements(q * a * nx, nu))
    uniform = modulus / nx * np.diag([float(m) for m in slab_stiffness.uniform_stiffness(nu, a)])
    of_modes = np.concatenate([uniform[None], np.moveaxis(np.array([[a11, a13], [a13, a33]]), -1, 0)])
    return of_modes, STEP / (1 + np.append(0, k))[:, None] * np.array([1, -1j]), dt


def steps(problem, eta, cap):
    """Steps to equilibrium of all modes for each damping `[..., component]`."""
    stiffness, start, dt = problem
    return steps_to_equilibrium(stiffness, eta[..., None, :], dt, start, REST, cap).max(axis=-1)


def fastest(problem):
    """Damping with the least equilibrium time, the steps it takes, and the range of eta_3 that costs below 0.5 %."""
    dt, components = problem[2], problem[1].shape[1]
    eta = np.geomspace(1e-4, 1, 61)[:, None] * np.ones(components) / dt**2
    cap = 256
    while (counts := steps(problem, eta, cap)).min() > cap:
        cap *= 2
    best = eta[counts.argmin()]
    axis = np.geomspace(0.7, 1.4, 25 if components == 2 else 81)
    grid = np.stack(np.meshgrid(*[axis] * components, indexing="ij"), -1).reshape(-1, components) * best
    counts = steps(problem, grid, int(1.2 * counts.min()))
    best = np.median(grid[counts == counts.min()], axis=0)
    if components == 2:
        low, high = plateau(problem, best[0], counts.min())
        best[1] = np.sqrt(low * high)
    # in eta_1 the minimum is a cliff: just right of it the first overshoot is still below the tolerance
    grid = np.repeat(best[None], 601, axis=0)
    grid[:, 0] *= np.geomspace(0.94, 1.06, 601)
    counts = steps(problem, grid, int(1.2 * counts.min()))
    best = np.median(grid[counts == counts.min()], axis=0)
    return best, counts.min(), plateau(problem, best[0], counts.min()) if components == 2 else None


def plateau(problem, one, count):
    """First and last eta_3 of the range around the least equilibrium time that costs less than 0.5 % of it."""
    third = one * np.geomspace(0.3, 30, 161)
    counts = steps(problem, np.stack([np.full(161, one), third], -1), int(1.2 * count))
    return third[counts <= 1.005 * counts.min()][[0, -1]]


def slope(x, y):
    return np.polyfit(np.log(x), np.log(y), 1)[0]


def label_plot(axis, title, x, y, ticks=()):
    axis.set(xlabel=x, ylabel=y)
    axis.set_title(title, fontsize=9)
    if len(ticks):
        axis.set_xticks(ticks, [f"{tick:g}" for tick in ticks], fontsize=8)
        axis.xaxis.set_minor_locator(mpl.ticker.NullLocator())


def map_of_times(axis, nu):
    """Fig. 6.20 at nx = 2048, a = 1, dt = 0.25."""
    dt = BASE["dt"]
    problem = slab(**BASE | {"nu": nu})
    one, three = np.linspace(0.04, 0.16, 41), np.geomspace(0.04, 0.8, 41)
    counts = steps(problem, np.stack(np.meshgrid(one, three), -1), 24000)
    picture = axis.contourf(one, three, counts * dt, levels=np.arange(2800, 5601, 200), extend="both")
    best, least, near = fastest(problem)
    roots = np.linalg.eigvals(update_matrix(problem[0], np.stack(np.meshgrid(one, three), -1)[:, :, None], dt))
    under = (abs(roots.imag) > 0).all(axis=(-1, -2))
    axis.contour(one, three, under.astype(float), levels=[0.5], colors="black", linewidths=1)
    axis.plot([], [], "k", lw=1, label="under-damped inside")
    axis.plot(*best, "wo", mfc="none", label="shortest")
    axis.plot([best[0]] * 2, near, "w", lw=1.5, label="within 0.5 % of it")
    stiff = np.diag(problem[0][0])
    critical = 2 * np.sqrt(stiff) / dt - stiff
    axis.axvline(critical[0], color="white", ls="--", lw=0.8, label=r"$\eta_\mathrm{cr}$ of (6.65)")
    axis.axhline(critical[1], color="white", ls="--", lw=0.8)
    axis.set_yscale("log")
    label_plot(axis, rf"6.20 $t_\mathrm{{eq}}$, $\nu = {nu}$", r"$\eta_1$", r"$\eta_3$")
    axis.legend(fontsize=7, loc="upper right", facecolor="0.4", labelcolor="white")
    time = least * dt
    print(
        f"6.20  nu = {nu}: t_eq = {time:.0f} = {time * np.sqrt(stiff[0]):.2f} / sqrt(kappa_1(0)) with eta_1 ="
        f" {best[0]:.4f}, eta_3 = {near[0]:.4f} to {near[1]:.4f}; (6.65): {critical.round(4)}"
    )
    return picture


def draw_times(axis, name, values, times, base):
    """Equilibrium time against one parameter over its base value: the slopes of Tabs 6.1 and 6.2."""
    axis.loglog(
        values / base[name], times, "o-", ms=4, lw=0.8, label=f"{LABELS[name]}, slope {slope(values, times):.3f}"
    )


def one_component(axes, count_axes, time_axes):
    """Fig. 6.21, Tab. 6.1, (6.105), (6.106), Fig. 6.22."""
    base = {name: BASE[name] for name in ("nx", "E", "dt")}
    print("6.21, Tab. 6.1: half-space, normal. eta_cr and t_eq fitted as powers; theory +-1/2 and -1, 0 for dt")
    for axis, name in zip(axes, base, strict=True):
        values = RANGES[name]
        results = [fastest(half_space(**base | {name: int(v) if name == "nx" else v})) for v in values]
        eta = np.array([best[0] for best, _, _ in results])
        dt = values if name == "dt" else base["dt"]
        times = np.array([count for _, count, _ in results]) * dt
        kappa = np.pi * (values if name == "E" else base["E"]) / (values if name == "nx" else base["nx"])
        axis.loglog(values, eta, "o", label=f"simulation, slope {slope(values, eta):.3f}")
        axis.loglog(values, 2 * np.sqrt(kappa) / dt - kappa, "k-", label="(6.69)")
        label_plot(axis, "6.21 half-space", LABELS[name], r"$\eta_\mathrm{cr}$", values)
        axis.legend(fontsize=7)
        ratio = eta / (2 * np.sqrt(kappa) / dt - kappa)
        print(
            f"  {name:3} eta_cr exponent {slope(values, eta):7.4f} ({ratio.min():.4f} to {ratio.max():.4f} of (6.69)),"
            f"  t_eq exponent {slope(values, times):7.4f}, t_eq sqrt(kappa) {(times * np.sqrt(kappa)).round(2)}"
        )
        if name == "dt":
            count_axes.loglog(values, times / dt, "o", label=f"half-space, slope {slope(values, times / dt):.3f}")
        draw_times(time_axes, name, values, times, base)


def two_components(axes, count_axes, time_axes):
    """Fig. 6.23, Tab. 6.2, (6.107), (6.108)."""
    print("6.23, Tab. 6.2: slab, both components, nu = 0.2 and a = 1 unless varied")
    for axis, name in zip(axes, RANGES, strict=True):
        values = RANGES[name]
        rows = []
        for value in values:
            case = BASE | {name: int(value) if name == "nx" else value}
            best, count, plateau = fastest(slab(**case))
            kappa = case["E"] / (2 * case["a"] * case["nx"] * (1 + case["nu"]))  # (6.66)
            critical = 2 * np.sqrt(kappa) / case["dt"] - kappa
            rows.append((best[0], best[1], *plateau, count * case["dt"], critical, count * case["dt"] * np.sqrt(kappa)))
        one, three, low, high, times, critical, scaled = np.transpose(rows)
        axis.fill_between(values, low, high, color="tab:orange", alpha=0.25, label=r"$\eta_3$ within 0.5 %")
        axis.plot(values, one, "o", label=rf"$\eta_1$, slope {slope(values, one):.3f}")
        axis.plot(values, three, "s", ms=4, label=rf"$\eta_3$, slope {slope(values, three):.3f}")
        axis.plot(values, critical, "k-", label="scalar (6.65)")
        axis.set(xscale="log", yscale="log")
        label_plot(axis, "6.23 slab", LABELS[name], r"$\eta$", values[:: 1 + len(values) // 6])
        axis.legend(fontsize=6)
        print(
            f"  {name:3} eta_1 exponent {slope(values, one):7.4f}, eta_3 {slope(values, three):7.4f}, t_eq"
            f" {slope(values, times):7.4f} (1/sqrt(kappa_1(0)): {slope(values, times / scaled):7.4f}),"
            f" eta_1 over (6.65) {(one / critical).min():.3f} to {(one / critical).max():.3f}"
        )
        print(f"      t_eq sqrt(kappa_1(0)) {scaled.round(2)}")
        print(f"      eta_3/eta_1 from {(low / one).round(2)} to {(high / one).round(2)}")
        if name == "dt":
            count_axes.loglog(values, times / values, "s", label=f"slab, slope {slope(values, times / values):.3f}")
        draw_times(time_axes, name, values, times, BASE)


def coarse_steps(axis):
    """Equilibrium time against dt up to dt sqrt(kappa) = 1, one mode critically damped."""
    z = np.geomspace(0.003, 0.99, 25)
    counts = [steps_to_equilibrium(np.ones((1, 1)), np.array([2 / dt - 1]), dt, [1.0], 1e-14, 20000) for dt in z]
    axis.semilogx(z, counts * z, "o-", ms=3)
    label_plot(axis, "one mode, critically damped", r"$\Delta t\sqrt{\kappa}$", r"$t_\mathrm{eq}\sqrt{\kappa}$")
    axis.set_ylim(0, 40)
    print("t_eq sqrt(kappa) of a critically damped mode at dt sqrt(kappa) =")
    print("     ", "".join(f"{x:8.3f}" for x in z[::4]))
    print("     ", "".join(f"{c * x:8.2f}" for c, x in zip(counts[::4], z[::4], strict=True)))


def near_critical(axis):
    """Equilibrium time of one mode around critical damping, and where theory puts its minimum."""
    ratio, dt = np.linspace(0.9, 1.05, 301), 0.01
    eta = ratio[:, None] * (2 / dt - 1)
    print("one mode, dt sqrt(kappa) = 0.01: fastest damping over critical, theory, time over that at critical damping")
    for fraction in (1e-6, 1e-10, 1e-14):
        times = dt * steps_to_equilibrium(np.ones((1, 1)), eta, dt, [1.0], fraction, 20000)
        (line,) = axis.plot(ratio, times, label=f"to {fraction:g}")
        axis.axvline(fastest_damping_ratio(fraction), color=line.get_color(), ls=":", lw=1)
        gain = times.min() / times[abs(ratio - 1).argmin()]
        print(f"      {fraction:g}: {ratio[times.argmin()]:.4f}  {fastest_damping_ratio(fraction):.4f}  {gain:.3f}")
    label_plot(axis, "one mode near critical damping", r"$\eta/\eta_\mathrm{cr}$", r"$t_\mathrm{eq}\sqrt{\kappa}$")
    axis.legend(fontsize=7)


figure, axes = plt.subplots(3, 5, figsize=(19, 11), layout="constrained")
map_of_times(axes[0, 0], 0.3)
figure.colorbar(map_of_times(axes[0, 1], 0.49), ax=axes[0, :2], fraction=0.03, pad=0.01)
one_component(axes[1, :3], axes[0, 2], axes[1, 3])
two_components(axes[2], axes[0, 2], axes[1, 4])
label_plot(axes[0, 2], "6.22 iterations to equilibrium", r"$\Delta t$", r"$n_\mathrm{eq}$", RANGES["dt"])
for panel, title in ((axes[1, 3], "Tab. 6.1 half-space"), (axes[1, 4], "Tab. 6.2 slab")):
    label_plot(panel, title, "parameter over its base value", r"$t_\mathrm{eq}$", 2.0 ** np.arange(-4, 3, 2))
    panel.margins(y=0.3)
    panel.legend(fontsize=7, loc="upper center", ncols=2)
axes[0, 2].legend(fontsize=7)
coarse_steps(axes[0, 3])
near_critical(axes[0, 4])
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1], dpi=110)
