"""Random paths of maps with friction by Newton's method alone: how many steps end, and an independent check of each.

`python benchmarks/map_friction_hunt.py 0 300` takes about half a minute: first seed, and the one after the last.
Further arguments change the same paths: `law` adds one that attracts or repels, `sticking` makes friction infinite, and
`rigid` makes the bodies incompressible slabs under a displacement; `rate` makes friction depend on the slip rate.
"""

import sys
from collections import Counter
from dataclasses import replace

import numpy as np
from friction_hunt import random_rate

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

ALONE = Options("frictional_newton", max_iterations=100)  # the dynamics does not take over


def rough(shape, hurst, waves, rng):
    """Self-affine punch of unit rms gradient on any grid."""
    q = grid.magnitudes(shape)
    index = q / (2.0 * np.pi)
    size = np.where((index > 0.0) & (index <= waves), np.maximum(index, 1.5) ** (-1.0 - hurst), 0.0)
    spectrum = size * rng.normal(size=q.shape) * np.exp(2j * np.pi * rng.random(q.shape))
    heights = np.fft.irfft2(spectrum, shape)
    waves_kept = np.fft.rfft2(heights, norm="forward")
    slope = np.sqrt((grid.multiplicity(shape[1]) * np.abs(q * waves_kept) ** 2).sum())
    return (heights.max() - heights)[np.newaxis] / slope


def random_law(seed, shape):
    """Law that softens by x up to 1, or repels."""
    rng = np.random.default_rng([seed, 1])
    reach = 10 ** rng.uniform(-3.0, -0.5)
    work = 10 ** rng.uniform(-3.0, 0.0) * 0.5 * np.pi * min(shape) * reach**2
    if rng.random() < 0.4:
        work = -(10 ** rng.uniform(-5.0, 1.0)) * reach
    return ExponentialLaw(float(work), float(reach))


def random_path(seed, rigid=False):
    """Body, stiffness, friction, and for each of four steps the punch, the load (or None) and the sliding."""
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.choice([16, 21, 32, 48], 2))
    nu = float(rng.choice([rng.uniform(-0.9, 0.5), rng.uniform(0.0, 0.5), 0.5, 0.3, 0.0]))
    height = rng.choice([np.inf, 10 ** rng.uniform(-2.0, 0.6)])
    if rigid:
        nu, height = 0.5, 10 ** rng.uniform(-1.0, 0.6)
    friction, load = 10 ** rng.uniform(-2.0, 0.35), 10 ** rng.uniform(-3.0, 0.3)
    punch = rough(shape, rng.uniform(0.1, 1.0), rng.uniform(3.0, min(shape) / 2), rng)
    loaded = not rigid and (not np.isfinite(height) or rng.random() < 0.5)
    depth, deepest = rng.uniform(0.1, 0.6) * punch.mean(), 0.8 * punch.mean()
    sliding, steps = np.zeros((2, 1, 1)), []
    for step in range(4):
        if step:
            factor = 10 ** rng.uniform(-0.5, 0.3)
            load, depth = load * factor, min(depth * factor, deepest)
            if np.isfinite(height):
                way = 10 ** rng.uniform(-2.5, 0.5) * 0.2 * friction * min(height, 1.0)
                sliding = sliding + way * rng.normal(size=(2, 1, 1))
        steps.append((punch, load, sliding) if loaded else (punch - depth, None, sliding))
    body = ElasticBody(nu, float(height) if np.isfinite(height) else None)
    return body, body.response(shape), friction, steps


def violation(stiffness, punch, load, laws, found, start, held=None):
    """Largest violation of Signorini's and Coulomb's conditions by NumPy's transforms, over the largest traction."""
    tangential, normal, shape = found.tangential.displacement[0], found.displacement[0], punch.shape[1:]
    xx, xy, yy, xz, yz, zz = stiffness.elements
    zz, rigid = zz.copy(), load is None and np.isinf(stiffness.normal[0, 0])
    if load is not None or rigid:
        zz[0, 0] = 0.0
    x, y, z = np.fft.rfft2(np.array([*tangential, normal]))
    shear = np.fft.irfft2(np.array([xx * x + xy * y + 1j * xz * z, xy * x + yy * y + 1j * yz * z]), shape)
    restoring = np.fft.irfft2(zz * z - 1j * (xz * x + yz * y), shape)
    pull = 0.0 * restoring
    if laws.normal_law is not None:
        pull = laws.normal_law.work / laws.normal_law.length * np.exp((normal - punch[0]) / laws.normal_law.length)
    pressure = (found.pressure[0].mean() if rigid else load or 0.0) - restoring + pull
    touching = punch[0] <= normal
    slid = tangential - (0.0 if start is None else start.tangential[0] + start.dragged)
    way = np.hypot(*slid)
    if held is None:
        bound = np.multiply(laws.friction, pressure, out=np.zeros(shape), where=touching & (pressure > 0.0))
    else:
        bound = held(np.maximum(pressure, 0.0), way) * touching
    slips = (bound > 0.0) & (bound < np.inf) & (way > 0.0)
    against = np.hypot(*(shear + np.where(slips, bound, 0.0) * slid / np.where(way > 0.0, way, 1.0)))
    worst = max(
        abs(pressure[~touching]).max(initial=0.0),
        -pressure[touching].min(initial=0.0),
        (np.hypot(*shear) - bound).max(),
        against[slips].max(initial=0.0),
    )
    lengths = max((normal - punch[0]).max(), abs(normal.mean()) if rigid else 0.0) / np.ptp(punch)
    balance = 0.0 if load is None else abs((np.where(touching, pressure, 0.0) - pull).mean() / load - 1.0)
    return max(worst / (max(pressure[touching].max(initial=0.0), abs(pull).max()) or 1.0), lengths, balance)


if __name__ == "__main__":
    ended, transforms, worst = Counter(), [], 0.0
    for seed in range(*map(int, sys.argv[1:3])):
        body, stiffness, friction, steps = random_path(seed, "rigid" in sys.argv)
        law = random_law(seed, steps[0][0].shape[1:]) if "law" in sys.argv else None
        laws = Interactions(True, normal_law=law, friction=np.inf if "sticking" in sys.argv else friction)
        before, held = None, None
        if "rate" in sys.argv:
            rate, held = random_rate(seed, friction)
            laws = replace(laws, slip_rate=rate)
        for step, (punch, load, sliding) in enumerate(steps):
            start = None if before is None else following(before, punch, sliding)
            before = equilibrate(punch, stiffness, load, ALONE, laws, start, sliding)
            ended[int(before.status[0])] += 1
            transforms.append(int(before.n_transforms[0]))
            if before.status[0] != 0:
                print(
                    f"seed {seed} step {step}: status {before.status[0]}, {body}, {laws}, "
                    f"{int(before.touching.sum())} nodes touch",
                    flush=True,
                )
                break
            worst = max(worst, violation(stiffness, punch, load, laws, before, start, held))
    print(f"status {dict(ended)}, worst violation {worst:.1e}, transforms: median {np.median(transforms):.0f},")
    print(f"ninth decile {np.percentile(transforms, 90):.0f}, most {max(transforms)}")
