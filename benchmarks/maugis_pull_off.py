"""Pull-off of a ball under a Maugis-Dugdale law, beside Maugis's closed form (1992; Johnson and Greenwood, 1997).

The ball is drawn off in steps about where the closed form has its least force; a parabola through the least of these
forces and its neighbours is the pull-off. `python benchmarks/maugis_pull_off.py [lambda taper nodes]` prints a
line for each of Maugis's parameters lambda, tapers and grids.

`python benchmarks/maugis_pull_off.py lennard_jones [mu nodes ...]` does so for the Lennard-Jones law at Tabor's
parameters mu, beside rings of pressure on a half-space, which solve the equations of Greenwood (Proc. R. Soc. A
453:1277, 1997).
"""

import sys
import time
import warnings

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.special import ellipe, ellipk

import gfmd_numba

REACH = 0.36  # radius of the zone that attracts at pull-off, in L_x


def closed_form(contact, parameter):
    """Force over pi w R, displacement, and outer radius of a contact radius, both over (pi w R^2 / K)^(1/3)."""

    def imbalance(m):
        root, angle = np.sqrt(m * m - 1.0), np.arccos(1.0 / m)
        gap = 0.5 * parameter * contact**2 * (root + (m * m - 2.0) * angle)
        return gap + 4.0 / 3.0 * parameter**2 * contact * (root * angle - m + 1.0) - 1.0

    m = brentq(imbalance, 1.0 + 1e-12, 1e6, xtol=1e-15, rtol=1e-14)
    root = np.sqrt(m * m - 1.0)
    force = contact**3 - parameter * contact**2 * (root + m * m * np.arccos(1.0 / m))
    return force, contact**2 - 4.0 / 3.0 * parameter * contact * root, m * contact


def pull_off_of_closed_form(parameter):
    """Least force over pi w R, with the displacement and the outer radius there."""
    found = minimize_scalar(
        lambda a: closed_form(a, parameter)[0], bounds=(1e-3, 3.0), method="bounded", options={"xatol": 1e-10}
    )
    return closed_form(found.x, parameter)


def pull_off(nodes, parameter, taper, solve=gfmd_numba.solve):
    """Least force over pi w R on a grid, the resolution of the law, and transforms a step."""
    _, displacement, outer = pull_off_of_closed_form(parameter)
    unit = REACH / outer  # (pi w R^2 / K)^(1/3), with R = 1, E* = 1, K = 4/3
    work = 4.0 * unit**3 / (3.0 * np.pi)
    length = 2.0 * work / parameter * (9.0 / (16.0 * np.pi * work)) ** (1.0 / 3.0)  # lambda = 2 s0 (R / (pi w K^2))^1/3
    law = {"maugis_dugdale": {"work_of_adhesion": work, "range": length, "taper": taper}}
    return drawn_off(nodes, law, work, displacement * unit**2, 0.02 * max(unit**2, length), 0.01 * unit**2, solve)


def drawn_off(nodes, law, work, least, step, begun, solve=gfmd_numba.solve):
    """Least force over pi w R in steps about a displacement, and what `pull_off` returns besides."""
    steps = [*([0.0] if begun > 0.0 else []), *(least + step * k for k in range(4, -5, -1))]
    found = solve(
        {
            "scene": {
                "dimension": 2,
                "periodic": False,
                "body": {"poissons_ratio": 0.3},
                "form": {"radius": 1.0, "points": nodes},
                "interface": {"hard_wall": {}} | law,
                "loading": {"displacement": begun},
            },
            "path": [{"displacement": each} for each in steps if each > -0.4],
            "numerics": {"residual": 1e-6},
        }
    )
    assert (found["status"] == 0).all()
    forces = found["mean_pressure"].values[len(steps) - 8 :] / (np.pi * work)
    i = int(np.argmin(forces))
    assert i > 0, "the least force is before the steps"
    i = min(i, forces.size - 2)  # the next step has jumped off
    below, here, above = forces[i - 1 : i + 2]
    curved = below - 2.0 * here + above
    refined = here - (above - below) ** 2 / (8.0 * curved) if curved > 0.0 else forces.min()
    return refined, float(found["relative_softening"].max()), int(found["n_transforms"].sum())


def rings_under_lennard_jones(mu, length, rings):
    """Force over pi w R and displacement (R) at pull-off, R = 1: the gap in the middle is prescribed, ever larger."""
    work, outer = (mu * length) ** 1.5, 9.0 * np.sqrt(length)
    edges = outer * (np.arange(1, rings + 1) / rings)
    r = 0.5 * (edges + np.concatenate(([0.0], edges[:-1])))
    apart = r[:, np.newaxis] / edges
    m = np.minimum(1.0 / apart, 1.0) ** 2
    beyond = 4.0 * r[:, np.newaxis] / np.pi * (ellipe(m) - (1.0 - m) * ellipk(np.where(m < 1.0, m, 0.0)))
    discs = np.where(apart < 1.0, 4.0 * edges / np.pi * ellipe(np.minimum(apart, 1.0) ** 2), beyond)
    influence, areas = np.diff(discs, axis=1, prepend=0.0), np.pi * np.diff(edges**2, prepend=0.0)
    gap, forces = 0.5 * r**2 + 2.0 * length, []
    for middle in length * np.append(np.linspace(2.0, 1.1, 91), np.linspace(1.1, 0.9, 401)[1:]):
        for _ in range(100):
            pulls = 8.0 * work / (3.0 * length) * ((length / gap) ** 3 - (length / gap) ** 9)
            slopes = 8.0 * work / (3.0 * length) * (9.0 * (length / gap) ** 9 - 3.0 * (length / gap) ** 3) / gap
            off = gap - 0.5 * r**2 + influence @ pulls  # the same for all rings: the height of the punch
            matrix = np.eye(rings) + influence * slopes
            matrix -= matrix[0]
            matrix[0] = 0.0
            matrix[0, 0] = 1.0
            wrong = off - off[0]
            wrong[0] = gap[0] - middle
            change = np.linalg.solve(matrix, -wrong)
            gap = np.maximum(gap + change, 0.7 * gap)
            if abs(change).max() < 1e-11 * length:
                break
        else:
            break  # the rings are too wide for a law so short
        forces.append((-float(areas @ pulls) / (np.pi * work), -float(off[0])))
    assert forces.index(min(forces)) < len(forces) - 1
    return min(forces)


def under_lennard_jones(mu, nodes, length=0.003):
    """Print the pull-off on a grid beside that of rings, which is extrapolated from two numbers of them."""
    begun, work = time.perf_counter(), (mu * length) ** 1.5
    (coarse, _), (fine, displacement) = (rings_under_lennard_jones(mu, length, n) for n in (150, 300))
    law = {"lennard_jones": {"work_of_adhesion": work, "range": length}}
    force, x, transforms = drawn_off(nodes, law, work, displacement, 0.05 * length, displacement + length)
    print(
        f"{mu:6} {nodes:12} {x:6.3f} {-fine - (fine - coarse) / 3.0:8.4f} {-force:8.4f} "
        f"{transforms:20} {time.perf_counter() - begun:6.1f}",
        flush=True,
    )


ROWS = (  # lambda, taper, nodes
    *((parameter, taper, 64) for parameter in (0.05, 0.1, 0.2, 0.5, 1.0) for taper in (0.5, 0.2, 0.1)),
    (1.0, 0.2, 128),
    (2.0, 0.5, 96),
    (2.0, 0.2, 224),
    (3.0, 0.5, 200),
)
if __name__ == "__main__":
    warnings.filterwarnings("ignore", ".*of the energy that the path seems to lose")
    if sys.argv[1:2] == ["lennard_jones"]:
        print("    mu        nodes      x    rings    found           transforms      s")
        given = [(float(mu), int(nodes)) for mu, nodes in zip(sys.argv[2::2], sys.argv[3::2], strict=True)]
        for mu, nodes in given or ((0.1, 64), (0.3, 64), (1.0, 128), (2.0, 224)):
            under_lennard_jones(mu, nodes)
        sys.exit()
    given = [float(each) for each in sys.argv[1:]]
    print("lambda taper  nodes      x   closed    found  error %  transforms      s")
    for parameter, taper, nodes in (given,) if given else ROWS:
        begun = time.perf_counter()
        force, x, transforms = pull_off(int(nodes), parameter, taper)
        expected = -pull_off_of_closed_form(parameter)[0]
        print(
            f"{parameter:6} {taper:5} {int(nodes):6} {x:6.3f} {expected:8.4f} {-force:8.4f} "
            f"{100.0 * (-force / expected - 1.0):8.2f} {transforms:11} {time.perf_counter() - begun:6.1f}",
            flush=True,
        )
