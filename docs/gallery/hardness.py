"""Asperities that yield: the pressure under a wall of finite hardness.

Without a hardness, the pressure of an elastic contact has no upper limit. With one, spots at the hardness give
way, their neighbours carry more, and the contact area grows. Spots that have given way stay flat when the load falls:
the contact comes back on another way.
"""

from matplotlib.figure import Figure

import gfmd_numba

scene = {
    "scene": {
        "length": "0.1 mm",
        "body": {"youngs_modulus": "200 GPa", "poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": "500 MPa"},
    },
    "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 32, "eps_t": 1},
}
elastic = gfmd_numba.solve(scene)
scene["scene"]["interface"] = {"hard_wall": {"hardness": "4 GPa"}}
plastic = gfmd_numba.solve(scene)
for name, contact in (("elastic", elastic), ("plastic", plastic)):
    print(f"{name}: {100 * float(contact['contact_area_fraction']):.1f} % of the surface touch")

loads = [50, 100, 200, 350, 500, 350, 200, 100, 50, 20, 50, 100, 200, 350, 500]  # MPa
scene["scene"]["loading"] = {"pressure": "20 MPa"}
path = gfmd_numba.solve(scene | {"path": [{"pressure": f"{load} MPa"} for load in loads]})

figure = Figure((10, 4), layout="constrained")
axis, loop = figure.subplots(1, 2, width_ratios=[3, 2])
axis.plot(1e6 * elastic["x"], 1e-9 * elastic["pressure"], color="0.2", lw=1, ls="--", label="elastic")
axis.plot(1e6 * plastic["x"], 1e-9 * plastic["pressure"], color="#D55E00", lw=1.4, label="hardness of 4 GPa")
axis.set(xlabel="Position $x$ (µm)", ylabel="Pressure (GPa)")
axis.legend()
loop.plot(1e6 * path["mean_gap"], 1e-6 * path["mean_pressure"], "o-", color="#0072B2", ms=3.5, lw=1.2)
loop.set(
    xlabel="Mean gap (µm)", ylabel="Mean pressure (MPa)", title="Loaded, unloaded, and loaded again", ylim=(0, None)
)
figure.savefig("hardness.png", dpi=80)
