"""A small campaign: kappa of two Hurst exponents in its limit, to 5 %.

The campaign varies each of the three discretisations around a reference, two of them together at cross levels. `until`
runs as many surfaces as the target needs. The fit extrapolates kappa to the thermodynamic, fractal and continuum limit.
It takes the exponents from ranges, so that its errors include that the exponents are not known.
"""

import gfmd_numba
from gfmd_numba.analysis import plot_campaign

exponents = {"eps_c": (1.5, 2.5), "eps_f": (0.2, 2.0), "eps_t": (0.5, 1.5)}
campaign = {
    "name": "gallery",
    "seed": 1,
    "realisations": 20,  # `until` adds more
    "scene": {
        "body": {"poissons_ratio": 0.33},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.02},
    },
    "reference": {"eps_c": 1 / 2, "eps_f": 1 / 1024, "eps_t": 1 / 2},
    "limits": {
        "eps_c": [1 / 4, 1 / 8],
        "eps_f": [1 / 64, 1 / 256, 1 / 4096, 1 / 16384],
        "eps_t": [1, 1 / 4],
        "cross": [{"eps_f": 1 / 256, "eps_t": 1}, {"eps_c": 1 / 4, "eps_f": 1 / 256}],
    },
    "grid": {"hurst": [0.3, 0.8]},
    "fit": {"fixed": exponents, "exponents": "free"},
}
results = gfmd_numba.run(campaign, output="gallery", until={"kappa": 0.05})
fit = gfmd_numba.fit_tfc(results, fixed=exponents, exponents="free")
for hurst, kappa, error in zip(
    fit["hurst"].values, fit["kappa_tfc"].values, fit["kappa_tfc_error"].values, strict=True
):
    print(f"H = {hurst}: kappa = {kappa:.2f} +- {error:.2f}")

plot_campaign(results, fit).savefig("campaign.png", dpi=80)
