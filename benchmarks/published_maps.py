"""Contact areas of maps against published ones, and the Contact-Mechanics Challenge without adhesion.

`python benchmarks/published_maps.py` takes grids of 400^2 to 1024^2; `--larger` adds 1600^2 and 2048^2, `--challenge`
solves the Challenge's surface with all its waves, which needs 4096^2. `--surfaces N` averages over N surfaces.
"""

import argparse
import time

import numpy as np

from gfmd_numba.contact import solution
from gfmd_numba.contact.evaluation import measure
from gfmd_numba.contact.problem import Problem
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from gfmd_numba.theory import persson

# GFMD of Zhou and Mueser as published with Xu et al. (2024): p/E*, contact area and its scatter.
# H = 0.8, lambda_l/lambda_s = 100, no roll-off, rms gradient 0.2766
GRADIENT = 0.2766
PUBLISHED = (
    (0.001, 0.00827, 0.00010),
    (0.005, 0.03993, 0.00029),
    (0.01, 0.07793, 0.00047),
    (0.025, 0.18524, 0.00074),
    (0.065, 0.43259, 0.00060),
    (0.113, 0.65714, 0.00048),
    (0.24, 0.94058, 0.00026),
)
# Mueser et al., Tribol. Lett. 65:118 (2017): rms gradient 1, E* = 25 MPa, p = 250 kPa, periods in um
CHALLENGE = {"period": 100.0, "roll_off": 20.0, "cut_off": 0.1, "hurst": 0.8, "reduced_pressure": 0.01}
LOADS = (0.0005, 0.002, 0.005, 0.01, 0.02, 0.04, 0.08)


def areas(waves, nx, load, surfaces):
    """Counted and corrected areas, and kappa, `[surface]`."""
    problem = Problem(
        RandomSurface(waves, nx, 2024, dimension=2),
        ElasticBody(None, None),
        Interactions(hard_wall=True),
        load,
        None,
        Options("active_set_newton", residual=1e-8),
    )
    found = [measure(solution.solve(problem, range(i, i + 1))) for i in range(surfaces)]
    assert all(each["status"][0] == Status.ok for each in found)
    names = ("contact_area_fraction_counted", "contact_area_fraction", "kappa")
    return [np.array([each[name][0] for each in found]) for name in names]


def mean_and_error(values):
    return values.mean(), values.std(ddof=1) / np.sqrt(len(values))


def against_published_areas(surfaces, larger):
    print("Contact areas of maps, H = 0.8, lambda_l/lambda_s = 100, no wave beyond lambda_l; scatter of surfaces in ()")
    print(
        "p/E*      L_x/lambda_l  nodes a wave  counted            corrected          published          off   Persson"
    )
    grids = [(1, 400), (2, 800), (1, 800), *([(2, 1600), (1, 1600)] if larger else [])]
    for cut_on, nx in grids:
        waves = SelfAffineWaves(0.8, cut_on, 100 * cut_on, plateau=False)
        for pressure, published, scatter in PUBLISHED:
            counted, corrected, _ = areas(waves, nx, pressure / GRADIENT, surfaces)
            mean, error = mean_and_error(counted)
            off = (mean - published) / np.hypot(error, scatter)  # in joint errors
            theory = float(persson.contact_area_fraction(pressure / GRADIENT, 0.5))
            shown = (f"{each.mean():.5f} ({each.std(ddof=1):.5f})" for each in (counted, corrected))
            print(
                f"{pressure:<9} {cut_on:12} {nx / (100 * cut_on):13.1f}  {'  '.join(shown)}  "
                f"{published:.5f} ({scatter:.5f})  {off:+5.1f}  {theory:.5f}",
                flush=True,
            )


def challenge_without_adhesion(surfaces, larger):
    print("\nThe Contact-Mechanics Challenge's parameters without adhesion: area of one hard wall, four nodes a wave")
    print("grid      cut-off (um)      p*    counted (error)      corrected (error)    kappa (error)     s a surface")
    longest = CHALLENGE["period"] / CHALLENGE["roll_off"]
    for nx in (512, 1024, *([2048] if larger else [])):
        show_challenge(SelfAffineWaves(CHALLENGE["hurst"], longest, nx // 4), nx, surfaces)


def whole_challenge(surfaces):
    longest = CHALLENGE["period"] / CHALLENGE["roll_off"]
    waves = SelfAffineWaves(CHALLENGE["hurst"], longest, round(CHALLENGE["period"] / CHALLENGE["cut_off"]))
    show_challenge(waves, 4096, surfaces)


def show_challenge(waves, nx, surfaces):
    for load in LOADS:
        begun = time.perf_counter()
        values = [mean_and_error(each) for each in areas(waves, nx, load, surfaces)]
        seconds = (time.perf_counter() - begun) / surfaces
        shown = "  ".join(f"{mean:.5f} ({error:.5f})" for mean, error in values)
        marked = " <- 250 kPa" if load == CHALLENGE["reduced_pressure"] else ""
        cut_off = CHALLENGE["period"] / waves.shortest_wave_index
        print(f"{nx:4}^2 {cut_off:12.3f} {load:10}    {shown}  {seconds:8.1f}{marked}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--surfaces", type=int, default=4)
    parser.add_argument("--larger", action="store_true")
    parser.add_argument("--challenge", action="store_true")
    asked = parser.parse_args()
    if asked.challenge:
        return whole_challenge(asked.surfaces)
    against_published_areas(asked.surfaces, asked.larger)
    challenge_without_adhesion(asked.surfaces, asked.larger)


if __name__ == "__main__":
    main()
