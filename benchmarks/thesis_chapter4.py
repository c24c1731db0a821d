"""The thesis's tables 4.2 to 4.7 against those of campaigns/thesis-chapter4.yaml: its own fits to numbers made anew.

usage: thesis_chapter4.py thesis-chapter4/thesis-chapter4.nc [picture.png]
"""

import sys
import warnings

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import OptimizeWarning, curve_fit

import gfmd_numba

INF = float("inf")
HURSTS = (0.3, 0.5, 0.8)
LIMITS = ("eps_c", "eps_f", "eps_t")
# linear fits of the thesis: (table, aspect ratio, Poisson's ratio): exponents, then C_c, C_f, C_t for H = 0.3, 0.5, 0.8
THESIS = {
    ("4.2", INF, 0.5): ((0.73, 1, 1), (0.765, 48.002, -0.002), (0.273, 133.402, 0.0393), (0.158, 122.47, 0.062)),
    ("4.3a", INF, 0.2): ((1, 1, 1), (0.819, 4.534, 0.017), (0.312, 240.481, 0.140), (0.156, 78.592, -0.018)),
    ("4.3b", INF, 0.33): ((1, 1, 1), (0.866, 32.630, 0.051), (0.299, 182.981, 0.134), (0.025, 65.104, 0.152)),
    ("4.3c", INF, 0.49): ((1, 1, 1), (0.792, 69.508, 0.129), (0.316, 154.237, 0.116), (0.168, 115.985, 0.0982)),
    ("4.5", 4.0, 0.49): ((2, 0.66, 1), (0.879, 7.591, 0.055), (0.381, 8.038, 0.010), (0.169, 17.883, 0.136)),
    ("4.6", 1.0, 0.49): ((1.27, 1, 1), (0.695, 83.809, -0.0163), (0.483, 3.487, 0.105), (0.071, 18.977, 0.139)),
    ("4.7a", 0.5, 0.2): ((1, 1, 1), (0.953, 59.219, -0.055), (np.nan, np.nan, 0.128), (0.199, 224.765, 0.098)),
    ("4.7b", 0.5, 0.33): ((1, 1, 1), (1.145, 46.411, 0.054), (0.370, 113.945, -0.118), (np.nan, 81.042, 0.0346)),
    ("4.7c", 0.5, 0.49): ((1, 1, 1), (0.916, 57.095, 0.109), (0.407, 188.750, 0.156), (0.166, 104.770, 0.042)),
}
CONTINUUM = {0.0: 1.45, 0.3: 1.45, 0.5: 1.45, 0.8: 1.19}  # kappa in the continuum limit, as the text of 4.3 states it


def levels(dataset, hurst, nu, aspect_ratio, limit, nyquist=False):
    """Levels of one limit from coarse to fine, counted kappa of a solid twice too stiff (realisation, level)."""
    # an incompressible half-space is any half-space
    mine = (dataset["hurst"] == hurst) & (dataset["aspect_ratio"] == aspect_ratio)
    mine &= dataset["poissons_ratio"] == (0.49 if nu == 0.5 else nu)
    mine &= (dataset["limit"] == limit) | dataset["is_reference"]
    chosen = dataset.isel(case=np.flatnonzero(mine)).sortby(limit, ascending=False)
    if limit == "eps_c" and not nyquist:
        chosen = chosen.isel(case=chosen["eps_c"].values < 1)
    return chosen[limit].values, 0.5 * chosen["kappa_counted"].values.T


def linear(eps, values, exponent):
    """Coefficient C and limit of kappa = limit + C eps^exponent, and the standard error of C over the surfaces."""
    x = eps**exponent
    slopes = np.polyfit(x, values.T, 1)
    return slopes[0].mean(), slopes[1].mean(), slopes[0].std(ddof=1) / np.sqrt(len(values)), slopes[1].std(ddof=1)


def power(eps, values):
    """C and alpha of a power law through the means, nan where there is none."""
    warnings.simplefilter("ignore", OptimizeWarning)  # as many levels as parameters
    try:
        means = values.mean(axis=0)
        found, _ = curve_fit(lambda e, k, c, a: k + c * e**a, eps, means, p0=(means[-1], 1.0, 1.0), maxfev=5000)
    except RuntimeError:
        return np.nan, np.nan
    return (found[1], found[2]) if 0.05 < found[2] < 5 else (np.nan, np.nan)


def main(path, picture=None):
    dataset = gfmd_numba.open_campaign(path)
    for (table, aspect_ratio, nu), (exponents, *coefficients) in THESIS.items():
        print(f"\nTab. {table}: a = {aspect_ratio:g}, nu = {nu:g}; linear fits, thesis / here ± one standard error")
        for hurst, theirs in zip(HURSTS, coefficients, strict=True):
            row = [f"H = {hurst}"]
            for limit, exponent, their in zip(LIMITS, exponents, theirs, strict=True):
                eps, values = levels(dataset, hurst, nu, aspect_ratio, limit, nyquist=True)
                ours, _, error, _ = linear(eps, values, exponent)
                row.append(f"C_{limit[-1]} {their:8.3f} / {ours:8.3f} ± {error:.3f}")
            for limit in LIMITS:
                row.append(f"alpha_{limit[-1]} {power(*levels(dataset, hurst, nu, aspect_ratio, limit))[1]:.2f}")
            print("  ".join(row))
    print("\nkappa in the continuum limit (linear in eps_c, half-space): thesis / here ± one standard error")
    for hurst, their in CONTINUUM.items():
        eps, values = levels(dataset, hurst, 0.33, INF, "eps_c")
        _, ours, _, spread = linear(eps, values, 1.0)
        print(f"H = {hurst}: {their} / {ours:.2f} ± {spread / np.sqrt(len(values)):.2f}")
    print("\nwhat nu and a change at the reference (paired, relative to the half-space)")
    for hurst in (0.0, *HURSTS):
        half_space = levels(dataset, hurst, 0.33, INF, "eps_t")
        base = half_space[1][:, half_space[0] == 0.5]
        shown = []
        for aspect_ratio in (4.0, 1.0, 0.5):
            for nu in (0.2, 0.33, 0.49):
                eps, values = levels(dataset, hurst, nu, aspect_ratio, "eps_t")
                change = values[:, eps == 0.5] / base - 1.0
                shown.append(
                    f"a {aspect_ratio:g} nu {nu}: {100 * change.mean():+.2f} ± {100 * change.std() / 30**0.5:.2f} %"
                )
        print(f"H = {hurst}: " + ", ".join(shown))
    if picture:
        draw(dataset).savefig(picture, dpi=110)


def draw(dataset):
    """Figs 4.2 and 4.3: kappa against each discretisation, with the thesis's continuum limits."""
    figure = Figure(figsize=(12, 4), layout="constrained")
    for axes, limit in zip(figure.subplots(1, 3), LIMITS, strict=True):
        for i, hurst in enumerate((0.0, *HURSTS)):
            eps, values = levels(dataset, hurst, 0.33, INF, limit, nyquist=True)
            error = values.std(axis=0, ddof=1) / np.sqrt(len(values))
            axes.errorbar(eps, values.mean(axis=0), error, fmt="o-", color=f"C{i}", label=f"H = {hurst}")
            if limit == "eps_c":
                axes.plot(0.02 * eps.min(), CONTINUUM[hurst], "*", color=f"C{i}", markersize=10)
        axes.set_xscale("log" if limit != "eps_c" else "linear")
        axes.set_xlabel(limit)
        axes.set_ylabel("kappa, twice too stiff, counted nodes")
    axes.legend()
    figure.axes[0].set_title("stars: the thesis's continuum limits", fontsize=9)
    return figure


if __name__ == "__main__":
    main(*sys.argv[1:])
