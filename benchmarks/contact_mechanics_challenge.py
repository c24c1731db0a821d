"""The Contact-Mechanics Challenge with its adhesion: contact area at 250 kPa over the grid, the range and the cut-off.

Mueser et al., Tribol. Lett. 65:118 (2017): L_x = 100 um, roll-off 20 um, cut-off 0.1 um, H = 0.8, rms gradient 1,
E* = 25 MPa, w = 50 mJ/m^2, range 2.071 nm. No grid below 29700^2 nodes resolves that range (x < 1), so longer ranges
are solved on grids that resolve them. The default takes grids up to 2048^2; `--quick` stops at 1024^2, `--whole` adds
all waves on 4096^2. `--wall` solves all waves without adhesion on three grids up to 8192^2 and nothing else (6 GB).
`--pieces` solves the Challenge's own range on periods of 5 um (three grids), 10 um and 20 um (8192^2 nodes, 14 GB, over
an hour), and the long range on many surfaces of these periods, which tells what the small period changes.
`--surface N` takes another surface.
"""

import argparse
import time
from math import log2

import numpy as np

from gfmd_numba.contact import solution
from gfmd_numba.contact.evaluation import measure
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.relative_softening import softening
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options

PERIOD, MODULUS, WORK, PRESSURE = 100e-6, 25e6, 50e-3, 250e3  # m, Pa, J/m^2, Pa
ROLL_OFF, CUT_OFF, RANGE = 5, 1000, 2.071e-9  # wave indices; m
LONG = 16.62e-9  # range that 512^2 nodes resolve to x = 0.9


def gradient(period):
    """Rms gradient of the waves of the Challenge that a period holds, over that of all waves."""

    def mean_square(of):
        most = round(CUT_OFF * of / PERIOD)
        each = np.arange(-most, most + 1) / of
        wave = np.hypot(each, each[:, np.newaxis]) * PERIOD
        kept = (wave > 0.0) & (wave < CUT_OFF * (1.0 + 1e-12))
        return (np.maximum(wave, ROLL_OFF) ** -3.6 * wave**2)[kept].sum() / of**2

    return np.sqrt(mean_square(period) / mean_square(PERIOD))


def solve(cut_off, nodes, length, surface, pressure=PRESSURE, period=PERIOD):
    """Corrected contact area under a pressure with a range of adhesion in m, None without; prints a line.

    `cut_off` counts the shortest waves in 100 um. A `period` below 20 um has no waves of the roll-off.
    """
    steep, scale = (1.0, 1.0) if period == PERIOD else (gradient(period), period / PERIOD)
    law = None if length is None else ExponentialLaw(WORK / (MODULUS * steep**2 * period), length / (steep * period))
    problem = Problem(
        RandomSurface(SelfAffineWaves(0.8, max(ROLL_OFF * scale, 1), round(cut_off * scale)), nodes, 2024, dimension=2),
        ElasticBody(None, None),
        Interactions(True, law),
        pressure / (MODULUS * steep),
        None,
        Options("active_set_newton" if law is None else "truncated_newton", residual=1e-6),
    )
    begun = time.perf_counter()
    contact = solution.solve(problem, range(surface, surface + 1))
    seconds, found = time.perf_counter() - begun, measure(contact)
    assert found["status"][0] == Status.ok
    shown = "      -      -" if law is None else f"{length * 1e9:7.2f} {softening(problem):6.2f}"
    print(
        f"{nodes:5}^2 {PERIOD / cut_off * 1e6:9.2f} {shown} {pressure / 1e3:9.1f}"
        f"{found['contact_area_fraction_counted'][0]:10.5f} {found['contact_area_fraction'][0]:10.5f}"
        f"{found['mean_gap'][0] * steep * period * 1e9:9.1f} {found['n_transforms'][0]:8} {seconds:8.1f}",
        flush=True,
    )
    return float(found["contact_area_fraction"][0])


def limit(areas):
    """Limit of areas on grids that double, by the ratio of the last two differences."""
    first, second = np.diff(areas[-3:])
    ratio = max(first / second, 1.5) if first * second > 0.0 else 2.0
    return areas[-1] + second / (ratio - 1.0), log2(ratio)


def told(areas):
    """Print the limit of areas on grids that double."""
    dense, order = limit(areas)
    print(f"limit {dense:.5f}, order {order:.1f}; the finest grid is {areas[-1] / dense - 1:+.2%} off")


def header(text):
    print(f"\n{text}")
    print(" grid  cut-off/um  range/nm   x     p/kPa   counted  corrected   gap/nm  transforms   s")


def pieces(one):
    """The Challenge's range on small periods, and what such a period changes at the long range."""
    for period, surfaces, nodes in ((5e-6, 40, 256), (10e-6, 20, 512), (20e-6, 10, 1024)):
        header(f"Period {period * 1e6:g} um, all its waves, without adhesion and with the long range")
        found = np.array(
            [[solve(CUT_OFF, nodes, length, i, period=period) for length in (None, LONG)] for i in range(surfaces)]
        )
        wall, adhesive = found.mean(axis=0)
        error = np.std(found[:, 1] / adhesive - found[:, 0] / wall, ddof=1) / np.sqrt(surfaces)
        print(f"means {wall:.5f} and {adhesive:.5f}: adhesion adds {adhesive / wall - 1:.1%} +- {error:.1%}")
    for period, grids in ((5e-6, (1024, 2048, 4096)), (10e-6, (4096,)), (20e-6, (8192,))):
        header(f"Period {period * 1e6:g} um, all its waves, with the Challenge's range")
        solve(CUT_OFF, grids[-1], None, one, period=period)
        areas = [solve(CUT_OFF, n, RANGE, one, period=period) for n in grids]
        if len(areas) > 2:
            told(areas)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--surface", type=int, default=0)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--wall", action="store_true")
    parser.add_argument("--pieces", action="store_true")
    asked = parser.parse_args()
    if asked.wall:
        header("All waves without adhesion")
        told([solve(CUT_OFF, n, None, asked.surface) for n in (2048, 4096, 8192)])
        return
    if asked.pieces:
        pieces(asked.surface)
        return
    finest, one = 1024 if asked.quick else 2048, asked.surface
    grids = [n for n in (512, 1024, 2048, 4096) if n <= finest or asked.whole]

    header("The same waves on all grids that resolve a range (x < 1)")
    for halvings, coarsest in ((0.0, 512), (0.5, 1024), (1.0, 2048)):
        length = LONG * 2.0**-halvings
        areas = [solve(64, n, length, one) for n in grids if n >= coarsest]
        if len(areas) > 2:
            told(areas)

    header("More waves, without adhesion and with the long range, on the finest grid")
    for cut_off in (64, 128, 256, 512, *([CUT_OFF] if finest == 2048 else [])):
        if 2 * cut_off < finest:
            without, adhesive = (solve(cut_off, finest, length, one) for length in (None, LONG))
            print(f"{'':50} adhesion adds {adhesive / without - 1:.1%}")

    solve(256, finest, LONG / 2.0, one)

    header("Loads without adhesion and with the long range, 0.39 um")
    for pressure in (12.5e3, 50e3, 125e3, 250e3, 500e3, 1e6, 2e6):
        for length in (None, LONG):
            solve(256, 1024, length, one, pressure)

    if asked.whole:
        header("All waves, four nodes for the shortest")
        for length in (None, LONG):
            solve(CUT_OFF, 4096, length, one)


if __name__ == "__main__":
    main()
