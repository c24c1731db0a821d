"""Westergaard's wave as a scene, and its closed forms."""

import numpy as np

AMPLITUDE = 0.01
FULL = np.pi * AMPLITUDE  # mean pressure at which the contact is full, in E*
GRADIENT = np.sqrt(2) * np.pi * AMPLITUDE  # rms gradient


def wave(folder, nodes=1024, **changes):
    """Scene of a wave of height `AMPLITUDE` cos(2 pi x) that is pressed on a half-space."""
    np.save(folder / "wave.npy", AMPLITUDE * np.cos(2 * np.pi * np.arange(nodes) / nodes))
    scene = {
        "body": {"poissons_ratio": 0.33},
        "roughness": {"method": "measured", "file": str(folder / "wave.npy")},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.1},
    }
    return {"scene": scene | changes}
