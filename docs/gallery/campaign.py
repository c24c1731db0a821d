"""A small campaign: ensembles of surfaces, and kappa extrapolated to its limit.

The campaign varies each of the three discretisations around a reference. The fit extrapolates kappa to the
thermodynamic, fractal and continuum limit. For one with more surfaces and smaller errors see the README.
"""

import gfmd_numba
from gfmd_numba.analysis import plot_campaign

campaign = {
    "name": "gallery",
    "seed": 1,
    "realisations": 24,
    "scene": {
        "body": {"poissons_ratio": 0.33},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.02},
    },
    "reference": {"eps_c": 1 / 2, "eps_f": 1 / 64, "eps_t": 1 / 2},
    "limits": {"eps_c": [1 / 4, 1 / 8], "eps_f": [1 / 16, 1 / 32, 1 / 128], "eps_t": [1, 1 / 4]},
    "grid": {"hurst": [0.3, 0.8]},
}
results = gfmd_numba.run(campaign, output="gallery")
fit = gfmd_numba.fit_tfc(results, fixed={"eps_c": 2, "eps_f": 0.7, "eps_t": 1})
print(fit[["kappa_tfc", "kappa_tfc_error"]].to_dataframe())

plot_campaign(results, fit).savefig("campaign.png", dpi=80)
