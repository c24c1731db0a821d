"""A profile from an instrument, in micrometres, pressed with 50 MPa.

The header of the file states the units. The scene levels the profile and mirrors it, so that its ends meet.
Without an instrument at hand, this example writes a file such as one would export.
"""

from pathlib import Path

import numpy as np

import gfmd_numba
from gfmd_numba.analysis import plot_contact

rng = np.random.default_rng(1)
x = np.arange(1024) * 0.5e-3  # mm
waves = np.arange(2, 200)
phases = rng.uniform(0, 2 * np.pi, waves.size)
z = 0.05 * np.sum(waves**-1.3 * np.cos(2 * np.pi * np.outer(x / x[-1], waves) + phases), axis=1) + 0.8 * x  # um, tilted
np.savetxt("profile.csv", np.column_stack([x, z]), delimiter=",", header="x [mm],z [um]", comments="", fmt="%.6f")

Path("steel.yaml").write_text("""\
scene:
  body: {youngs_modulus: 210 GPa, poissons_ratio: 0.3}
  roughness: {method: measured, file: profile.csv, detrend: tilt, periodic: mirror}
  interface: {hard_wall: {}}
  loading: {pressure: 50 MPa}
""")
contact = gfmd_numba.solve("steel.yaml")
print(f"{100 * float(contact['contact_area_fraction']):.2f} % of the surface touch")

plot_contact(contact).savefig("measured_profile.png", dpi=80)
