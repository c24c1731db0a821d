"""A sticky punch that is pressed on a rubber slab and withdrawn: it lets go further out than it jumped in.

Asperities jump into contact on the way in, and let go later on the way out. The area between the two branches is the
energy that one approach and withdrawal loses, per area of the interface: `hysteresis`. `jump_displacement` says where
in each step the largest jump was.
"""

import numpy as np
from matplotlib.figure import Figure

import gfmd_numba

depths = np.concatenate([np.arange(-4.0, 4.0, 0.25), np.arange(4.0, -4.25, -0.25)])  # micrometres, above 0 pressed in
scene = {
    "scene": {
        "length": "1 mm",
        "body": {"youngs_modulus": "2 MPa", "poissons_ratio": 0.45, "aspect_ratio": 0.25},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": "100 mJ/m^2", "range": "1 um"}},
        "loading": {"displacement": f"{depths[0]} um"},
    },
    "discretisation": {"eps_c": 1 / 16, "eps_f": 1 / 16, "eps_t": 1},
    "seed": 1,
    "path": [{"displacement": f"{depth} um"} for depth in depths[1:]],
}
path = gfmd_numba.solve(scene)
deepest = int(np.argmax(depths))

figure = Figure((7, 4.4), layout="constrained")
axis = figure.subplots()
for part, look, colour, label in (
    (path.isel(step=slice(deepest + 1)), "o-", "#0072B2", "on the way in"),
    (path.isel(step=slice(deepest, None)), "s--", "#D55E00", "on the way out"),
):
    axis.plot(1e6 * part["punch_displacement"], 1e-3 * part["mean_pressure"], look, ms=3, color=colour, label=label)
axis.axhline(0, color="0.6", lw=0.8)
axis.set(xlabel="Displacement of the punch (µm)", ylabel="Mean pressure (kPa)")
lost, tension = 1e3 * float(path["hysteresis"]), 1e-3 * float(path["pull_off_pressure"])
axis.set_title(f"{lost:.2g} mJ/m² lost, pull-off at {tension:.3g} kPa", loc="left", fontsize=11)
axis.legend(frameon=False)
figure.savefig("adhesion_hysteresis.png", dpi=80)
