"""A rubber seal that creeps: the contact grows for a minute under a load that stays.

Rubber is stiff at first and soft in the end. Its contact area grows from that of the stiff body to that of the relaxed
one, over all the relaxation times of its branches. While the contact only grows, the area at each time is that of an
elastic body of the creep compliance: points and line are found in two different ways.
"""

import numpy as np
from matplotlib.figure import Figure
from scipy.linalg import expm

import gfmd_numba

moduli, times = (2.0, 3.0), (1.0, 0.01)  # of the branches: over the relaxed modulus, and in s
scene = {
    "scene": {
        "length": "1 mm",
        "body": {"youngs_modulus": "3 MPa", "poissons_ratio": 0.5},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": "4 kPa"},
    },
    "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 64, "eps_t": 1 / 2},
    "seed": 4,
}
elapsed = np.geomspace(1e-4, 60.0, 14)
branches = [{"modulus": f"{3.0 * m} MPa", "time": f"{tau} s"} for m, tau in zip(moduli, times, strict=True)]
scene["scene"]["body"]["relaxation"] = branches
creeping = gfmd_numba.load_curve(scene, times=elapsed, realisations=2)
print(f"the divisions of time leave an error of {float(creeping['time_error'].max()):.1e}")

# the compliance: each dashpot yields to what its spring bears, under a constant stress that all springs share
yields = (np.outer(1.0 / np.array(times), moduli) / (1.0 + sum(moduli))) - np.diag(1.0 / np.array(times))
relaxed = np.ones(2)
dashpots = [relaxed - expm(yields * time) @ relaxed for time in elapsed]
compliance = (1.0 + np.array(dashpots) @ moduli) / (1.0 + sum(moduli))
del scene["scene"]["body"]["relaxation"]
elastic = gfmd_numba.load_curve(scene, [f"{4.0 * each} kPa" for each in compliance], realisations=2)

figure = Figure((10, 4), layout="constrained")
for axis, name, label in (
    (figure.add_subplot(1, 2, 1), "contact_area_fraction", "Contact area fraction"),
    (figure.add_subplot(1, 2, 2), "mean_gap", "Mean gap (µm)"),
):
    unit = 1e6 if name == "mean_gap" else 1.0
    axis.semilogx(elapsed, unit * elastic[name], color="0.2", lw=1, ls="--", label="elastic, of the creep compliance")
    axis.semilogx(creeping["time"], unit * creeping[name], "o", color="#0072B2", ms=4, label="creeping")
    axis.set(xlabel="Time (s)", ylabel=label)
    axis.legend()
figure.savefig("creep.png", dpi=80)
