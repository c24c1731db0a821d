"""Campaigns along loading paths: a rough punch that is dragged, and one that is pulled off."""

EPS = {"eps_c": 1 / 8, "eps_f": 1 / 8, "eps_t": 1 / 2}
PSD = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02}
DRAGGED = {
    "name": "dragged",
    "seed": 1,
    "realisations": 2,
    "scene": {
        "body": {"poissons_ratio": 0.5, "aspect_ratio": 4.0},
        "roughness": PSD,
        "interface": {"hard_wall": {}, "friction": {"coefficient": 0.1}},
        "loading": {"reduced_pressure": 0.05},
    },
    "reference": EPS,
    "grid": {"friction_coefficient": [0.05, 0.1]},
    "path": [{"sliding": s} for s in (4e-4, 8e-4, 0.0, -8e-4, 0.0, 8e-4)],
}
LOOP = [-2e-3, -1e-3, 0.0, 5e-4, 0.0, -1e-3, -2e-3, -4e-3, -6e-3]
PULLED = {
    "name": "pulled",
    "seed": 1,
    "realisations": 2,
    "scene": {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.25},
        "roughness": PSD | {"rms_gradient": 0.05},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-4, "range": 2e-3}},
        "loading": {"displacement": LOOP[0]},
    },
    "reference": EPS | {"eps_t": 1},
    "grid": {"work_of_adhesion": [5e-5, 1e-4]},
    "path": [{"displacement": d} for d in LOOP[1:]],
}


def one(file, realisation, **values):
    """The scene of a campaign under some values, as `gfmd solve` takes it."""
    scene = dict(file["scene"])
    (law,) = scene["interface"].keys() - {"hard_wall"}
    scene["interface"] = scene["interface"] | {law: scene["interface"][law] | values}
    kept = {"scene": scene, "path": file["path"], "discretisation": file["reference"], "seed": file["seed"]}
    return kept | {"realisation": realisation}
