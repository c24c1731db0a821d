"""The stress inside the body, and where it is largest.

The largest von Mises stress lies below the surface. Far below, the body feels the mean pressure only.
"""

import gfmd_numba
from gfmd_numba.analysis import plot_body

scene = {
    "scene": {
        "length": "1 mm",
        "body": {"youngs_modulus": "70 GPa", "poissons_ratio": 0.33, "aspect_ratio": 1},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": "50 MPa"},
    },
    "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1},
}
fields = gfmd_numba.body_fields(gfmd_numba.solve(scene))
print(f"largest von Mises stress: {float(fields['von_mises'].max()) / 1e9:.2f} GPa")

plot_body(fields).savefig("fields_inside.png", dpi=80)
