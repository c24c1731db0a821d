"""Random scenes with a law of the gap: each is solved, and what is called ok passes a check of its own."""

import warnings
from functools import partial

import numpy as np
import pytest

from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.contact.solution import condensed_stiffness
from gfmd_numba.fourier import grid
from gfmd_numba.scene import load_scene
from gfmd_numba.solvers.status import Status
from support.cases import some_of


def power(work, length, gap):
    """Traction of a power law with the exponent 2, in a line at overlaps of more than 9/10 of its range."""
    near = np.maximum(1.0 + gap / length, 0.1)
    return 2.0 * work / length * (near**-3 - 3.0 * near**-4 * (1.0 + gap / length - near))


def lennard_jones(work, length, gap):
    """Traction of a Lennard-Jones law, in a line below half its range."""
    near = np.maximum(gap, 0.5 * length)
    pull = 8.0 * work / (3.0 * length) * ((length / near) ** 3 - (length / near) ** 9)
    return pull + 8.0 * work / (3.0 * length**2) * (9.0 * 2.0**10 - 3.0 * 2.0**4) * (gap - near)


PULLS = {  # written down a second time
    "exponential": lambda w, length, gap: w / length * np.exp(-gap / length),
    "squared_exponential": lambda w, length, gap: w * gap / length**2 * np.exp(-0.5 * (gap / length) ** 2),
    "maugis_dugdale": lambda w, length, gap: w / length * np.interp(gap, [0.9 * length, 1.1 * length], [1.0, 0.0]),
    "lennard_jones": lennard_jones,
    "power_law": power,
}
SOFTENING = {"maugis_dugdale": 5.0, "lennard_jones": 1.26, "power_law": 6.0}  # times work / range^2


def random_scene(number, name="exponential"):
    """A path of loads or displacements over half-spaces and slabs; x from 1e-3 to 1, ranges from 3e-4 to 3 g L_x."""
    rng = np.random.default_rng(number)
    g, hurst = 10 ** rng.uniform(-3, -0.5), rng.uniform(0.1, 1)
    aspect_ratio, nu = rng.choice([None, 1.0, 0.3, 0.1, 0.03, 1.0]), rng.choice([0.0, 0.3, 0.45, 0.49, 0.3])
    inverse = [int(rng.choice(each)) for each in ([1, 2, 4, 8], [8, 32, 64, 128], [1, 2, 4])]
    wall = rng.random() < 0.75
    attracts = wall and rng.random() < 0.7
    if name == "lennard_jones":
        wall, attracts = False, True
    elif name not in ("exponential", "power_law"):
        wall = attracts = True
    length = 10 ** rng.uniform(-3.5, 0.5)
    work = 10 ** rng.uniform(-3, 0) * np.pi * np.prod(inverse) * length**2 / SOFTENING.get(name, 1.0)
    if not attracts:
        work = -(10 ** rng.uniform(-5, 1)) * max(length, 1e-3)
    if rng.random() < 0.5 or aspect_ratio is None:
        path = [{"reduced_pressure": float(each)} for each in np.exp(rng.uniform(np.log(1e-3), 0, 3))]
    else:
        path = [{"displacement": float(each)} for each in rng.uniform(-0.1, 0.2, 4) * g]
    body = {"poissons_ratio": float(nu)} | ({} if aspect_ratio is None else {"aspect_ratio": float(aspect_ratio)})
    law = {"work_of_adhesion": float(work * g * g), "range": float(length * g)}
    return {
        "scene": {
            "body": body,
            "roughness": {"method": "psd", "hurst": float(hurst), "rms_gradient": float(g)},
            "interface": ({"hard_wall": {}} if wall else {}) | {name: law},
            "loading": path[0],
        },
        "path": path[1:],
        "discretisation": {name: 1 / each for name, each in zip(("eps_c", "eps_f", "eps_t"), inverse, strict=True)},
        "seed": int(rng.integers(1000)),
        "numerics": {"max_iterations": 2000},
    }


def violation(problem, contact, pull_of):
    """Largest violated condition over the largest traction, and what rounding of the displacement leaves open."""
    u, punch = contact.equilibrium.displacement[0], contact.punch[0]
    stiffness = condensed_stiffness(problem, grid.wavenumbers(len(u)))
    if problem.mean_pressure is not None:
        stiffness[0] = 0.0
    wall, pull = problem.interface.hard_wall, pull_of(punch - u)
    bears = (problem.mean_pressure or 0.0) - np.fft.irfft(stiffness * np.fft.rfft(u), len(u)) + pull
    touching = (u >= punch) & wall
    assert not (wall and (u > punch).any())
    if problem.mean_pressure is None and not (touching.any() or (np.abs(pull) > 1e-130).any()):  # they are apart
        assert np.abs(u).max() < 1e-12
        return 0.0, 0.0
    worst = np.where(touching, np.maximum(-bears, 0.0), np.abs(bears)).max()
    largest = max(bears.max(), np.abs(pull).max())
    pressure = np.where(touching, bears, 0.0) - pull
    np.testing.assert_allclose(contact.equilibrium.pressure[0], pressure, rtol=0, atol=1e-7 * largest)
    return worst / largest, stiffness.max() * np.spacing(np.abs(u).max()) / largest


def hunt(numbers, name="exponential"):
    """Scenes that end in another status, after what is ok has been checked."""
    failed = []
    for number in numbers:
        given = read_contact(*load_scene(random_scene(number, name)))
        (whole, _), g = given.reduced, given.surfaces.rms_gradient
        asked = given.file.scene.interface.law_of_the_gap
        length = whole.interface.normal_law.length  # has 12 digits, which count where tractions nearly vanish
        assert length == pytest.approx(asked.range / g, rel=1e-11)
        pull_of = partial(PULLS[name], asked.work_of_adhesion / g**2, length)
        with warnings.catch_warnings(action="ignore"):
            for problem, contact in zip(whole.at_each_load, solve_path(whole, 0), strict=True):
                if contact.equilibrium.status[0] != Status.ok:
                    failed.append((number, int(contact.equilibrium.status[0])))
                    break
                worst, rounding = violation(problem, contact, pull_of)
                assert worst <= 1.01e-8 + 2.0 * rounding, number
    return failed


def test_random_scenes_are_solved():
    assert hunt(range(3)) == []


@pytest.mark.parametrize("name", some_of(["squared_exponential", "maugis_dugdale", "lennard_jones", "power_law"], 3))
def test_random_scenes_of_other_laws_are_solved(name):
    assert hunt(range(1), name) == []


@pytest.mark.long
@pytest.mark.parametrize("name", ["squared_exponential", "maugis_dugdale", "lennard_jones", "power_law"])
def test_more_random_scenes_of_other_laws_are_solved(name):
    assert hunt(range(1, 4), name) == []


@pytest.mark.long
def test_more_random_scenes_are_solved():
    assert hunt(range(3, 11)) == []
