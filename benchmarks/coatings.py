"""Soft and stiff coatings: contact nodes, iterations and transforms of every solver, on 1024 nodes.

python benchmarks/coatings.py
"""

import gfmd_numba
from gfmd_numba.solvers.table import SOLVERS

BASE = {"youngs_modulus": 1.0, "poissons_ratio": 0.4}
EPS = {"eps_c": 1 / 4, "eps_f": 1 / 64, "eps_t": 1 / 2}


def coated(contrast, height, nu, pressure, solver):
    """Contact of a coating, `contrast` times as stiff as the half-space below it."""
    layer = {"height": height, "youngs_modulus": contrast, "poissons_ratio": nu}
    scene = {
        "body": {"layers": [layer], "base": BASE},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": pressure},
    }
    return gfmd_numba.solve({"scene": scene, "discretisation": EPS, "numerics": {"solver": solver}})


def main():
    print("contrast height    nu    p*  solver              status nodes iterations transforms")
    for contrast, height, nu in ((1e-2, 0.02, 0.5), (1e-4, 0.002, 0.45), (1e2, 0.02, 0.3), (1e4, 0.002, 0.3)):
        for pressure in (0.01, 0.2):
            for solver in SOLVERS:
                found = coated(contrast, height, nu, pressure, solver)
                numbers = [int(found[name]) for name in ("status", "n_iterations", "n_transforms")]
                nodes = int((found["pressure"] > 0).sum())
                print(
                    f"{contrast:8g} {height:6g} {nu:5g} {pressure:5g}  {solver:20}{numbers[0]:5d} {nodes:5d} "
                    f"{numbers[1]:10d} {numbers[2]:10d}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
