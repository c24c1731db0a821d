"""Processor time and peak memory of one contact in double and in single precision, and how far the two are apart.

`python benchmarks/precision.py CASE LOG2_NODES` measures one case in a process for each precision: `wall`, `law`,
`cohesive`, `friction` or `rough`, with a dimension before it, like `2-law 22`. Both stop at a residual of 1e-3.
"""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from memory import peak_while

import gfmd_numba

PSD = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
SLAB = {"youngs_modulus": 1.0, "poissons_ratio": 0.3, "aspect_ratio": 0.5}
LAWS = {
    "wall": {},
    "rough": {},
    "law": {"exponential": {"work_of_adhesion": 1e-6, "range": 2e-3}},
    "cohesive": {"cohesive": {"work_of_adhesion": 1e-6, "normal_length": 4e-3, "tangential_length": 4e-3}},
    "friction": {"friction": {"coefficient": 0.3}},
}


def file(case, nx, precision):
    """Scene of a slab with waves down to four nodes; what drags is dragged once."""
    dimension, law = int(case[0]), case[2:]
    rough = {"body": SLAB | {"roughness": PSD}} if law == "rough" else {"body": SLAB, "roughness": PSD}
    return {
        "scene": rough
        | {"dimension": dimension, "interface": {"hard_wall": {}} | LAWS[law], "loading": {"reduced_pressure": 0.05}},
        "discretisation": {"eps_c": 1 / 2, "eps_f": 8 / nx, "eps_t": 1 / 2},
        "path": [{"sliding": 1e-4}] if law in ("cohesive", "friction") else [],
        "numerics": {"precision": precision, "residual": 1e-3} | ({"topography_order": 0} if law == "rough" else {}),
    }


def measure(case, nx, precision, folder):
    """Print one row, and keep the pressure."""
    gfmd_numba.solve(file(case, 64, precision))  # compiles
    started = time.process_time()
    found, grown = peak_while(lambda: gfmd_numba.solve(file(case, nx, precision)))
    seconds = time.process_time() - started
    np.save(folder / f"{precision}.npy", found["pressure"].values)
    print(
        f"{case} {nx} nodes a side, {precision}: status {found['status'].values.max()}, residual "
        f"{found['residual'].values.max():.1e}, {int(found['n_transforms'].sum())} transforms, {seconds:.2f} s, "
        f"{grown / nx ** int(case[0]):.0f} bytes a node",
        flush=True,
    )


def main(case, log2_nodes, precision="", folder="."):
    """Measure both precisions, each in a process of its own, or the one that is named."""
    nx = 2 ** (int(log2_nodes) // int(case[0]))
    if precision:
        measure(case, nx, precision, Path(folder))
        return
    import tempfile

    with tempfile.TemporaryDirectory() as scratch:
        for each in ("double", "single"):
            subprocess.run([sys.executable, __file__, case, log2_nodes, each, scratch], check=True)
        double, single = (np.load(Path(scratch) / f"{each}.npy") for each in ("double", "single"))
    print(f"pressures differ by {abs(single - double).max() / double.max():.1e} of the largest")


if __name__ == "__main__":
    main(*sys.argv[1:])
