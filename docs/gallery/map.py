"""The contact of a rough map: gap and pressure over an interface of two dimensions.

The same scene as of a profile describes a map with `dimension: 2`. Nodes in contact are orange among the gaps, and
surrounded by lines among the pressures. The distributions below are compared with Persson's theory.
"""

import gfmd_numba
from gfmd_numba.analysis import plot_contact

scene = {
    "scene": {
        "dimension": 2,
        "length": "0.2 mm",
        "body": {"youngs_modulus": "3 GPa", "poissons_ratio": 0.4},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": "20 MPa"},
    },
    "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2},
}
contact = gfmd_numba.solve(scene)
print(f"kappa = {float(contact['kappa']):.2f}")

plot_contact(contact).savefig("map.png", dpi=80)
