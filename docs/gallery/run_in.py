"""Run-in: a rough punch wears as it slides, until its highest asperities are flat.

At first a few tips bear the load. They wear fastest, other asperities come into contact, and the peak pressure falls.
The contact area at the same load, and with it the area-load coefficient, grows more than tenfold.
The tops of the highest asperities are cut off and the valleys stay: the distribution of heights becomes that of a
worn surface, with a steep side. Each colour is one sliding distance.
"""

import numpy as np
from matplotlib.figure import Figure

import gfmd_numba

distances = np.geomspace(1.0, 10**2.5, 6)  # that the punch has slid, in m
scene = {
    "scene": {
        "length": "1 mm",
        "body": {"youngs_modulus": "2 GPa", "poissons_ratio": 0.4},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
        "interface": {"hard_wall": {}, "wear": {"rate": "1e-15 m^2/N"}},
        "loading": {"pressure": "1 MPa"},
    },
    "path": [{"sliding": f"{distance} m"} for distance in distances],
    "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 32, "eps_t": 1 / 2},
    "numerics": {"time_tolerance": 0.1},
    "seed": 1,
}
surfaces = [gfmd_numba.solve(scene | {"realisation": i}) for i in range(6)]

figure = Figure((11, 7), layout="constrained")
profile, heights, kappa, peak = figure.subplots(2, 2).flat
colours = ["#BBBBBB", "#56B4E9", "#0072B2", "#D55E00"]
first = surfaces[0]
x = 1e3 * first["x"]
for colour, step in zip(colours, (0, 3, 5, 6), strict=True):
    label = "new" if step == 0 else f"after {distances[step - 1]:.0f} m"
    worn = first["height"][step] - first["worn_depth"][step]
    profile.plot(x, 1e6 * worn, color=colour, lw=1.2, label=label)
    every = np.concatenate([1e6 * (each["height"][step] - each["worn_depth"][step]) for each in surfaces])
    density, edges = np.histogram(every, 60, (-2.5, 2.5), density=True)
    heights.stairs(density, edges, color=colour, lw=1.5, label=label)
profile.set(xlabel="Position (mm)", ylabel="Height of the punch (µm)")
heights.set(xlabel="Height of the punch (µm)", ylabel="Density of 6 surfaces (1/µm)")
for axis, name, unit, label in (
    (kappa, "kappa", 1.0, "Area-load coefficient κ"),
    (peak, "peak_pressure", 1e-6, "Peak pressure (MPa)"),
):
    for each in surfaces:
        axis.plot(distances, unit * each[name][1:], color="0.8", lw=0.8)
    axis.plot(distances, unit * sum(each[name][1:] for each in surfaces) / len(surfaces), "o-", color="#0072B2", ms=4)
    axis.set(xscale="log", xlabel="Sliding distance (m)", ylabel=label)
profile.legend(loc="lower left")
figure.savefig("run_in.png", dpi=80)
