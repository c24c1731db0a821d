"""A wave against an elastic half-space, compared with Westergaard's closed form.

Westergaard solved this contact in 1939. The simulation takes the heights as an array. All lengths are in the
period L_x and all stresses in E*, because the scene states neither a length nor a modulus.
"""

import numpy as np
from matplotlib.figure import Figure

import gfmd_numba
from gfmd_numba.theory.closed_forms import westergaard_pressure

AMPLITUDE, LOAD = 0.005, 0.006
x = np.arange(512) / 512
wave = AMPLITUDE * np.cos(2 * np.pi * x)
scene = {
    "scene": {
        "body": {"poissons_ratio": 0.3},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": LOAD / (2 * np.pi * AMPLITUDE / np.sqrt(2))},  # p / (g E*)
    }
}
contact = gfmd_numba.solve(scene, wave)
assert abs(float(contact["mean_pressure"]) - LOAD) < 1e-6

figure = Figure((7, 4), layout="constrained")
axis = figure.subplots()
axis.plot(x, contact["pressure"], color="#D55E00", lw=3.5, label="simulation")
peak = np.argmax(wave) / 512
axis.plot(x, westergaard_pressure((x - peak + 0.5) % 1 - 0.5, LOAD, AMPLITUDE), "k--", lw=1, label="Westergaard")
axis.set(xlabel="Position $x/L_x$", ylabel="Pressure $p/E^*$")
axis.legend()
figure.savefig("westergaard.png", dpi=80)
