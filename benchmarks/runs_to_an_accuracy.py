"""How often runs are right whose levels are chosen or given: campaigns until 3 %, against definitive values.

python benchmarks/runs_to_an_accuracy.py [chosen|given] [seeds] [target]

The tables are those of docs/limit.md, "How far it can be trusted". The processor time is that of the whole run in one
process with one thread, without the start of the program.
"""

import json
import os
import sys
import tempfile
import time
import warnings

os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np

import gfmd_numba

# the parameters of each campaign, and its definitive kappa from other seeds
KINDS = {
    "H = 0": ({"hurst": 0.0}, 3.320),
    "H = 0.3": ({"hurst": 0.3}, 2.851),
    "H = 0.5": ({"hurst": 0.5}, 2.484),
    "H = 0.8": ({"hurst": 0.8}, 1.978),
    "H = 1": ({"hurst": 1.0}, 1.687),
    "H = 0.8, p\\* = 0.05": ({"hurst": 0.8, "reduced_pressure": 0.05}, 1.942),
    "H = 0.8, slab, a = 0.1": ({"hurst": 0.8, "aspect_ratio": 0.1}, 1.978),  # that of the half-space
    "H = 0.8, map, p\\* = 0.05": ({"hurst": 0.8, "reduced_pressure": 0.05, "dimension": 2}, 1.82),
}


# the same with levels and exponents that somebody gives: parameters, 1/eps_f of the reference and of the other levels
RANGES = {"eps_c": [3 / 2, 5 / 2], "eps_f": [1 / 5, 2], "eps_t": [1 / 2, 3 / 2]}
GIVEN = {
    "64 to 1024": ({"hurst": 0.8}, 256, [64, 128, 1024], RANGES, 1.978),
    "32 to 256": ({"hurst": 0.8}, 256, [32, 64, 128], RANGES, 1.978),
    "16 to 128": ({"hurst": 0.8}, 64, [16, 32, 128], RANGES, 1.978),
    "16 to 128, H = 1": (
        {"hurst": 1.0},
        64,
        [16, 32, 128],
        {"eps_c": RANGES["eps_c"], "eps_t": RANGES["eps_t"]},
        1.687,
    ),
    "64 to 1024, exponent 1": ({"hurst": 0.8}, 256, [64, 128, 1024], {"eps_c": 2, "eps_f": 1, "eps_t": 1}, 1.978),
    "64 to 1024, exponent 0.67": ({"hurst": 0.8}, 256, [64, 128, 1024], {"eps_c": 2, "eps_f": 0.67, "eps_t": 1}, 1.978),
    "64 to 1024, H = 0.3": ({"hurst": 0.3}, 256, [64, 1024], RANGES, 2.851),
    "32 to 256, a = 0.1": ({"hurst": 0.8, "aspect_ratio": 0.1}, 256, [32, 64, 128], RANGES, 1.978),
    "32 to 256, p\\* = 0.05": ({"hurst": 0.8, "reduced_pressure": 0.05}, 256, [32, 64, 128], RANGES, 1.942),
    "16 to 128, p\\* = 0.3": ({"hurst": 0.8, "reduced_pressure": 0.3}, 64, [16, 32, 128], RANGES, 1.704),
}


def scene(hurst, reduced_pressure=0.007, aspect_ratio=np.inf, dimension=1):
    return {
        "dimension": dimension,
        "body": {"poissons_ratio": 0.33, "aspect_ratio": aspect_ratio},
        "roughness": {"method": "psd", "hurst": hurst, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": reduced_pressure},
    }


def given_levels(reference, finest, exponents):
    return {
        "reference": {"eps_c": 1 / 4, "eps_f": 1 / reference, "eps_t": 1 / 2},
        "limits": {"eps_c": [1 / 2, 1 / 8], "eps_f": [1 / each for each in finest], "eps_t": [1, 1 / 4]},
        "fit": {"fixed": exponents},
    }


def one(parameters, levels, seed, target):
    """Limit, its error and interval, whether the target was reached, and the processor time of a run."""
    campaign = {"name": "run", "seed": seed, "scene": scene(**parameters), "target": {"kappa": target}} | levels
    begun = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        results = gfmd_numba.run(campaign, folder + "/run").load()
    seconds = time.process_time() - begun
    fit = gfmd_numba.fit_tfc(results, **json.loads(results.attrs["fit"])).isel(group=0)
    found = [float(fit[f"kappa_tfc{end}"]) for end in ("", "_error", "_low", "_high")]
    return [*found, results.attrs["ended"] == "reached", seconds]


def main(levels="chosen", seeds=20, target=0.03):
    warnings.simplefilter("ignore")
    kinds = {name: (parameters, {}, true) for name, (parameters, true) in KINDS.items()}
    if levels == "given":
        kinds = {name: (first, given_levels(*rest), true) for name, (first, *rest, true) in GIVEN.items()}
    print("| campaign | definitive | inside | mean | rms | reported | above target |\n|---|---|---|---|---|---|---|")
    times = []
    for name, (parameters, given, true) in kinds.items():
        runs = np.array([one(parameters, given, 9100 + seed, float(target)) for seed in range(int(seeds))])
        limit, error, low, high, _, seconds = runs[runs[:, 4] == 1.0].T
        print(f"{name}: {len(limit)} of {len(runs)} reached", file=sys.stderr)
        if not len(limit):
            continue
        off = limit / true - 1.0
        parts = [
            f"{((low <= true) & (true <= high)).sum()} of {len(limit)}",
            *(f"{100 * each:.1f} %" for each in (off.mean(), np.sqrt((off**2).mean()), (error / limit).mean())),
            f"{(abs(off) > float(target)).sum()}",
        ]
        times.append(f"| {name} | {np.median(seconds):.2g} | {seconds.max():.2g} |")
        print(f"| {name} | {true} | {' | '.join(parts)} |", flush=True)
    print("\n| campaign | median | largest |\n|---|---|---|", *times, sep="\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
