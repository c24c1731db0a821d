"""A small campaign: kappa of two Hurst exponents in its limit, to 5 %.

Without levels the run chooses the discretisations by itself: a reference, levels that differ from it in one of the
three, and cross levels, at which two differ together. It begins with coarse surfaces and adds finer ones, or more,
until the target is reached. The fit extrapolates kappa to the thermodynamic, fractal and continuum limit, and its error
includes that the exponents are not known.
"""

import gfmd_numba
from gfmd_numba.analysis import plot_campaign

campaign = {
    "name": "gallery",
    "seed": 1,
    "scene": {
        "body": {"poissons_ratio": 0.33},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.02},
    },
    "grid": {"hurst": [0.3, 0.8]},
}
results = gfmd_numba.run(campaign, output="gallery", until={"kappa": 0.05})
fit = gfmd_numba.fit_tfc(results)
for hurst, kappa, error in zip(
    fit["hurst"].values, fit["kappa_tfc"].values, fit["kappa_tfc_error"].values, strict=True
):
    print(f"H = {hurst}: kappa = {kappa:.2f} +- {error:.2f}")

plot_campaign(results, fit).savefig("campaign.png", dpi=80)
