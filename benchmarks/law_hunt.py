"""Random scenes with laws between the surfaces: how each path ends, and an independent check of every step called ok.

`python benchmarks/law_hunt.py exponential 0 600` solves 600 paths: kind, first seed, and the one after the last. Kinds
are exponential, cohesive, rigid (slabs of Poisson's ratio 1/2 under displacement), friction, friction_and_law (of
attraction), friction_and_repulsion, rigid_friction_and_law, three in which touching nodes stick: sticking,
sticking_and_law and rigid_sticking, hardness (with an exponential law), limited_friction (of a shear strength), and
three of other laws: other_law, friction_and_other_law and limited_friction_and_other_law. A further argument names a
solver in place of the automatic one.
"""

import sys
import time
import warnings
from collections import Counter

import numpy as np

from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.maugis_dugdale import MaugisDugdaleLaw
from gfmd_numba.interface.power_laws import LennardJonesLaw, ShiftedPowerLaw
from gfmd_numba.interface.squared_exponential import SquaredExponentialLaw
from gfmd_numba.scene import InputError, load_scene
from gfmd_numba.solvers.equilibrium import following
from gfmd_numba.solvers.status import Status

KINDS = (
    *("exponential", "cohesive", "rigid", "friction", "friction_and_law", "friction_and_repulsion"),
    *("rigid_friction_and_law", "sticking", "sticking_and_law", "rigid_sticking", "hardness"),
    *("limited_friction", "other_law", "friction_and_other_law", "limited_friction_and_other_law"),
)
OTHERS = ("squared_exponential", "maugis_dugdale", "power_law")
NEWTON = 100  # steps after which damped dynamics takes over


def other_law(rng, rubs, work, length):
    """A law of the gap other than the exponential one, which softens as fast as that, or less."""
    name = str(rng.choice(OTHERS if rubs else (*OTHERS, "lennard_jones")))
    work /= {"maugis_dugdale": 5.0, "power_law": 6.0}.get(name, 1.26)
    if name == "power_law" and rng.random() < 0.4:
        work = -work
    return {name: {"work_of_adhesion": float(work), "range": float(length)}}


def random_scene(kind, seed):
    """A path of four steps on a self-affine surface of 16 to 4096 nodes; its law softens by x up to 1."""
    rng = np.random.default_rng([KINDS.index(kind), seed])
    g, hurst = 10 ** rng.uniform(-3, -0.5), rng.uniform(0.1, 1)
    inverse = [int(rng.choice(each)) for each in ([1, 2, 4, 8], [8, 32, 64, 128], [1, 2])]
    aspect_ratio, nu = rng.choice([None, 1.0, 0.3, 0.1, 1.0]), float(rng.choice([0.0, 0.3, 0.45, 0.49, 0.3, 0.5]))
    loaded = rng.random() < 0.5
    if kind.startswith("rigid"):
        aspect_ratio, nu, loaded = rng.choice([3.0, 1.0, 0.3, 0.1]), 0.5, False
    elif nu == 0.5:
        loaded = True
    if aspect_ratio is None:
        loaded = True
    interface, range_ = {}, 10 ** rng.uniform(-3.5, 0.0)
    work = 10 ** rng.uniform(-3, 0) * np.pi * np.prod(inverse) * range_**2
    law = kind.removeprefix("rigid_") if kind != "rigid" else str(rng.choice(["exponential", "cohesive"]))
    rubs = "friction" in law or "sticking" in law
    if law == "cohesive":
        ratio = 10 ** rng.uniform(-0.7, 0.7)
        work *= min(np.e**2, ratio**2 * np.exp(1.5) / 4.0)  # it softens less, at some gap or slip
        interface["cohesive"] = {
            "work_of_adhesion": float(work * g * g),
            "normal_length": float(range_ * g),
            "tangential_length": float(range_ * g * ratio),
        }
    elif "other_law" in law:
        interface |= other_law(rng, rubs, work * g * g, range_ * g)
    elif law not in ("friction", "limited_friction", "sticking"):
        if "repulsion" in law or (law in ("exponential", "hardness") and rng.random() < 0.4):
            work = -(10 ** rng.uniform(-5, 1)) * max(range_, 1e-3)
        interface["exponential"] = {"work_of_adhesion": float(work * g * g), "range": float(range_ * g)}
    if rubs:
        coefficient = float(10 ** rng.uniform(-2, 0.3))
        limit = {"limit": float(coefficient * g * 10 ** rng.uniform(-2.0, 0.0))} if "limited" in law else {}
        interface["friction"] = {"coefficient": np.inf if "sticking" in law else coefficient} | limit
    if (
        kind == "hardness"
        or rubs
        or (not interface.keys() & {"cohesive", "lennard_jones"} and work > 0)
        or rng.random() < 0.5
    ):
        interface["hard_wall"] = {}
    deepest, least, most = 0.2 if nu < 0.5 else 0.05, np.log(1e-3), 1.0
    if kind == "hardness":  # above what the law pulls, so that there is a load that it bears
        pull = work / range_
        hardness = 10 ** rng.uniform(-2.0, 0.3) + 1.5 * max(pull, 0.0)
        interface["hard_wall"] = {"hardness": float(hardness * g)}
        least, most = np.log(1e-2), 0.9 * (hardness - pull)
    if loaded:
        path = [{"reduced_pressure": float(most * each)} for each in np.exp(rng.uniform(least, 0, 4))]
    else:
        highest = -0.5 * deepest if interface.keys() - {"friction", "hard_wall"} else 0.0
        path = [{"displacement": float(each)} for each in rng.uniform(highest, deepest, 4) * g]
    slides = aspect_ratio is not None and bool(interface.keys() & {"friction", "cohesive"})
    if slides:
        stride = 0.05 if "cohesive" not in interface else 2.0 * interface["cohesive"]["tangential_length"] / g
        for step in path[1:]:
            step["sliding"] = float(rng.normal() * stride * g)
    body = {"poissons_ratio": nu} | ({} if aspect_ratio is None else {"aspect_ratio": float(aspect_ratio)})
    return {
        "scene": {
            "body": body,
            "roughness": {"method": "psd", "hurst": float(hurst), "rms_gradient": float(g)},
            "interface": interface,
            "loading": path[0],
        },
        "path": path[1:],
        "discretisation": {name: 1 / each for name, each in zip(("eps_c", "eps_f", "eps_t"), inverse, strict=True)},
        "seed": int(rng.integers(1000)),
        "numerics": {"max_iterations": 200000 if rubs and kind != "friction" else 2000},
    }


def attraction(law, gap):
    """Traction at gaps by the closed form of each law, on a line beyond the gap to which that holds."""
    length = law.length
    if isinstance(law, ExponentialLaw):
        return law.work / length * np.exp(-gap / length)
    if isinstance(law, SquaredExponentialLaw):
        return law.work * gap / length**2 * np.exp(-0.5 * (gap / length) ** 2)
    if isinstance(law, MaugisDugdaleLaw):
        return law.work / length * np.clip((1.0 - gap / length) / law.taper + 0.5, 0.0, 1.0)
    if isinstance(law, LennardJonesLaw):
        work, kink = 3.0 * law.works[1], 0.5 * length
        x = length / np.maximum(gap, kink)
        pull, rise = x**3 - x**9, 9.0 * x**10 - 3.0 * x**4
        return 8.0 * work / (3.0 * length) * (pull + rise * np.minimum(gap - kink, 0.0) / length)
    assert isinstance(law, ShiftedPowerLaw)
    (power,), work, kink = law.powers, -law.works[0], -0.9 * length
    x = 1.0 + np.maximum(gap, kink) / length
    line = 1.0 - (power + 1.0) * np.minimum(gap - kink, 0.0) / (length * x)
    return work * power / length * x ** -(power + 1.0) * line


def unbalanced(bears, gap, touching, hardness):
    """Largest traction that the wall cannot bear: from 0 to the hardness, and just that where it is penetrated."""
    least, most = np.where(touching & (gap < 0.0), hardness, 0.0), np.where(touching, hardness, 0.0)
    return np.maximum(least - bears, bears - most).max()


def unrubbed(bears, touching, shear, slid, laws):
    """Largest tangential traction that friction does not balance; `slid` is 0 where that is not known."""
    bound = np.multiply(laws.friction, bears, out=np.zeros_like(bears), where=touching & (bears > 0.0))
    bound = np.minimum(bound, np.inf if laws.shear_strength is None else laws.shear_strength)
    slips = (bound > 0.0) & (bound < np.inf) & (slid != 0.0)
    against = np.abs(shear[slips] + np.sign(slid[slips]) * bound[slips])
    return max((np.abs(shear) - bound).max(), against.max(initial=0.0))


def violation(problem, contact, sliding, before):
    """Largest violated condition over the largest traction, by NumPy's transforms, and what rounding leaves open."""
    found, punch, laws = contact.equilibrium, contact.punch[0], problem.interface
    u, n = found.displacement[0], contact.punch.shape[1]
    u1 = np.zeros(n) if found.tangential is None else found.tangential.displacement[0, 0]
    k11 = k13 = np.zeros(n // 2 + 1)
    k33 = problem.body.condensed_stiffness(grid.wavenumbers(n))
    if found.tangential is not None:
        both = problem.body.response((n,))
        k11, k13, k33 = both.elements[0], both.elements[1], both.normal.copy()
    rigid = problem.mean_pressure is None and np.isinf(k33[0])
    if problem.mean_pressure is not None or rigid:
        k33[0] = 0.0
    c1, c3 = np.fft.rfft(u1), np.fft.rfft(u)
    elastic = np.fft.irfft(k33 * c3 - 1j * k13 * c1, n)
    shear = np.fft.irfft(k11 * c1 + 1j * k13 * c3, n)
    pull, drag = np.zeros(n), np.zeros(n)
    hardness = np.inf if laws.hardness is None else laws.hardness
    if laws.normal_law is not None:
        gap = punch - u if laws.hardness is None else np.maximum(punch - u, 0.0)
        pull = attraction(laws.normal_law, gap)
    if laws.cohesive is not None:
        g, s = (punch - u) / laws.cohesive.normal, (sliding - u1) / laws.cohesive.tangential
        decay = laws.cohesive.work * np.exp(-np.maximum(g, 0.0) - s * s)
        pull = g / laws.cohesive.normal * np.where(g < 0.0, laws.cohesive.work * np.exp(-g), decay)
        drag = 2.0 * s / laws.cohesive.tangential * (1.0 + np.maximum(g, 0.0)) * decay
    load = float(found.pressure[0].mean()) if rigid else problem.mean_pressure or 0.0
    touching = (u >= punch) & laws.hard_wall
    slid = np.zeros(n)
    if found.n_iterations[0] <= NEWTON and problem.numerics.solver != "verlet":  # which has anchors of its own
        start = following(before, contact.punch, sliding) if before is not None else None
        slid = u1 - (0.0 if start is None else (start.tangential + start.dragged)[0, 0])

    def wrong(load):
        bears = load - elastic + pull
        rubbed = 0.0 if laws.friction is None else unrubbed(bears, touching, shear, slid, laws)
        return max(unbalanced(bears, punch - u, touching, hardness), rubbed)

    if rigid:  # the mean pressure is a multiplier, which the mean of all pressures tells to the residual alone
        load += min(1e-8 * np.abs(load - elastic).max() * np.linspace(-1.0, 1.0, 401), key=lambda by: wrong(load + by))
    bears, worst = load - elastic + pull, wrong(load)
    overlap = laws.hard_wall and laws.hardness is None and (u > punch).any()
    largest = max(min(bears.max(), hardness), np.abs(pull).max(), np.abs(drag).max())
    if laws.friction is None:
        worst = max(worst, np.abs(shear - drag).max())
    if rigid:
        worst = max(worst, k33.max() * abs(u.mean()))
    borne = np.where(u > punch, hardness, np.minimum(bears, hardness)) if laws.hardness is not None else bears
    pressure = np.where(touching, borne, 0.0) - pull
    worst = max(worst, 0.1 * np.abs(found.pressure[0] - pressure).max(), np.inf if overlap else 0.0)
    if problem.mean_pressure is not None:
        worst = max(worst, largest * abs(pressure.mean() / problem.mean_pressure - 1.0))
    rounding = max(k33.max(), k11.max()) * np.spacing(max(np.abs(u).max(), np.abs(u1).max()))
    if not (worst > 1e-140 or problem.mean_pressure):  # nothing is left
        return 0.0, 0.0
    return worst / largest, rounding / largest


def follow(kind, seed, solver="auto"):
    """Status of the last step, the worst violation over what is allowed, and transforms and iterations of each step.

    None if the scene is refused.
    """
    scene = random_scene(kind, seed)
    scene["numerics"]["solver"] = solver
    try:
        whole, _ = read_contact(*load_scene(scene)).reduced
    except InputError as error:
        known = any(word in str(error) for word in ("resolve", "room", "snap"))  # of what solves none
        return None if known else sys.exit(f"{seed}: {error}")
    before, worst, spent, status = None, 0.0, [], Status.ok
    with warnings.catch_warnings(action="ignore", category=UserWarning):
        for problem, contact in zip(whole.at_each_load, solve_path(whole, 0), strict=True):
            status = Status(int(contact.equilibrium.status[0]))
            spent.append((int(contact.equilibrium.n_transforms[0]), int(contact.equilibrium.n_iterations[0])))
            if status != Status.ok:
                break
            found, rounding = violation(problem, contact, problem.sliding[0], before)
            worst = max(worst, found / (1.01 * problem.numerics.residual + 4.0 * rounding))
            before = contact.equilibrium
    return status, worst, spent


if __name__ == "__main__":
    kind, ended, steps, failed = sys.argv[1], Counter(), [], 0
    solver = sys.argv[4] if len(sys.argv) > 4 else "auto"
    started = time.process_time()
    for seed in range(*map(int, sys.argv[2:4])):
        result = follow(kind, seed, solver)
        if result is None:
            ended["refused"] += 1
            continue
        status, worst, spent = result
        ended[status.name] += 1
        steps += spent
        if status != Status.ok:
            print(f"{kind} {seed}: {status.name} in step {len(spent)} after {spent[-1][0]} transforms", flush=True)
        if not worst <= 1.0:
            failed += 1
            print(f"{kind} {seed}: called ok, but violated by {worst:.1e} times what is allowed", flush=True)
    transforms, iterations = np.array(steps).T
    low, median, high, ninth = np.percentile(transforms, (25, 50, 75, 90))
    print(f"{kind} by {solver}: {dict(ended)}; {failed} fail the check; of {transforms.size} steps", end=" ")
    print(f"{(iterations > NEWTON).sum()} took more than {NEWTON} iterations; transforms a step: median {median:.0f}")
    print(f"({low:.0f} to {high:.0f}), ninth decile {ninth:.0f}, most {transforms.max()};", end=" ")
    print(f"{time.process_time() - started:.0f} s")
