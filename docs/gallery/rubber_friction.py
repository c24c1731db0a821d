"""Rubber friction against speed: a rough punch slides over rubber, and the rubber's losses brake it.

Friction is largest where asperities pass a place of the rubber about as fast as it relaxes. At higher speeds the rubber
is stiff, and only the tips of the asperities touch. Persson's theory of rubber friction (J. Chem. Phys. 115:3840,
2001), here for profiles, adds up the losses of all waves in full contact, each times the share P of the surface that
touches when only longer waves are looked at. The factor (1 + P^2) / 2 is a correction of 2008 (J. Phys.: Condens.
Matter 20:215214): a surface in partial contact is deformed by less than one in full contact.
"""

import numpy as np
from matplotlib.figure import Figure
from scipy.special import erf

import gfmd_numba

relaxed, moduli, times = 3.0, (3.0, 6.0, 12.0, 24.0), (1.0, 0.1, 0.01, 1e-3)  # MPa and s
length, pressure, surfaces = 1e-3, 0.03, 3  # m and MPa
scene = {
    "scene": {
        "length": length,
        "body": {
            "youngs_modulus": f"{relaxed} MPa",
            "poissons_ratio": 0.5,
            "relaxation": [{"modulus": f"{m} MPa", "time": tau} for m, tau in zip(moduli, times, strict=True)],
        },
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": f"{pressure} MPa"},
    },
    "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 64, "eps_t": 1 / 2},
    "seed": 4,
}
speeds = np.geomspace(1e-6, 1.0, 19)
found = gfmd_numba.load_curve(scene, speeds=speeds, realisations=surfaces)

scene["scene"]["loading"]["speed"] = 1e-3
contacts = [gfmd_numba.solve(scene | {"realisation": i}) for i in range(surfaces)]
n = contacts[0].sizes["x"]
q = 2.0 * np.pi * np.arange(1, n // 2) / length
power = np.mean([abs(np.fft.rfft(each["height"])[1 : n // 2] / n) ** 2 for each in contacts], axis=0)
plane = 1e6 / (1.0 - 0.5**2)  # Pa of plane strain for a Young's modulus of 1 MPa
fast = np.geomspace(speeds[0], speeds[-1], 200)
friction, corrected, area = [], [], []
for speed in fast:
    phase = 1j * q * speed * np.array(times)[:, np.newaxis]
    modulus = plane * (relaxed + (np.array(moduli)[:, np.newaxis] * phase / (1.0 + phase)).sum(axis=0))
    fluctuation = np.sqrt(np.cumsum(2.0 * (0.5 * q * abs(modulus)) ** 2 * power))  # of the pressure in full contact
    touching = erf(1e6 * pressure / (np.sqrt(2.0) * fluctuation))
    losses = q**2 * power * modulus.imag * touching / (1e6 * pressure)
    friction.append(losses.sum())
    corrected.append((losses * 0.5 * (1.0 + touching**2)).sum())
    area.append(touching[-1])

figure = Figure((10, 4), layout="constrained")
for axis, name, theory, label in (
    (figure.add_subplot(1, 2, 1), "hysteretic_friction", friction, "Coefficient of friction"),
    (figure.add_subplot(1, 2, 2), "contact_area_fraction", area, "Contact area fraction"),
):
    axis.plot(fast, theory, color="0.2", lw=1, ls="--", label="Persson's theory")
    if name == "hysteretic_friction":
        axis.plot(fast, corrected, color="#D55E00", lw=1.2, label="with its correction")
    error = found[f"{name}_standard_error"]
    axis.errorbar(speeds, found[name], error, fmt="o", color="#0072B2", ms=4, label="simulated")
    axis.set(xscale="log", xlabel="Sliding speed (m/s)", ylabel=label)
    axis.legend()
figure.axes[1].set_yscale("log")
figure.savefig("rubber_friction.png", dpi=80)
