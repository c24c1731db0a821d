"""Random maps under a law of gap and slip, as in the benchmark: each path is solved, and checked by NumPy alone."""

import runpy
from pathlib import Path

import pytest

from gfmd_numba.solvers.status import Status

HUNT = runpy.run_path(str(Path(__file__).parents[2] / "benchmarks" / "map_cohesion_hunt.py"))


def hunt(kind, seeds):
    """Paths that were not solved, and those with a step that is called ok and fails the check."""
    ended = {seed: found for seed in seeds if (found := HUNT["follow"](kind, seed)) is not None}
    unsolved = [seed for seed, (status, _, _) in ended.items() if status != Status.ok]
    return unsolved, [seed for seed, (_, worst, _) in ended.items() if not worst <= 1.0]


@pytest.mark.parametrize("kind", [pytest.param("cohesive", marks=pytest.mark.long), "rigid"])
def test_random_maps_are_solved(kind):
    assert hunt(kind, range(20, 21)) == ([], [])


@pytest.mark.long
def test_a_map_is_solved_that_slips_so_far_that_the_energy_vanishes_there():
    lengths = {"normal_length": 5.8607660583227756e-05, "tangential_length": 3.245465033758722e-05}
    scene = {
        "dimension": 2,
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1.0},
        "roughness": {"method": "psd", "hurst": 0.7016828171155957, "rms_gradient": 0.09005742313263146},
        "interface": {"hard_wall": {}, "cohesive": {"work_of_adhesion": 1.0914900153697186e-09} | lengths},
        "loading": {"reduced_pressure": 0.003497322223787429},
    }
    path = [
        {"reduced_pressure": 0.0366511799, "sliding": 5.18263122e-05, "sliding_y": 2.21875203e-05},
        {"reduced_pressure": 0.0012220472, "sliding": 2.86086146e-05, "sliding_y": 4.12407438e-05},
        {"reduced_pressure": 0.2660870750, "sliding": 2.25806208e-05, "sliding_y": -5.35498008e-06},
    ]
    eps, numerics = {"eps_c": 1.0, "eps_f": 0.25, "eps_t": 0.5}, {"max_iterations": 2000}
    file = {"scene": scene, "path": path, "discretisation": eps, "seed": 756, "numerics": numerics}
    status, worst, spent = HUNT["follow_scene"](file)
    assert (status, len(spent)) == (Status.ok, 4)
    assert worst <= 1.0


@pytest.mark.long
@pytest.mark.parametrize("kind", ["cohesive", "rigid"])
def test_more_random_maps_are_solved(kind):
    assert hunt(kind, range(100, 101)) == ([], [])


def test_the_check_sees_a_wrong_displacement_along_y():
    problem, _ = HUNT["read_contact"](*HUNT["load_scene"](HUNT["random_scene"]("cohesive", 0))).reduced
    contact = next(HUNT["solve_path"](problem, 0))
    assert HUNT["violation"](problem, contact, (0.0, 0.0))[0] <= 1.1e-8
    sideways = contact.equilibrium.tangential.displacement
    sideways[0, 1, 3, 3] += 1e-6 * abs(contact.equilibrium.displacement).max()
    assert HUNT["violation"](problem, contact, (0.0, 0.0))[0] > 1e-6
