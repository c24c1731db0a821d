"""The load curve of a random profile, with the standard error of eight surfaces.

Real surfaces touch at few points at first. The contact area grows with the load, the gap closes, and the
contact becomes stiffer. `load_curve` takes the same surfaces through all loads.
"""

import gfmd_numba
from gfmd_numba.analysis import plot_curve

scene = {
    "scene": {
        "length": "1 mm",
        "body": {"youngs_modulus": "70 GPa", "poissons_ratio": 0.33},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": "10 MPa"},
    },
    "discretisation": {"eps_c": 1 / 16, "eps_f": 1 / 64, "eps_t": 1 / 2},
}
loads = ["3 MPa", "10 MPa", "30 MPa", "100 MPa", "300 MPa", "1 GPa"]
curve = gfmd_numba.load_curve(scene, loads, realisations=8)
print(curve["contact_area_fraction"].values)

plot_curve(curve).savefig("load_curve.png", dpi=80)
