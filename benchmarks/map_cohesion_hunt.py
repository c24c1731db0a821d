"""Random maps under a law of gap and slip: how each path ends, and an independent check of every step called ok.

`python benchmarks/map_cohesion_hunt.py cohesive 0 300` solves 300 paths: kind, first seed, and the one after the last.
Kinds are cohesive and rigid (slabs of Poisson's ratio 1/2 under displacement). The scenes are those of
`benchmarks/law_hunt.py` on 16 to 64 nodes both ways, dragged along x and y.
"""

import runpy
import sys
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.scene import InputError, load_scene
from gfmd_numba.solvers.status import Status

PROFILES = runpy.run_path(str(Path(__file__).with_name("law_hunt.py")))
NODES = (16, 32, 64)


def random_scene(kind, seed):
    """A path of four steps on a self-affine map, dragged in any direction; its law softens by x up to 1."""
    rng = np.random.default_rng([7, seed])
    scene = PROFILES["random_scene"](kind, seed)
    eps = scene["discretisation"]
    before = 2.0 / np.prod(list(eps.values()))
    eps |= {"eps_c": float(rng.choice([1.0, 0.5, 0.25])), "eps_t": float(rng.choice([1.0, 0.5]))}
    nodes = int(rng.choice(NODES))
    eps["eps_f"] = 2.0 / (nodes * eps["eps_c"] * eps["eps_t"])
    for law in scene["scene"]["interface"].values():
        if "work_of_adhesion" in law:  # what decides is how stiff the shortest wave is, also if it slips sideways
            law["work_of_adhesion"] *= (1.0 - scene["scene"]["body"]["poissons_ratio"]) * nodes / before
    scene["scene"]["dimension"] = 2
    for step in scene["path"]:
        if "sliding" in step:
            step["sliding_y"] = float(rng.normal() * abs(step["sliding"]))
    return scene


def violation(problem, contact, sliding):
    """Largest violated condition over the largest traction, by NumPy's transforms, and what rounding leaves open."""
    found, punch, laws = contact.equilibrium, contact.punch[0], problem.interface
    u = np.concatenate((found.tangential.displacement[0], found.displacement))
    elements = problem.body.response(punch.shape).elements
    rigid = problem.mean_pressure is None and np.isinf(elements[5, 0, 0])
    if problem.mean_pressure is not None or rigid:
        elements[5, 0, 0] = 0.0
    xx, xy, yy, xz, yz, zz = elements
    x, y, z = np.fft.rfft2(u)
    waves = (xx * x + xy * y + 1j * xz * z, xy * x + yy * y + 1j * yz * z, zz * z - 1j * (xz * x + yz * y))
    *shear, elastic = np.fft.irfft2(np.stack(waves), punch.shape)
    law = laws.cohesive
    g, s = (punch - u[2]) / law.normal, (np.reshape(sliding, (2, 1, 1)) - u[:2]) / law.tangential
    decay = law.work * np.exp(-np.maximum(g, 0.0) - (s**2).sum(axis=0))
    pull = g / law.normal * np.where(g < 0.0, law.work * np.exp(-np.minimum(g, 0.0)), decay)
    drag = 2.0 * s / law.tangential * (1.0 + np.maximum(g, 0.0)) * decay
    load = float(found.pressure[0].mean()) if rigid else problem.mean_pressure or 0.0
    touching, wall = (u[2] >= punch) & laws.hard_wall, PROFILES["unbalanced"]
    if rigid:  # the mean pressure is a multiplier, which the mean of all pressures tells to the residual alone
        shifts = 1e-8 * np.abs(load - elastic).max() * np.linspace(-1.0, 1.0, 41)
        load += min(shifts, key=lambda shift: wall(load + shift - elastic + pull, punch - u[2], touching, np.inf))
    bears = load - elastic + pull
    largest = max(bears.max(), np.abs(pull).max(), np.abs(drag).max())
    worst = max(wall(bears, punch - u[2], touching, np.inf), np.hypot(*(shear - drag)).max())
    if laws.hard_wall and (u[2] > punch).any():
        worst = np.inf
    if rigid:
        worst = max(worst, zz.max() * abs(u[2].mean()))
    pressure = np.where(touching, bears, 0.0) - pull
    worst = max(worst, 0.1 * np.abs(found.pressure[0] - pressure).max())
    if problem.mean_pressure is not None:
        worst = max(worst, largest * abs(pressure.mean() / problem.mean_pressure - 1.0))
    return worst / largest, max(zz.max(), xx.max()) * np.spacing(np.abs(u).max()) / largest


def follow(kind, seed):
    """Status of the last step, the worst violation over what is allowed, and transforms a step; None if refused."""
    scene = random_scene(kind, seed)
    if "cohesive" not in scene["scene"]["interface"]:
        return None
    try:
        return follow_scene(scene)
    except InputError as error:
        known = any(word in str(error) for word in ("resolve", "room", "snap"))  # of what solves none
        return None if known else sys.exit(f"{seed}: {error}")


def follow_scene(scene):
    """The same of a given scene; raises InputError."""
    whole, _ = read_contact(*load_scene(scene)).reduced
    worst, spent, status = 0.0, [], Status.ok
    with warnings.catch_warnings(action="ignore"):
        for problem, contact in zip(whole.at_each_load, solve_path(whole, 0), strict=True):
            status = Status(int(contact.equilibrium.status[0]))
            spent.append(int(contact.equilibrium.n_transforms[0]))
            if status != Status.ok:
                break
            found, rounding = violation(problem, contact, problem.sliding)
            worst = max(worst, found / (1.01 * problem.numerics.residual + 4.0 * rounding))
    return status, worst, spent


if __name__ == "__main__":
    kind, ended, transforms, failed = sys.argv[1], Counter(), [], 0
    started = time.process_time()
    for seed in range(*map(int, sys.argv[2:4])):
        result = follow(kind, seed)
        if result is None:
            ended["refused"] += 1
            continue
        status, worst, spent = result
        ended[status.name] += 1
        transforms += spent
        if status != Status.ok:
            print(f"{kind} {seed}: {status.name} in step {len(spent)} after {spent[-1]} transforms", flush=True)
        if not worst <= 1.0:
            failed += 1
            print(f"{kind} {seed}: called ok, but violated by {worst:.1e} times what is allowed", flush=True)
    print(f"{kind}: {dict(ended)}; {failed} fail the check; transforms a step: median {np.median(transforms):.0f},")
    seconds = time.process_time() - started
    print(f"ninth decile {np.percentile(transforms, 90):.0f}, most {max(transforms)}; {seconds:.0f} s")
