"""Scenes whose deformable bodies are rough, in units of the body's Young's modulus."""

import numpy as np

ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
BODY = {"youngs_modulus": 1.0, "poissons_ratio": 0.33, "aspect_ratio": 0.5}
FILE = {"discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}, "numerics": {"residual": 1e-9}}
NX = 512
X = np.arange(NX) / NX


def scene(order=2, loading=None, **parts):
    """Scene file of these parts in units of the body's Young's modulus."""
    given = {"body": BODY, "interface": {"hard_wall": {}}, "loading": loading or {"reduced_pressure": 0.02}} | parts
    rough = [given.get("roughness"), given["body"].get("roughness"), given.get("counter_body", {}).get("roughness")]
    follows = "counter_body" in given or "roughness" in given["body"]
    file = FILE | {"numerics": FILE["numerics"] | ({"topography_order": order} if follows else {})}
    if not any(part == ROUGH or (part or {}).get("method") == "psd" for part in rough):
        file = {"numerics": file["numerics"]}
    return file | {"scene": given}


def rough(**changes):
    return BODY | {"roughness": ROUGH | changes}


def measured(folder, heights, name="h.npy"):
    np.save(folder / name, heights)
    return {"method": "measured", "file": str(folder / name), "units": {"z": "L_x"}}
