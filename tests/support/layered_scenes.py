"""Scenes of bodies with layers: a hard coating on a soft base, and a soft one on a hard base."""

from gfmd_numba.contact.refusal import check_combination
from gfmd_numba.scene import InputError, load_scene

TOP = {"height": 0.02, "youngs_modulus": 100.0, "poissons_ratio": 0.2}
SOFT = {"height": 0.1, "youngs_modulus": 1.0, "poissons_ratio": 0.45}
HARD_ON_SOFT = {"layers": [TOP, SOFT], "base": "rigid"}
SOFT_ON_HARD = {"layers": [SOFT | {"height": 0.02}], "base": {"youngs_modulus": 100.0, "poissons_ratio": 0.2}}
INCOMPRESSIBLE = {"layers": [TOP | {"poissons_ratio": 0.5}, SOFT | {"poissons_ratio": 0.5}], "base": "rigid"}


def scene(body, **changes):
    content = {
        "body": body,
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05},
    } | changes
    eps = {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}
    if content.get("dimension") == 2:
        eps["eps_f"] = 1 / 4
    numerics = content.pop("numerics", {})
    path = content.pop("path", [])
    return {"scene": content, "discretisation": eps, "numerics": numerics, "path": path}


def refused(body, **changes):
    file = scene(body, **changes)
    try:
        loaded, document = load_scene(file)
        check_combination(document, loaded.scene, loaded.numerics, loaded.path)
    except InputError as error:
        return str(error)
    return "nothing"
