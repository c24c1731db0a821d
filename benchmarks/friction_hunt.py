"""Random paths with friction by Newton's method alone: how many steps end, and an independent check of each.

`python benchmarks/friction_hunt.py 0 1000` takes about five minutes: first seed, and the one after the last. With
`two` as the last argument a second elastic body, layered in a third of the paths, is in place of the rigid punch; with
`rate` friction depends on the slip rate, by velocity strengthening, a table that rises or falls, or a function.
"""

import sys
from collections import Counter

import numpy as np

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.slip_rate import SlipRateFriction, UserFunction
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

ALONE = Options("frictional_newton", max_iterations=100)  # the dynamics does not take over


def facing(seed, body):
    """A second elastic body and its part of 1/E*."""
    rng = np.random.default_rng([seed, 1])
    ratios, height, share = rng.uniform(-0.9, 0.5, 2), 10 ** rng.uniform(-2.0, 0.6), rng.uniform()
    if rng.uniform() < 1 / 3:
        top, below = (Material(e, float(nu)) for e, nu in zip((1.0, 10 ** rng.uniform(-1, 1)), ratios, strict=True))
        if body.aspect_ratio is None:
            return ElasticBody.layered((0.1 * height,), (top,), below), share
        return ElasticBody.layered((0.1 * height, 0.9 * height), (top, below), None), share
    nu = rng.choice([ratios[0], 0.5])
    return ElasticBody(float(nu), None if body.aspect_ratio is None else height), share


def random_path(seed):
    """Stiffness, friction, and for each of five steps the punch, the load (or None) and the sliding."""
    rng = np.random.default_rng(seed)
    nx = int(rng.choice([128, 256, 255, 512, 1000, 1024, 2048]))
    hurst, waves = rng.uniform(0.1, 1.0), int(rng.integers(4, nx // 2))
    nu = float(rng.choice([rng.uniform(-0.9, 0.5), rng.uniform(0.0, 0.5), 0.5, 0.3, 0.0]))
    height = rng.choice([np.inf, 10 ** rng.uniform(-2.0, 0.6)])
    friction = float(10 ** rng.uniform(-2.0, 0.35))
    heights = self_affine.SelfAffineWaves(hurst, 2, waves).heights((nx,), int(rng.integers(1e6)), range(1))
    punch = heights.max(axis=1, keepdims=True) - heights
    loaded = rng.choice(["load", "displacement"]) == "load" if np.isfinite(height) else True
    load = 10 ** rng.uniform(-3.0, 0.3)
    depth = 10 ** rng.uniform(-1.5, 0.5 if nu < 0.5 else -0.3) * punch.mean()
    deepest = np.inf if nu < 0.5 else 0.8 * punch.mean()
    sliding, steps = 0.0, []
    for step in range(5):
        if step:
            change = rng.choice(["load", "slide", "both"])
            if change != "slide":
                factor = 10 ** rng.uniform(-0.5, 0.3)
                load, depth = load * factor, min(depth * factor, deepest)
            if change != "load" and np.isfinite(height):
                sliding += rng.normal() * 10 ** rng.uniform(-2.5, 0.5) * 0.05 * friction * min(height, 1.0) * 4.0
        steps.append((punch, load, sliding) if loaded else (punch - depth, None, sliding))
    body = ElasticBody(nu, float(height) if np.isfinite(height) else None)
    return body, body.response((nx,)), friction, steps


def random_rate(seed, friction):
    """Friction by the slip rate, and what it holds by pressure and slip, of its own formulae."""
    rng = np.random.default_rng([seed, 2])
    speed, rise, duration = (10 ** rng.uniform(*exponents) for exponents in ((-5.0, 1.0), (-2.5, 0.3), (-2.0, 2.0)))
    speed, rise, kind = speed * friction / duration, rise * friction, rng.integers(4)
    rates, further = (0.0, speed, 10.0 * speed), [(1.0, 2.0), (-0.1, -0.5)][kind % 2]
    values = tuple(friction + share * (rise if kind % 2 == 0 else friction) for share in (0.0, *further))
    strength = 10 ** rng.uniform(-1.5, 0.5) * friction

    def held(pressure, slip):
        rate = slip / duration
        if kind == 3:
            return np.minimum(friction * pressure, film(0.0, pressure, rate))
        rises = np.interp(rate, rates, values) if kind else friction + rise * np.log(1.0 + rate / speed)
        return rises * pressure

    def film(gap, pressure, rate):
        return strength * (1.0 + np.arcsinh(rate / speed)) + 0.1 * friction * pressure

    laws = (
        SlipRateFriction(friction, rise, speed),
        SlipRateFriction(friction, rates=rates, coefficients=values),
        SlipRateFriction(friction, rates=rates, coefficients=values),
        SlipRateFriction(friction, shear_strength=UserFunction(film, 1.0, 1.0)),
    )
    return laws[kind].lasting(duration), held


def violation(stiffness, punch, load, held, found, start):
    """Largest violation of Signorini's and Coulomb's conditions by NumPy's transforms, over the largest pressure."""
    u1, u3, n = found.tangential.displacement[0, 0], found.displacement[0], punch.shape[1]
    k33 = stiffness.normal.copy()
    rigid = load is None and np.isinf(k33[0])
    if load is not None or rigid:
        k33[0] = 0.0
    c1, c3 = np.fft.rfft(u1), np.fft.rfft(u3)
    shear = np.fft.irfft(stiffness.elements[0] * c1 + 1j * stiffness.elements[1] * c3, n)
    pressure = (found.pressure[0].mean() if rigid else load or 0.0) - np.fft.irfft(
        k33 * c3 - 1j * stiffness.elements[1] * c1, n
    )
    touching = punch[0] <= u3
    slid = u1 - (0.0 if start is None else (start.tangential + start.dragged)[0, 0])
    bound = held(np.maximum(pressure, 0.0), abs(slid)) * touching
    worst = max(
        abs(pressure[~touching]).max(initial=0.0),
        -pressure[touching].min(initial=0.0),
        (abs(shear) - bound).max(),
        abs(shear + np.sign(slid) * bound)[touching & (slid != 0.0)].max(initial=0.0),
    )
    lengths = max((u3 - punch[0]).max(), abs(u3.mean()) if rigid else 0.0) / np.ptp(punch)
    balance = 0.0 if load is None else abs(pressure[touching].mean() * touching.mean() / load - 1.0)
    return max(worst / (found.pressure[0].max() or 1.0), lengths, balance)


if __name__ == "__main__":
    ended, transforms, worst = Counter(), [], 0.0
    for seed in range(*map(int, sys.argv[1:3])):
        body, stiffness, friction, steps = random_path(seed)
        if sys.argv[3:] == ["two"]:
            other, share = facing(seed, body)
            stiffness = stiffness.in_series(other.response((steps[0][0].shape[1],)), share)
        before, law, held = None, None, lambda pressure, slip, friction=friction: friction * pressure
        if sys.argv[3:] == ["rate"]:
            law, held = random_rate(seed, friction)
        laws = Interactions(True, friction=friction, slip_rate=law)
        for step, (punch, load, sliding) in enumerate(steps):
            start = None if before is None else following(before, punch, sliding)
            before = equilibrate(punch, stiffness, load, ALONE, laws, start, sliding)
            ended[int(before.status[0])] += 1
            transforms.append(int(before.n_transforms[0]))
            if before.status[0] != 0:
                print(
                    f"seed {seed} step {step}: status {before.status[0]}, {body}, friction {law or f'{friction:.3g}'}",
                    flush=True,
                )
                break
            worst = max(worst, violation(stiffness, punch, load, held, before, start))
    print(f"status {dict(ended)}, worst violation {worst:.1e}, transforms: median {np.median(transforms):.0f},")
    print(f"ninth decile {np.percentile(transforms, 90):.0f}, most {max(transforms)}")
