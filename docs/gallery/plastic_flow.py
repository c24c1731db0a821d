"""Plastic flow inside a body: what a rough punch leaves in steel.

Asperities press the body harder than it yields. It flows below them, at first out of sight of the surface, and the
pressure is far lower than on an elastic body. When the punch is drawn off, dents stay, and so do stresses: those in the
picture act without any load.
"""

import gfmd_numba
from gfmd_numba.analysis.plots.bodies import plot_flow

scene = {
    "scene": {
        "length": "0.1 mm",
        "body": {
            "youngs_modulus": "200 GPa",
            "poissons_ratio": 0.3,
            "plasticity": {"yield_stress": "800 MPa", "hardening": "2 GPa", "increments": 24},
        },
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": "150 MPa"},
    },
    "path": [{"pressure": "10 kPa"}],
    "discretisation": {"eps_c": 1 / 8, "eps_f": 1 / 8, "eps_t": 1 / 2},
    "seed": 3,
}
contact = gfmd_numba.solve(scene)
del scene["scene"]["body"]["plasticity"]
elastic = gfmd_numba.solve(scene)
for name, each in (("elastic", elastic), ("with plastic flow", contact)):
    area, peak = (float(each[key][0]) for key in ("contact_area_fraction", "peak_pressure"))
    print(f"{name}: {100 * area:.1f} % of the surface touch, under at most {1e-9 * peak:.1f} GPa")
strain = 100 * float(contact["largest_plastic_strain"][0])
print(f"plastic strain of up to {strain:.1f} %, error by the increments {float(contact['increment_error'][0]):.1%}")

plot_flow(contact).savefig("plastic_flow.png", dpi=80)
