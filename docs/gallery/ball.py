"""A steel ball on a rough flat, compared with Hertz's smooth ball.

The `form` of the punch is a ball of 10 mm radius, below the roughness. Roughness spreads the load over a region larger
than Hertz's contact, and over many small spots in it.
"""

import numpy as np
from matplotlib.figure import Figure

import gfmd_numba

scene = {
    "dimension": 2,
    "length": "0.5 mm",
    "body": {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3},
    "form": {"radius": "10 mm"},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"force": "1 N"},
}
rough = gfmd_numba.solve({"scene": scene, "discretisation": {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 16}})
smooth = gfmd_numba.solve(scene | {"roughness": None, "form": {"radius": "10 mm", "points": 512}})
hertz = (0.75 * 1.0 * 0.01 / (210e9 / (1 - 0.3**2))) ** (1 / 3)  # contact radius in m
assert abs(float(smooth["contact_radius"]) / hertz - 1) < 0.01

way = 1e6 * (rough["x"] - rough["x"].mean())  # um
around = np.linspace(0, 2 * np.pi, 200)
figure = Figure((8, 3.6), layout="constrained")
left, right = figure.subplots(1, 2)
image = left.pcolormesh(way, way, rough["pressure"] / 1e9, cmap="inferno", rasterized=True)
left.plot(1e6 * hertz * np.cos(around), 1e6 * hertz * np.sin(around), "w--", lw=1)
left.set(xlim=(-80, 80), ylim=(-80, 80), aspect="equal", xlabel="$x$ (µm)", ylabel="$y$ (µm)")
figure.colorbar(image, ax=left, label="Pressure (GPa)")
for contact, label in ((rough, "rough"), (smooth, "smooth: Hertz")):
    distance = 1e6 * np.hypot(contact["x"] - 0.25e-3, contact["y"] - 0.25e-3)
    rings = contact["pressure"].groupby_bins(distance, np.arange(0, 81, 2.5)).mean() / 1e9
    right.plot([ring.mid for ring in rings[rings.dims[0]].values], rings, label=label)
right.set(xlim=(0, 80), ylim=(0, None), xlabel="Distance from the middle (µm)", ylabel="Mean pressure (GPa)")
right.legend()
figure.savefig("ball.png", dpi=80)
