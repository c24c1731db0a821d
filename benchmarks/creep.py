"""Creep of a ball against Lee and Radok, and what its steps in time cost; relaxation beside Tamaas.

python benchmarks/creep.py [--ting | --tamaas] [nodes along the last radius ...]

It presses a ball on a solid of one branch and on one of three, by a sudden load that then stays, and by one that grows.
Its radius and approach are those of Hertz under an equivalent load on the relaxed body.

With --ting the ball sinks in evenly within 1 s, and is drawn off again by a fifth of its way within 0.2 s.

With --tamaas (pip install tamaas) it presses a wave into full contact, in which displacements stay as they are, and
prints the modulus that the pressure tells.
"""

import argparse
import time
from itertools import pairwise

import numpy as np
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.optimize import brentq

import gfmd_numba

RADIUS, LAST = 4.0, 0.45  # of the ball, and of its contact at last, in windows
SOLIDS = {  # moduli of branches over the relaxed one, and their times
    "standard": ((3.0, 1.0),),
    "three branches": ((0.5, 10.0), (1.0, 1.0), (2.0, 0.05)),
}


def equivalent(solid: str, elapsed: float, is_ramp: bool) -> float:
    """Load on the relaxed body that deforms it as a load of 1 does, all at once or as it grows to that in 2 s.

    The dashpots follow u' = A u + b f by their own exponentials.
    """
    moduli, times = np.array(SOLIDS[solid]).T
    glassy = 1.0 + moduli.sum()
    rates = (np.outer(np.ones(len(moduli)), moduli) / glassy - np.eye(len(moduli))) / times[:, np.newaxis]
    source = np.linalg.solve(rates, 1.0 / (glassy * times))
    grown = expm(rates * elapsed) - np.eye(len(moduli))
    if not is_ramp:
        return float(1.0 + moduli @ grown @ source) / glassy
    return 0.5 * float(elapsed + moduli @ (np.linalg.solve(rates, grown @ source) - elapsed * source)) / glassy


def ball(count: int, solid: str, loading: dict, path: list[dict], tolerance: float = 1e-2) -> dict:
    """The file of a ball on a solid with E* = 1, with a number of nodes along its last radius."""
    relaxation = [{"modulus": 0.75 * m, "time": tau} for m, tau in SOLIDS[solid]]
    scene = {
        "dimension": 2,
        "periodic": False,
        "length": 1.0,
        "body": {"youngs_modulus": 0.75, "poissons_ratio": 0.5, "relaxation": relaxation},
        "form": {"radius": RADIUS, "points": round(count / LAST)},
        "interface": {"hard_wall": {}},
        "loading": loading,
    }
    return {"scene": scene, "path": path, "numerics": {"time_tolerance": tolerance}}


def creep(nodes: list[int], solid: str, is_ramp: bool) -> None:
    """Relative errors of the radius and the approach, at numbers of nodes along the last radius."""
    times = (1.0, 2.0) if is_ramp else (0.0, 1.0, 4.0, 16.0)
    force = 4.0 * LAST**3 / (3.0 * RADIUS * equivalent(solid, times[-1], is_ramp))
    print(f"{solid}, a {'load that grows' if is_ramp else 'sudden load'}")
    print("| nodes a radius | time | radius | approach | reported error | solver, s |\n|---|---|---|---|---|---|")
    for count in nodes:
        begun = time.process_time()
        loading = {"force": 0.5 * force, "duration": 1.0} if is_ramp else {"force": force}
        path = [{"duration": end - start} | ({"force": force} if is_ramp else {}) for start, end in pairwise(times)]
        found = gfmd_numba.solve(ball(count, solid, loading, path))
        spent = time.process_time() - begun
        for i, elapsed in enumerate(times):
            radius = float(np.cbrt(3.0 * force * equivalent(solid, elapsed, is_ramp)))
            errors = float(found["contact_radius"][i]) / radius - 1.0, float(found["approach"][i]) * 4 / radius**2 - 1.0
            error = float(found["time_error"][i])
            print(
                f"| {count} | {elapsed:g} | {errors[0]:+.1e} | {errors[1]:+.1e} | {error:.1e} | {spent:.0f} |",
                flush=True,
            )


def ting(nodes: list[int], tolerance: float = 1e-2) -> None:
    """Relative errors of the force and the radius of a ball that is drawn off: J. Appl. Mech. 33:845, 1966.

    The contact at a time t is that of the earlier time t1 with int_t1^t E(t - s) d(approach) = 0.
    """
    ((branch, tau),) = SOLIDS["standard"]
    deepest, force_scale = LAST**2 / RADIUS, 2.0 * (LAST**2) ** 1.5 / RADIUS  # F = 4 / (3 R) int E(t - s) d(a^3)

    def modulus(elapsed: float) -> float:
        return 1.0 + branch * np.exp(-elapsed / tau)

    def missing(first: float, now: float) -> float:
        return float(quad(lambda s: modulus(now - s), first, 1.0)[0] - quad(lambda s: modulus(now - s), 1.0, now)[0])

    print("| nodes a radius | time | force | radius | reported error | processor, s |\n|---|---|---|---|---|---|")
    for count in nodes:
        begun = time.process_time()
        path = [{"displacement": share * deepest, "duration": 0.1} for share in (0.9, 0.8)]
        found = gfmd_numba.solve(ball(count, "standard", {"displacement": deepest, "duration": 1.0}, path, tolerance))
        for i, now in enumerate((1.0, 1.1, 1.2)):
            last = 1.0 if now == 1.0 else brentq(missing, 0.0, 1.0, (now,))
            force = force_scale * quad(lambda s, now=now: modulus(now - s) * np.sqrt(s), 0.0, last)[0]
            errors = (
                float(found["mean_pressure"][i]) / force - 1.0,
                float(found["contact_radius"][i]) / LAST - last**0.5,
            )
            spent, error = time.process_time() - begun, float(found["time_error"][i])
            print(
                f"| {count} | {now:g} | {errors[0]:+.1e} | {errors[1] / last**0.5:+.1e} | {error:.1e} | {spent:.0f} |"
            )


def wave_beside_tamaas(nodes: int = 32, amplitude: float = 1e-3) -> None:
    """Moduli at times, of E* = 1 when it is relaxed, after a sudden contact that is full and stays so."""
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.error)
    heights = amplitude * np.cos(2.0 * np.pi * np.arange(nodes) / nodes) * np.ones((nodes, 1))
    print("| branch | step | time | exact | gfmd-numba | Tamaas |\n|---|---|---|---|---|---|")
    for branch, step in ((1.0, 0.01), (3.0, 0.01), (3.0, 0.1), (9.0, 0.01)):
        times = (round(0.1 / step) * step, round(1.0 / step) * step, 20.0)
        body = {"poissons_ratio": 0.0, "relaxation": [{"modulus": branch, "time": 1.0}]}
        found = gfmd_numba.solve(
            {
                "scene": {
                    "dimension": 2,
                    "body": body,
                    "roughness": {"method": "measured"},
                    "interface": {"hard_wall": {}},
                    "loading": {"reduced_pressure": 100.0},
                },
                "path": [{"duration": end - start} for start, end in pairwise((0.0, *times))],
            },
            heights=heights,
        )
        model = tm.ModelFactory.createModel(tm.model_type.basic_2d, [1.0, 1.0], list(heights.shape))
        model.E, model.nu = 1.0, 0.0
        solver = tm.MaxwellViscoelastic(model, heights.copy(), 1e-14, step, [branch * model.mu], [1.0])
        theirs = {}
        for i in range(round(times[-1] / step) + 1):  # the first contact is at time 0
            solver.solve(0.1)
            theirs[i] = np.ptp(np.asarray(model.traction)) / (2.0 * np.pi * amplitude)
        for i, elapsed in enumerate(times):
            ours = float(np.ptp(found["pressure"][i + 1].values)) / (2.0 * np.pi * amplitude)
            exact = 1.0 + branch * np.exp(-elapsed)
            last = theirs[round(elapsed / step)]
            print(f"| {branch:g} | {step:g} | {elapsed:g} | {exact:.4f} | {ours:.4f} | {last:.4f} |")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tamaas", action="store_true", help="relaxation of a wave beside Tamaas")
    parser.add_argument("--ting", action="store_true", help="a ball that is drawn off, against Ting")
    parser.add_argument("nodes", type=int, nargs="*", default=[16, 32, 64, 128])
    given = parser.parse_args()
    if given.tamaas:
        wave_beside_tamaas()
    elif given.ting:
        ting(given.nodes)
    else:
        for solid in SOLIDS:
            for is_ramp in (False, True):
                creep(given.nodes, solid, is_ramp)
