"""Rough elastoplastic contacts: how their area goes with load and yield stress, and Tamaas on the same grid.

python benchmarks/rough_plastic_contacts.py [SURFACES], by default 3, which takes 2 minutes of processor time
python benchmarks/rough_plastic_contacts.py tamaas PYTHON, the interpreter of an environment that has Tamaas and SciPy

It prints what there is to compare with the finite elements of Pei, Hyun, Molinari and Robbins (J. Mech. Phys. Solids
53:2385, 2005), whose numbers are not in this repository. Pressures are in g E*, lengths in L_x.
"""

import sys

import numpy as np
from plastic_flow import beside_tamaas, pressed
from scipy.optimize import curve_fit

from gfmd_numba.analysis.channels import sizes
from gfmd_numba.arrays.regions import regions
from gfmd_numba.contact import evaluation
from gfmd_numba.contact.plastic_flow import plastic_state
from gfmd_numba.elasticity.plastic_sublayers import PlasticSublayers
from gfmd_numba.fourier import grid
from gfmd_numba.kernels import Hardening

STRESSES = 0.03, 0.1, 0.3, 4.0  # the last one is never reached
AREAS = 0.02, 0.04, 0.08, 0.12
GRIDS = 48, 96  # nodes; 6 and 12 in the shortest wave
AT = 2  # of AREAS, where others are compared


def surface(seed, nodes, hurst=0.5):
    """Heights of an rms gradient of 1, self-affine from L_x / 2 to L_x / 8, the same on each grid."""
    waves = (GRIDS[0],) * 2
    q, rng = grid.magnitudes(waves), np.random.default_rng(seed)
    inside = (q > 0.0) & (q <= 16.0 * np.pi)
    spectrum = np.where(inside, np.maximum(q, 4.0 * np.pi) ** -(1.0 + hurst), 0.0)
    real = grid.signal(spectrum * np.exp(2j * np.pi * rng.random(q.shape)), *waves)
    finer = np.zeros((nodes, nodes // 2 + 1), dtype=np.complex128)
    finer[grid.wave_indices(waves)] = grid.coefficients(real, 2)
    gradient = np.sqrt((grid.signal(grid.magnitudes((nodes, nodes)) * finer, nodes, nodes) ** 2).mean())
    return grid.signal(finer, nodes, nodes) / gradient


def formula(stress, hardness, power, elastic=0.43):
    """Mean contact pressure under a yield stress: elastic if that is high, and so many times it if that is low."""
    return (elastic**-power + (hardness * stress) ** -power) ** (-1.0 / power)


def measured(heights, hardening, nu=0.3):
    """Measures `[load, measure]` under loads that lead to about the AREAS, and are then taken off.

    The mean contact pressure; the share of touching nodes that bear more than twice as much, and what 99 % of them bear
    less than; the share of the area that the cluster of a touching node has; the plastic work, and how much more it is
    once the largest load is taken off.
    """
    up = [area * formula(hardening.stress, 2.9, 1.7) for area in AREAS]
    *loaded, free = pressed(heights, [*up, 1e-3 * up[-1]], PlasticSublayers(hardening, None, 12, 1), nu)
    rows = []
    for load, found in zip(up, loaded, strict=True):
        assert found.equilibrium.status[0] == 0
        p, now = found.equilibrium.pressure[0], found.equilibrium.touching[0]
        area, nodes = float(evaluation.contact_area_fraction(found)[0]), sizes(regions(now))
        cluster, high = (nodes**2).sum() / nodes.sum() ** 2, (p[now] > 2.0 * p[now].mean()).mean()
        rows.append([load / area, high, np.quantile(p[now], 0.99), cluster, work(found, hardening)])
    return np.array([[*row, work(free, hardening) / max(row[-1], 1e-300)] for row in rows])


def work(contact, hardening):
    """Plastic work so far per nominal area, in g^2 E* L_x, with linear hardening."""
    flow = plastic_state(contact)
    density = (hardening.stress + 0.5 * hardening.slope * flow.equivalent) * flow.equivalent
    return float(flow.body.waves.thickness @ density.mean(axis=(1, 2)))


def told(values, scale=1.0):
    """Mean and standard error of the values of surfaces `[surface]`."""
    each = scale * np.asarray(values)
    return f"{each.mean():6.3f} +- {each.std(ddof=1) / np.sqrt(len(each)):5.3f}"


def pei(surfaces):
    """All of it for so many surfaces, on two grids and with their difference taken off: the area's error is linear."""
    found = np.empty((len(GRIDS), len(STRESSES), surfaces, len(AREAS), 6))
    for g, nodes in enumerate(GRIDS):
        for y, stress in enumerate(STRESSES):
            for seed in range(surfaces):
                found[g, y, seed] = measured(surface(seed, nodes), Hardening(stress))
            rows = " ".join(told(found[g, y, :, a, 0] / stress) for a in range(len(AREAS)))
            print(f"{nodes} nodes, Y = {stress:5} g E*: mean pressure over Y at about {AREAS}: {rows}", flush=True)
    pressure = 2.0 * found[1, ..., 0] - found[0, ..., 0]  # [stress, surface, area]
    print("\nWithout the error of the grid, which is linear in the distance of the nodes:")
    for y, stress in enumerate(STRESSES):
        rows = " ".join(told(pressure[y, :, a], 1.0 / stress) for a in range(len(AREAS)))
        print(f"Y = {stress:5} g E*: mean pressure over Y {rows}; A g E*/W {told(1.0 / pressure[y, :, AT])}")
        _, high, ninety_nine, cluster, plastic, _ = found[1, y, :, AT].T
        top = found[1, y, :, -1]
        print(
            f"    nodes that bear more than twice the mean {told(high)}, 99 % bear less than {told(ninety_nine)} g E*, "
            f"a node's cluster has {told(cluster)} of the area; plastic work {told(plastic, 1e4)} e-4, at the largest "
            f"load {told(top[:, 4], 1e4)} e-4, after it {top[:, 5].mean():.4f} times that"
        )
    low = range(len(STRESSES) - 1)
    lines = np.log(pressure[low, :, AT]), np.log([STRESSES[y] for y in low])
    powers = [np.polyfit(lines[1], each, 1)[0] for each in lines[0].T]
    local = np.diff(np.log(pressure[..., AT]), axis=0) / np.diff(np.log(STRESSES))[:, np.newaxis]
    print(f"A / W goes as Y to the power of minus {told(powers)} for Y = 0.03 to 0.3 g E*; between neighbours")
    print("  ".join(told(each) for each in local))
    mean = pressure[..., AT].mean(axis=1)
    best, _ = curve_fit(formula, STRESSES, mean, (2.9, 1.7, mean[-1]), sigma=mean)
    off = formula(np.array(STRESSES), *best) / mean - 1.0
    print(f"(W/A)^-n = ({best[2]:.3f} g E*)^-n + ({best[0]:.2f} Y)^-n, n = {best[1]:.2f}, off by {abs(off).max():.1%}")


def others(surfaces):
    """Mean contact pressure of other morphologies and plasticities over that of H = 0.5, nu = 0.3 without hardening."""
    cases = {"": {}, "H = 0.3": {"hurst": 0.3}, "H = 0.8": {"hurst": 0.8}, "nu = 0": {"nu": 0.0}}
    cases |= {"nu = 0.45": {"nu": 0.45}, "hardening 0.5 Y": {"slope": 0.5}}
    known = {}
    for name, case in cases.items():
        for stress in (0.1, 4.0):
            hardening = Hardening(stress, case.get("slope", 0.0) * stress)
            heights = [surface(seed, GRIDS[0], case.get("hurst", 0.5)) for seed in range(surfaces)]
            found = np.array([measured(each, hardening, case.get("nu", 0.3))[AT, 0] for each in heights])
            ratio = told(found / known.setdefault(stress, found))
            if case:
                print(f"{name}: at Y = {stress} g E* {ratio} of the mean pressure", flush=True)


def tamaas(interpreter):
    """A rough surface on one grid, in one increment, here and by Tamaas; lower yield stresses take it minutes."""
    for nodes, sublayers in ((24, 12), (48, 24)):
        for stress in (0.5, 0.3):
            load, plasticity = (
                0.08 * formula(stress, 2.9, 1.7),
                PlasticSublayers(Hardening(stress, stress), 0.1, sublayers, 1),
            )
            heights = surface(0, GRIDS[0])[:: GRIDS[0] // nodes, :: GRIDS[0] // nodes]
            print(f"Y = {stress} g E*, hardening as much:", end=" ")
            beside_tamaas(interpreter, heights, load, plasticity)


if __name__ == "__main__":
    if sys.argv[1:2] == ["tamaas"]:
        tamaas(sys.argv[2])
    else:
        count = int(sys.argv[1]) if sys.argv[1:] else 3
        pei(count)
        others(count)
