"""Nodes in contact of twelve maps, random and measured, isotropic and not, here and by Tamaas, to the same residual.

python benchmarks/same_contact_nodes.py [FILE ...]; pip install tamaas. The FILEs are maps of instruments, of which
the middle square is levelled, mirrored and resampled to 256²; without them only the random maps are solved.
"""

import sys
import warnings
from itertools import cycle

import numpy as np
import peers

from gfmd_numba.roughness import self_affine
from gfmd_numba.roughness.measured import measured_surface
from gfmd_numba.scene.measured_record import Measured

LOADS = (0.002, 0.02, 0.1, 0.5)  # p / (g E*)
RANDOM = ((0.3, 1.0), (0.8, 1.0), (0.5, 2.0), (0.8, 4.0), (0.3, 4.0), (0.8, 2.0))  # H and anisotropy
NODES, SEED = 256, 11


def random_maps():
    """Name and heights over their rms gradient, the longest wave L_x/4 and the shortest of four nodes along x."""
    for hurst, anisotropy in RANDOM:
        heights = self_affine.maps(hurst, 4, NODES // 4, NODES, SEED, range(1), anisotropy)[0]
        yield f"random, H = {hurst}, anisotropy {anisotropy:g}", heights


def measured_maps(files):
    for file in files:
        record = Measured(
            method="measured",
            file=file,
            crop="square",
            fill="interpolate",
            detrend="tilt",
            periodic="mirror",
            points=NODES,
        )
        heights = measured_surface(record, None).in_periods
        stiff = 2.0 * np.pi * np.fft.fftfreq(heights.shape[0], 1.0 / heights.shape[0])
        power = abs(np.fft.fft2(heights - heights.mean())) ** 2 / heights.size**2
        gradient = np.sqrt((power * (stiff**2 + stiff[:, None] ** 2)).sum())
        yield f"measured, {file.rpartition('/')[2]}", heights / gradient


def main(files):
    solve = peers.tamaas()
    warnings.simplefilter("ignore")
    print(f"{'map':40} {'p*':>6} {'contact':>9} {'differing':>9}  residuals")
    total = 0
    for (name, heights), load in zip([*random_maps(), *measured_maps(files)], cycle(LOADS), strict=False):
        punch = heights.max() - heights
        pressures, residuals = [], []
        for code in (peers.here, solve):
            _, pressure, residual, _ = peers.converged(code, punch, load, peers.FIRST_TOLERANCE)
            pressures.append(pressure > 0.0)
            residuals.append(residual)
        differing = np.count_nonzero(pressures[0] != pressures[1])
        total += differing
        said = ", ".join(f"{each:.1e}" for each in residuals)
        print(f"{name:40} {load:6g} {pressures[0].sum():9d} {differing:9d}  {said}", flush=True)
    print(f"{total} nodes differ")


if __name__ == "__main__":
    main(sys.argv[1:])
