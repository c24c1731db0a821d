"""The contact area of line contacts compared with Persson's theory.

The theory knows the surface only through its rms gradient. Line contacts have more area than it predicts at
light loads, and the same in full contact.
"""

import numpy as np
from matplotlib.figure import Figure
from scipy.special import erf

import gfmd_numba

loads = np.geomspace(0.01, 3, 9)
figure = Figure((7, 4), layout="constrained")
axis = figure.subplots()
for hurst, colour, marker in ((0.3, "#440154", "o"), (0.8, "#D55E00", "s")):
    scene = {
        "scene": {
            "body": {"poissons_ratio": 0.33},
            "roughness": {"method": "psd", "hurst": hurst, "rms_gradient": 0.01},
            "interface": {"hard_wall": {}},
            "loading": {"reduced_pressure": 0.01},
        },
        "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 64, "eps_t": 1 / 2},
    }
    curve = gfmd_numba.load_curve(scene, loads, realisations=8)
    area, error = curve["contact_area_fraction"], curve["contact_area_fraction_standard_error"]
    axis.errorbar(loads, area, error, fmt=marker, color=colour, ms=5, capsize=2, label=f"H = {hurst}")
fine = np.geomspace(loads[0], loads[-1], 100)
axis.plot(fine, erf(np.sqrt(2) * fine), "k--", lw=1, label="Persson")
axis.set(xscale="log", yscale="log", xlabel=r"Load $p^* = p/(g\,E^*)$", ylabel="Contact area fraction")
axis.legend()
figure.savefig("persson.png", dpi=80)
