"""Runs until an error of what a loading path has: how far off they are, over the error that they report.

python benchmarks/until_of_paths.py [hysteresis|kappa] [runs]
"""

import json
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np

import gfmd_numba

TARGET, SURFACES = 0.06, 3000
DRAGGED = {
    "name": "dragged",
    "scene": {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}, "friction": {"coefficient": 0.1}},
        "loading": {"reduced_pressure": 0.05},
    },
    "reference": {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2},
    "limits": {"eps_f": [1 / 4, 1 / 16]},
    "path": [{"sliding": 2e-4}, {"sliding": 0.0}],
}


def limit(found):
    """Limit and error of what a campaign fits, at every step or of the path."""
    fitted = gfmd_numba.fit_tfc(found, **json.loads(found.attrs["fit"]))
    name = f"{fitted.attrs['variable']}_tfc"
    return fitted[name].values, fitted[f"{name}_error"].values


def main(variable="hysteresis", runs="40"):
    warnings.simplefilter("ignore")
    campaign = DRAGGED | {"fit": {"variable": variable, "fixed": {"eps_f": 0.7}}}
    with tempfile.TemporaryDirectory() as folder:
        many = campaign | {"seed": 999, "realisations": SURFACES}
        definitive, sigma = limit(gfmd_numba.run(many, Path(folder, "many")))
        print(f"definitive {definitive}, known to {sigma / abs(definitive)}")
        off, said, reached = [], [], 0
        for seed in range(int(runs)):
            few = campaign | {"seed": 5000 + 7 * seed, "realisations": 1}
            found = gfmd_numba.run(few, Path(folder, str(seed)), until={variable: TARGET})
            value, error = limit(found)
            reached += found.attrs["ended"] == "reached"
            off.append(value / definitive - 1.0)
            said.append(error / abs(value))
    deviation, reported = np.array(off), np.array(said)
    print(f"reached {reached} of {runs}, reported at most {reported.max(axis=0)}")
    print(f"rms deviation {np.sqrt((deviation**2).mean(axis=0))}, reported {np.sqrt((reported**2).mean(axis=0))}")
    inside, within = abs(deviation) <= 1.645 * reported, abs(deviation) <= TARGET
    print(f"within the target {within.sum(axis=0)}, inside 90 % {inside.sum(axis=0)}")


if __name__ == "__main__":
    main(*sys.argv[1:])
