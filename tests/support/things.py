"""Files and datasets of every kind for calls of functions and commands, and how these are called with any arguments."""

from functools import cache

import xarray as xr
import yaml
from hypothesis import HealthCheck, given, settings

import gfmd_numba

SCENE = {
    "length": 1e-4,
    "body": {"youngs_modulus": 70e9, "poissons_ratio": 0.33, "aspect_ratio": 1.0},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.1},
    "discretisation": {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 1},
}
MAP = {**SCENE, "dimension": 2}
SURFACE = {
    "surface": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01, "points": 64, "cut_on": 0.1, "roll_off": 0.5}
}
CAMPAIGN = {
    "name": "small",
    "seed": 1,
    "realisations": 20,
    "scene": {key: SCENE[key] for key in ("length", "body", "roughness", "interface", "loading")},
    "reference": {"eps_c": 0.25, "eps_f": 0.25, "eps_t": 0.5},
    "limits": {"eps_c": [0.5, 0.25, 0.125], "eps_f": [0.5, 0.25, 0.125]},
    "grid": {"reduced_pressure": [0.05, 0.1]},
}
TINY = {key: CAMPAIGN[key] for key in ("name", "seed", "scene", "reference")} | {"realisations": 2}
EXPONENTS = {"eps_c": 1.0, "eps_f": [0.5, 1.0]}
SECONDS = 60.0  # netCDF files that may be damaged are tried by another process, for up to 10 s of processor time
MANY = 4


class Things:
    """Files and datasets that the good calls take, each made once."""

    def __init__(self, folder):
        self.folder = folder

    @cache  # noqa: B019
    def written(self, name):
        """Path of a file in a folder of its own."""
        folder = self.folder / name.replace(".", "-")
        folder.mkdir()
        return folder / name

    def file(self, name, content):
        path = self.written(name)
        if not path.exists():
            if isinstance(content, dict | str):
                path.write_text(content if isinstance(content, str) else yaml.safe_dump(content))
            else:
                content.to_netcdf(path, engine="netcdf4")
        return path

    @cache  # noqa: B019
    def new(self, name):
        """Path of a file or folder that is not there, in a folder of its own."""
        return self.written(f"new-{name}")

    @cache  # noqa: B019
    def finished(self):
        """Output directory of a finished run."""
        gfmd_numba.run(TINY, self.folder / "finished")
        return self.folder / "finished"

    @cache  # noqa: B019
    def contact(self):
        return gfmd_numba.solve(SCENE)

    @cache  # noqa: B019
    def map(self):
        return gfmd_numba.solve(MAP)

    @cache  # noqa: B019
    def results(self):
        return gfmd_numba.run(CAMPAIGN, self.folder / "out")

    @cache  # noqa: B019
    def fit(self):
        return gfmd_numba.fit_tfc(self.results(), fixed=EXPONENTS)

    @cache  # noqa: B019
    def fit_of_loads(self):
        grid = {"reduced_pressure": [0.05, 0.1, 0.2]}
        return gfmd_numba.fit_tfc(gfmd_numba.run(CAMPAIGN | {"grid": grid}, self.folder / "loads"), fixed=EXPONENTS)

    @cache  # noqa: B019
    def curve(self):
        return gfmd_numba.load_curve(SCENE, [0.1, 0.2])

    @cache  # noqa: B019
    def rounds(self):
        rounds = {
            "round_error": ("round", [0.2, 0.1]),
            "round_error_factor": ("round", [1.3, 1.1]),
            "round_predicted_error": ("round", [0.2, 0.12]),
            "round": [0, 1],
            "round_cpu_seconds": ("round", [1.0, 4.0]),
        }
        return self.results().assign(rounds).assign_attrs(target='{"kappa": 0.05}', until="kappa=0.05", ended="reached")

    @cache  # noqa: B019
    def accuracy(self):
        points = {
            "study": ["eps_c", "eps_c", "surfaces"],
            "curve": ["kappa", "kappa", "kappa"],
            "setting": [0.5, 0.25, 1.0],
            "error": [0.1, 0.05, 0.2],
            "seconds": [0.1, 0.2, 0.1],
            "failed": [0, 0, 0],
        }
        return xr.Dataset({name: ("point", values) for name, values in points.items()})


def fuzzed(strategy, check, examples, **chosen):
    @given(arguments=strategy)
    @settings(max_examples=examples, deadline=None, database=None, suppress_health_check=list(HealthCheck), **chosen)
    def fuzz(arguments):
        check(arguments)

    fuzz()
