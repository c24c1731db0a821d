"""A punch that is pressed on a slab and then dragged along: from sticking to sliding.

Each step of the `path` begins where the last one ended. Nodes slide where the tangential traction reaches the
friction coefficient times the pressure. In the end all of them do, and the mean traction stays at 0.3 times the
mean pressure.
"""

import numpy as np
from matplotlib.figure import Figure

import gfmd_numba

drags = np.array([0.0005, 0.001, 0.002, 0.003, 0.004, 0.006])
scene = {
    "scene": {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}},
        "loading": {"reduced_pressure": 0.1},
    },
    "discretisation": {"eps_c": 1 / 2, "eps_f": 1 / 16, "eps_t": 1},
    "path": [{"sliding": float(drag)} for drag in drags],
}
path = gfmd_numba.solve(scene)
drag = np.abs(path["tangential_traction"].mean("x"))

figure = Figure((7, 4), layout="constrained")
axis = figure.subplots()
axis.plot(1e3 * path["sliding"], drag / path["mean_pressure"], "o-", color="#0072B2")
axis.axhline(0.3, color="0.4", ls="--", label="friction coefficient")
axis.set(xlabel=r"Displacement of the punch along $x$ ($10^{-3}\,L_x$)", ylabel="Mean traction over mean pressure")
axis.set_ylim(bottom=0)
axis.legend()
figure.savefig("friction.png", dpi=100)
