"""Plastic flow inside a body against theory, finite elements and Tamaas, and 200 random contacts and scene files.

python benchmarks/plastic_flow.py [yield|hardness|residual|elements|scenes|files]
python benchmarks/plastic_flow.py files COUNT FIRST, of the random files
python benchmarks/plastic_flow.py tamaas PYTHON, the interpreter of an environment that has Tamaas and SciPy
"""

import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

from gfmd_numba.contact import evaluation, plastic_measures
from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.contact.plastic_flow import equivalent, plastic_state, stresses
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import LoadStep
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.plastic_sublayers import PlasticSublayers
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.kernels import Hardening
from gfmd_numba.roughness.surfaces import GivenSurface
from gfmd_numba.scene import InputError
from gfmd_numba.scene.scene_file import load_scene
from gfmd_numba.solvers import table
from gfmd_numba.solvers.status import Status

NU = 0.3


def pressed(heights, loads, plasticity, nu=NU):
    """Contacts under loads (E*), one after the other, of heights in L_x."""
    dimension = heights.ndim
    options = table.Options(table.automatic(dimension, ()), 1e-8, 200_000)
    steps = [LoadStep(load, (0.0,) * dimension) for load in loads]
    surface, body, laws = GivenSurface.of(heights), ElasticBody(nu, None), Interactions(hard_wall=True)
    problem = Problem(surface, body, laws, loads[0], None, options, path=tuple(steps[1:]), plasticity=plasticity)
    return list(solve_path(problem, 0))


def parabola(nodes, dimension):
    """Heights of a punch of radius 1 above a period of 1."""
    x = np.arange(nodes) / nodes - 0.5
    return -0.5 * x**2 if dimension == 1 else -0.5 * (x[:, np.newaxis] ** 2 + x**2)


def first_yield(forms=("ball", "cylinder")):
    """Largest von Mises stress of elastic contacts that are far apart, in Hertz's pressure p0."""
    for name in forms:
        is_ball = name == "ball"
        a, nodes, depth = (0.05, 256, 0.06) if is_ball else (0.004, 8192, 0.008)
        p0 = 2.0 * a / np.pi if is_ball else 0.5 * a
        load = 2.0 / 3.0 * np.pi * a**2 * p0 if is_ball else 0.5 * np.pi * a * p0
        plasticity = PlasticSublayers(Hardening(1.0), depth, 24 if is_ball else 48, 1)
        found = pressed(parabola(nodes, 2 if is_ball else 1), [load], plasticity)[0]
        told = p0 / plastic_measures.largest_von_mises(found)[0]
        known = "1.60" if is_ball else "von Mises, nu = 0.3: 3.1 k = 1.79"
        print(f"{name:9} p0/Y at first yield {told:.3f}  (Johnson 1985, 6.1: {known})")


def of_kogut_and_etsion(load, stress):
    """Mean pressure of a ball of radius 1 over a yield stress, by the fits to finite elements of J. Appl. Mech. 69:657.

    Kogut and Etsion (2002) press a ball onto a rigid plane; up to 110 times the approach at first yield.
    """
    first = (0.5 * np.pi * 2.8 * (0.454 + 0.41 * NU) * stress) ** 2  # approach, E* = 1
    of_load, of_area = load / (2.0 / 3.0 * 2.8 * (0.454 + 0.41 * NU) * stress * np.pi * first), np.pi * first
    approach = (of_load / 1.03) ** (1.0 / 1.425)
    if approach <= 6.0:
        return load / (of_area * 0.93 * approach**1.136) / stress, approach
    approach = (of_load / 1.40) ** (1.0 / 1.263)
    return load / (of_area * 0.94 * approach**1.146) / stress, approach


def hardness(nodes=64):
    """Mean pressure of a ball over its contact, deep in the plastic regime, over the yield stress."""
    a = 0.12
    for ratio in (3.0, 6.0, 10.0, 20.0, 30.0, 100.0):
        stress = a / ratio
        load = 2.8 * stress * np.pi * a**2
        steps = list(load * np.linspace(0.1, 1.0, 10))
        found = pressed(parabola(nodes, 2), steps, PlasticSublayers(Hardening(stress), 0.35, 24, 1))[-1]
        area = float(evaluation.contact_area_fraction(found)[0])
        expected, approach = of_kogut_and_etsion(load, stress)
        print(
            f"E* a / (Y R) {np.sqrt(area / np.pi) / stress:6.1f}  mean pressure {load / area / stress:.3f} Y  "
            f"of Kogut and Etsion {expected:.3f} Y at {approach:.0f} times the first approach  "
            f"plastic strain up to {plastic_measures.largest_plastic_strain(found)[0]:.3f}",
            flush=True,
        )


def residual():
    """What is left of a ball and a cylinder once they are drawn off, on the axis."""
    for name, dimension, ratio in (("ball", 2, 2.5), ("cylinder", 1, 2.5)):
        a, nodes = 0.1, 128 if dimension == 2 else 512
        p0 = 2.0 * a / np.pi if dimension == 2 else 0.5 * a
        load = p0 * (2.0 / 3.0 * np.pi * a**2 if dimension == 2 else 0.5 * np.pi * a)
        loads = [*load * np.linspace(0.1, 1.0, 10), 1e-6 * load]
        *_, loaded, free = pressed(
            parabola(nodes, dimension), loads, PlasticSublayers(Hardening(p0 / ratio), 0.25, 32, 1)
        )
        flow, (_, along) = plastic_state(free), stresses(free)
        middle = nodes // 2
        along, flowed = (each[:, -1 if dimension == 1 else middle, middle] for each in (along, flow.equivalent))
        deep = np.cumsum(flow.body.waves.thickness)
        last = np.flatnonzero(flowed)[-1]
        again = (flow.equivalent > plastic_state(loaded).equivalent).any()
        most, below = flowed.argmax(), last + 1
        print(
            f"{name:9} drawn off from p0 = {ratio} Y: stress along x on the axis, where most has flowed (depth "
            f"{deep[most] / a:.2f} a), {along[most] / (p0 / ratio):+.3f} Y; below the plastic zone (depth "
            f"{deep[below] / a:.2f} a) {along[below] / (p0 / ratio):+.3f} Y; dent over rim "
            f"{flow.residual_displacement.min() / flow.residual_displacement.max():+.2f}; flows back: {bool(again)}"
        )


def elements(
    meshes=((32, 24), (48, 34), (64, 44)),
    places=(0.0, 0.25, 0.25, 0.5),
    grids=((256, 32), (512, 64), (1024, 128)),
):
    """A sinusoid with a plastic body in plane strain, on the grid and by finite elements, under equal loads.

    The integral of the plastic strain depends on where nodes lie at the edges of contact: the punch is pressed in
    several places, in elements from a corner, of which 0.25 stands for 0.75 too. It is also printed for each of our
    grids (nodes, sublayers) under the loads of the last mesh.
    """
    from elastoplastic_elements import PlasticBody
    from finite_elements import graded

    stress, slope, amplitude = 0.008, 0.01, 0.01
    x = np.arange(512) / 512
    heights = amplitude * np.cos(2.0 * np.pi * (x - 0.5))

    def off(columns, rows, place):
        body, middle = PlasticBody(columns, graded(1.0, rows, 0.5 / columns), NU, stress, slope), 0.5 + place / columns
        punch = amplitude * (1.0 - np.cos(2.0 * np.pi * (body.x - middle)))
        steps = [body.step(punch - depth * amplitude) for depth in (0.125, 0.25, 0.375, 0.5)]
        loads = [float((body._lengths() * p).sum()) for p in steps]
        found = pressed(heights, loads, PlasticSublayers(Hardening(stress, slope), 0.2, 64, 1))[-1]
        flow, p = plastic_state(found), found.equilibrium.pressure[0]
        volume = flow.body.waves.thickness @ flow.equivalent.mean(axis=(1, 2))
        spread = [
            np.sqrt((weight * p * (at - centre) ** 2).sum() / (weight * p).sum())
            for weight, p, at, centre in ((body._lengths(), steps[-1], body.x, middle), (1.0, p, x, 0.5))
        ]
        theirs = steps[-1].max(), spread[0], body.equivalent.max(), (body.equivalent * body.points.dx).sum()
        return np.array([p.max(), spread[1], flow.equivalent.max(), volume]) / theirs - 1.0, loads

    names = "peak pressure", "rms distance of the pressure from the middle", "largest plastic strain", "its integral"
    for mesh in meshes:
        known = {place: off(*mesh, place) for place in dict.fromkeys(places)}
        every, loads = np.array([known[place][0] for place in places]), known[places[0]][1]
        columns = zip(names, every.mean(axis=0), every.min(axis=0), every.max(axis=0), strict=True)
        told = (f"{name} {mean:+.2%} ({least:+.2%} to {most:+.2%})" for name, mean, least, most in columns)
        print(f"{mesh[0]} x {mesh[1]} quadratic elements: {'  '.join(told)}", flush=True)
    for nodes, sublayers in grids:
        heights = amplitude * np.cos(2.0 * np.pi * (np.arange(nodes) / nodes - 0.5))
        flow = plastic_state(pressed(heights, loads, PlasticSublayers(Hardening(stress, slope), 0.2, sublayers, 1))[-1])
        volume = flow.body.waves.thickness @ flow.equivalent.mean(axis=(1, 2))
        print(f"{nodes} nodes, {sublayers} sublayers: integral of the plastic strain {volume:.5e}", flush=True)


_TAMAAS = """
import sys, time
import numpy as np
import tamaas as tm
from tamaas.nonlinear_solvers import DFSANECXXSolver
tm.set_log_level(tm.LogLevel.error)
given = np.load(sys.argv[1])
heights, nz, depth, nu = given["heights"], int(given["nz"]), float(given["depth"]), float(given["nu"])
model = tm.ModelFactory.createModel(tm.model_type.volume_2d, [depth, 1.0, 1.0], [nz, *heights.shape])
model.E, model.nu = 1.0 - nu**2, nu
law = tm.materials.IsotropicHardening(model, float(given["stress"]), float(given["slope"]))
contact = tm.PolonskyKeerRey(model, np.ascontiguousarray(heights - heights.max()), 1e-10)
flow = DFSANECXXSolver(tm.Residual(model, law))
flow.tolerance = 1e-6  # as ours, and not 1e-9, which takes it half as long again
both = tm.EPICSolver(contact, flow, 1e-6, 0.3)
started = time.process_time()
error = both.acceleratedSolve(float(given["load"]))
took = time.process_time() - started
pressure, flowed = (np.asarray(model[name]) for name in ("traction", "cumulated_plastic_strain"))
np.savez(sys.argv[2], pressure=pressure[..., 2], flowed=flowed.reshape(nz, *heights.shape), took=took, error=error)
"""


def beside_tamaas(interpreter, heights, load, plasticity, most=600.0):
    """A contact in one increment here and by Tamaas, which may take so many seconds; prints how far both agree."""
    started = time.process_time()
    found = pressed(heights, [load], plasticity)[0]
    took, told = time.process_time() - started, f"{len(heights)} x {len(heights)} x {plasticity.sublayers}"
    with tempfile.TemporaryDirectory() as folder:
        given, result = Path(folder) / "given.npz", Path(folder) / "result.npz"
        stress, slope, *_ = plasticity.hardening
        nz, depth = plasticity.sublayers, plasticity.depth
        np.savez(given, heights=heights, nz=nz, depth=depth, nu=NU, stress=stress, slope=slope, load=load)
        command = ["prlimit", f"--cpu={most:.0f}", interpreter, "-c", _TAMAAS, given, result]
        subprocess.run(command, env={"OMP_NUM_THREADS": "1"})
        if not result.exists():
            told += f": processor time {took:.2f} s, of Tamaas more than {most:g} s, ratio above {most / took:.0f}"
            print(told, flush=True)
            return
        theirs = dict(np.load(result))
    flow, p = plastic_state(found), found.equilibrium.pressure[0]
    off = np.linalg.norm(p - theirs["pressure"]) / np.linalg.norm(p)
    peak, strained = p.max() / theirs["pressure"].max(), flow.equivalent.max() / theirs["flowed"].max()
    area = np.count_nonzero(p) / np.count_nonzero(theirs["pressure"] > 1e-6 * p.max())
    levels = theirs["flowed"].mean(axis=(1, 2))  # at both ends of each linear element, the first at the surface
    integral = np.trapezoid(levels, dx=depth / (nz - 1))
    volume = flow.body.waves.thickness @ flow.equivalent.mean(axis=(1, 2))
    print(
        f"{told}: processor time {took:.2f} s, of Tamaas {theirs['took']:.1f} s, ratio {theirs['took'] / took:.1f}; "
        f"pressures differ by {off:.2%}, their peaks by {peak - 1.0:+.2%}, touching nodes by {area - 1.0:+.2%}, the "
        f"largest plastic strain by {strained - 1.0:+.2%}, its integral by {volume / integral - 1.0:+.2%}",
        flush=True,
    )


def tamaas(interpreter, grids=((32, 16), (64, 32), (128, 64))):
    """A ball on one grid, in one increment, here and by Tamaas: pressures, plastic strains and processor times."""
    a, depth = 0.15, 0.3
    p0 = 2.0 * a / np.pi
    load, hardening = 2.0 / 3.0 * np.pi * a**2 * p0, Hardening(p0 / 2.5, 0.02)
    pressed(parabola(32, 2), [load], PlasticSublayers(hardening, depth, 16, 1))  # compiles kernels, or loads them
    for nodes, nz in grids:
        beside_tamaas(interpreter, parabola(nodes, 2), load, PlasticSublayers(hardening, depth, nz, 1))


def random_scene(rng):
    """Heights, loads, plasticity and Poisson's ratio."""
    dimension = int(rng.integers(1, 3))
    nodes = int(rng.choice([32, 64, 81, 128] if dimension == 1 else [12, 16, 24]))
    q = grid.magnitudes((nodes,) * dimension)
    spectrum = np.where(q > 0.0, np.maximum(q, 1.0) ** -rng.uniform(1.0, 2.5), 0.0) * np.exp(
        2j * np.pi * rng.random(q.shape)
    )
    heights = grid.signal(np.where(q < np.pi * nodes * rng.uniform(0.2, 0.8), spectrum, 0.0), *(nodes,) * dimension)
    heights /= np.sqrt((grid.signal(q * grid.coefficients(heights, dimension), *heights.shape) ** 2).mean())
    nu = float(rng.choice([-0.2, 0.0, 0.3, 0.45, 0.5]))
    loads = list(rng.uniform(0.005, 0.6, int(rng.integers(1, 4))))
    stress = float(np.exp(rng.uniform(np.log(0.15), np.log(2.0))))
    most = stress * (1.0 - nu) / max(1.0 - 2.0 * nu, 1e-12)
    loads = [min(load, 0.8 * most) for load in loads]
    rise = float(rng.choice([0.0, 0.5])) * stress
    hardening = Hardening(stress, float(rng.choice([0.0, 0.01, 0.3])), rise, 0.5 if rise else np.inf)
    depth = None if rng.random() < 0.7 else float(rng.uniform(0.02, 0.5))
    return heights, loads, PlasticSublayers(hardening, depth, int(rng.integers(6, 25)), 1), nu


def violations(contacts, heights, loads, plasticity):
    """Largest violation of each condition by the contacts of a path, found again from their fields alone."""
    worst, before = dict.fromkeys(("status", "yield", "flow rule", "contact", "balance"), 0.0), 0.0
    for found, load in zip(contacts, loads, strict=False):
        flow, solved = plastic_state(found), found.equilibrium
        worst["status"] = max(worst["status"], float(solved.status[0]))
        if solved.status[0]:
            return worst
        p, shape = solved.pressure[0], heights.shape
        flow.body.surface_displacement(flow.strain)
        stress = 2.0 * flow.body.shear * (flow.body.strains(p.reshape(flow.body.shape)) - flow.strain)
        added, size = flow.strain - before, equivalent(stress)
        law, e = plasticity.hardening, flow.equivalent
        bears = law.stress + law.slope * e - law.rise * np.expm1(-e / law.strain)
        worst["yield"] = max(worst["yield"], float((size - bears).max()) / plasticity.hardening.stress)
        flows = equivalent(added) / 1.5
        rest = added - 1.5 * flows * stress / np.maximum(size, 1e-300)
        slack = np.where(flows > 0.0, np.abs(size - bears), 0.0).max()
        both = max(2.0 * flow.body.shear * np.abs(rest).max(), slack)
        worst["flow rule"] = max(worst["flow rule"], float(both) / plasticity.hardening.stress)
        q = grid.magnitudes(shape)
        elastic = grid.coefficients(p, len(shape)) * np.divide(2.0, q, out=np.zeros_like(q), where=q > 0.0)
        gap = -heights - flow.residual_displacement[0] + grid.signal(elastic, *shape)
        gap -= gap[p > 0.0].mean()
        off = max(-gap.min(), np.abs(gap[p > 0.0]).max()) / np.ptp(heights)
        worst["contact"] = max(worst["contact"], float(off), float(-p.min()))
        worst["balance"] = max(worst["balance"], abs(float(p.mean()) / load - 1.0))
        before = flow.strain
    return worst


def scenes(count=200):
    """Random contacts: each has to hold its conditions, or to say that it does not."""
    rng, worst, refused, started = np.random.default_rng(37), {}, 0, time.process_time()
    for i in range(count):
        heights, loads, plasticity, nu = random_scene(rng)
        found = violations(pressed(heights, loads, plasticity, nu), heights, loads, plasticity)
        refused += found.pop("status") > 0.0
        worst = {name: max(value, worst.get(name, 0.0)) for name, value in found.items()}
        if i % 20 == 19:
            told = "  ".join(f"{name} {value:.1e}" for name, value in worst.items())
            print(f"{i + 1:4d} scenes, {refused} refused; worst {told}", flush=True)
    print(f"processor time {time.process_time() - started:.0f} s")


def random_file(rng):
    """Scene with a body that flows as a user may write it: units or none, roughness or a form, loads up and down."""

    def one(*values):
        return values[rng.integers(len(values))]

    dimension, has_units = int(rng.integers(1, 3)), rng.random() < 0.7
    slope, share = 10 ** rng.uniform(-2.5, -0.7), 10 ** rng.uniform(-1.3, 0.3)
    modulus = one(70e9, 200e9, 3e9) if has_units else 1.0
    stress = share * slope * modulus
    plasticity = {"yield_stress": f"{stress / 1e6:.6g} MPa" if has_units else stress}
    if rng.random() < 0.5:
        plasticity["hardening"] = f"{one(0.01, 0.1) * modulus / 1e9:.6g} GPa" if has_units else one(0.01, 0.1)
    if rng.random() < 0.3:
        plasticity |= {"saturation_stress": 1.5 * stress, "saturation_strain": one(0.01, 0.1)}
    plasticity |= {"increments": int(rng.integers(1, 5)), "sublayers": int(rng.integers(8, 25))}
    if rng.random() < 0.2:
        plasticity["depth"] = f"{one(20, 100, 300)} um" if has_units else one(0.02, 0.1, 0.3)
    body = {"poissons_ratio": one(0.0, 0.2, 0.3, 0.45, 0.5, -0.1), "plasticity": plasticity}
    scene = {"dimension": dimension, "body": body, "interface": {"hard_wall": {}}}
    if has_units:
        body["youngs_modulus"], scene["length"] = modulus, one("1 mm", 1e-3)
    file = {"scene": scene, "seed": int(rng.integers(100))}
    if rng.random() < 0.7:
        scene["roughness"] = {"method": "psd", "hurst": one(0.3, 0.8, 1.0), "rms_gradient": slope}
        file["discretisation"] = {"eps_c": 0.25, "eps_f": one(0.125, 0.25) if dimension == 1 else 0.5, "eps_t": 0.5}
        load, key = share * one(0.03, 0.3, 1.0, 2.0), "reduced_pressure"
    else:
        scene["form"] = {"radius": 0.25 / slope * (1e-3 if has_units else 1.0), "points": 64 if dimension == 1 else 20}
        load, key = one(0.03, 0.3, 1.0) * stress, "pressure"
        file.pop("seed")
    scene["loading"] = {key: load}
    shares = one([], [0.01], [2.0, 0.01], [0.5, 2.0, 1.0], [1.0])
    return file | {"path": [{key: load * part} for part in shares]}


def with_more(file, rng):
    """The same file with something else that a user may want, most of which does not go with plastic flow."""

    def one(*values):
        return values[rng.integers(len(values))]

    scene, has_units = file["scene"], "length" in file["scene"]
    unit, length = scene["body"].get("youngs_modulus", 1.0), 1e-3 if has_units else 1.0
    form = {"slope": 0.02, "points": 64 if scene["dimension"] == 1 else 20}
    more = one(
        {"interface": {"hard_wall": {}, "friction": {"coefficient": one(0.2, float("inf"))}}},
        {"interface": {"hard_wall": {}, "maugis_dugdale": {"work_of_adhesion": 1e-6 * unit * length, "range": length}}},
        {"interface": {"hard_wall": {"hardness": 0.1 * unit}}},
        {"interface": {"lennard_jones": {"work_of_adhesion": 1e-6 * unit * length, "range": 1e-2 * length}}},
        {"interface": {"hard_wall": {}, "wear": {"rate": 1.0 / unit}}},
        {"body": scene["body"] | {"aspect_ratio": one(0.1, 1.0)}},
        {"body": scene["body"] | {"relaxation": [{"modulus": unit, "time": 1.0}]}},
        {"body": scene["body"] | {"state": "plane_stress"}},
        {"body": scene["body"] | {"layers": [{"height": 0.1 * length, "youngs_modulus": unit, "poissons_ratio": 0.3}]}},
        {"body": scene["body"] | {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02}}},
        {"counter_body": {"youngs_modulus": unit, "poissons_ratio": 0.3}},
        {"periodic": False},
        {"loading": {"displacement": 1e-3 * length}},
        {"loading": {"pressure": f"{1e-3 * unit / 1e3:.4g} kPa"}},
        {"loading": {"force": 1e-3 * unit * length**2}},
        {"loading": {"line_load": 1e-3 * unit * length}},
        {"loading": scene["loading"] | {"speed": length}},
        {"loading": scene["loading"] | {"duration": 1.0}},
        {"roughness": None, "form": form},
        {"roughness": None, "form": {"width": 0.3 * length, "edge_radius": length, "points": 32}},
        {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1}, "form": {"radius": 3.0 * length}},
        {"roughness": {"method": "midpoint_displacement", "hurst": 0.8, "rms_gradient": 0.1}},
        {"roughness": {"method": "psd", "hurst": 0.8, "rms_height": 0.01 * length}},
    )
    if (
        "form" in more
        and "roughness" in more
        and more["roughness"] is None
        and scene["loading"].get("reduced_pressure")
    ):
        more["loading"] = {"pressure" if has_units else "displacement": 1e-3 * unit}
    given = {key: value for key, value in (scene | more).items() if value is not None}
    path = one(
        file["path"],
        file["path"] if "loading" not in more else [],
        [],
        [{"sliding": 1e-3 * length}],
        [{"displacement": 1e-4 * length}],
    )
    numerics = one({}, {}, {"solver": one("conjugate_gradients", "verlet", "active_set_newton")}, {"threads": 2})
    return file | {"scene": given, "path": path, "numerics": numerics}


def files(count=200, first=0):
    """Random scene files: each is refused with a reason, ends with a status, or holds its conditions.

    From the 120th on every third one has something more.
    """
    rng, worst, ends, longest, started = np.random.default_rng(73), {}, Counter(), 0.0, time.process_time()
    more = np.random.default_rng(37)
    for i in range(count):
        file, begun = random_file(rng), time.process_time()
        if i >= 120 and i % 3 == 2:
            file = with_more(file, more)
        if i < first:
            continue
        try:
            problem, _ = read_contact(*load_scene(file)).reduced
            contacts = list(solve_path(problem, 0))
        except InputError as refused:
            ends["refused"] += 1
            print(f"{i}: {refused}", flush=True)
            continue
        heights, loads = contacts[0].heights[0], [each.load for each in problem.at_each_load]
        found = violations(contacts, heights, loads, problem.plasticity)
        ends[Status(int(found.pop("status"))).name] += 1
        if problem.plasticity.increments > 1:  # which begin where the last one ends, and is not kept
            del found["flow rule"]
        worst = {name: max(value, worst.get(name, 0.0)) for name, value in found.items()}
        longest = max(longest, time.process_time() - begun)
    told = "  ".join(f"{name} {value:.1e}" for name, value in worst.items())
    print(f"{count - first} files: {dict(ends)}; worst {told}; processor time {time.process_time() - started:.0f} s,")
    print(f"at most {longest:.1f} s for one")


PARTS = {
    "yield": first_yield,
    "hardness": hardness,
    "residual": residual,
    "elements": elements,
    "scenes": scenes,
    "files": files,
}

if __name__ == "__main__":
    if sys.argv[1:2] == ["tamaas"]:
        tamaas(sys.argv[2])
    elif sys.argv[2:]:
        PARTS[sys.argv[1]](*map(int, sys.argv[2:]))
    else:
        for part in sys.argv[1:] or PARTS:
            PARTS[part]()
