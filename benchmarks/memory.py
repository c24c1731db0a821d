"""Peak memory of one contact in bytes a node, against what is counted before it is solved.

`python benchmarks/memory.py CASE LOG2_NODES [LOAD [COEFFICIENT]]` measures one case, each in its own process:
`wall`, `law`, `soft`, `friction`, `cohesive`, with a dimension before it, like `2-friction 18 2 3`. `2-law 18 0.1 3`
is followed along a path of three steps. The counts of `gfmd_numba/scene/checks.py` are the largest found, rounded up.
"""

import sys
import threading
import time
from pathlib import Path

import gfmd_numba
from gfmd_numba.scene.checks import arrays_of_path, arrays_per_realisation

LAWS = {
    "wall": {"hard_wall": {}},
    "law": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-4, "range": 5e-3}},
    "soft": {"exponential": {"work_of_adhesion": -1e-4, "range": 2e-3}},
    "friction": {"hard_wall": {}, "friction": {"coefficient": 0.3}},
    "cohesive": {
        "hard_wall": {},
        "cohesive": {"work_of_adhesion": 1e-4, "normal_length": 5e-3, "tangential_length": 5e-3},
    },
}


def resident():
    """Memory of this process now, in bytes."""
    return 4096 * int(Path("/proc/self/statm").read_text().split()[1])


def file(dimension, law, nx, load, more):
    """Scene of a slab, with waves down to eight nodes; `more` is the coefficient of friction, or a number of steps."""
    interface = LAWS[law] | ({"friction": {"coefficient": more}} if law == "friction" and more else {})
    steps = [{"reduced_pressure": load * (1.0 + 0.1 * i)} for i in range(1, int(more) + 1)] if law == "law" else []
    return {
        "scene": {
            "dimension": dimension,
            "body": {"poissons_ratio": 0.0, "aspect_ratio": 1.0},
            "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
            "interface": interface,
            "loading": {"reduced_pressure": load},
        },
        "discretisation": {"eps_c": 1 / 8, "eps_f": 16 / nx, "eps_t": 1.0},
        "path": steps,
    }


def peak_while(solve):
    """What `solve` returns, and by how many bytes this process has grown meanwhile at most."""
    before, peak, over = resident(), [0], threading.Event()

    def watch():
        while not over.is_set():
            peak[0] = max(peak[0], resident())
            time.sleep(0.002)

    watching = threading.Thread(target=watch)
    watching.start()
    found = solve()
    over.set()
    watching.join()
    return found, peak[0] - before


def main(case, log2_nodes, load=0.1, more=0.0):
    """Print the bytes a node that a case takes, and those counted."""
    dimension, law = int(case[0]), case[2:]
    nx = 2 ** (int(log2_nodes) // dimension)
    gfmd_numba.solve(file(dimension, law, 64, float(load), float(more)))  # compiles
    measured = file(dimension, law, nx, float(load), float(more))
    _, grown = peak_while(lambda: gfmd_numba.solve(measured))
    laws, steps = measured["scene"]["interface"], len(measured["path"])
    counted = 8 * (arrays_per_realisation(dimension, laws) + arrays_of_path(dimension, laws, steps))
    print(f"{case} {nx} nodes a side: {grown / nx**dimension:.0f} of {counted} bytes a node")


if __name__ == "__main__":
    main(*sys.argv[1:])
