"""Inclined surfaces that touch, slide, or hold each other by a law, against finite elements: tables of two-step.md."""

import warnings

import numpy as np
from finite_elements import Body, graded
from finite_elements_of_two import press_together
from inner_fields import inside
from scipy.interpolate import CubicSpline

import gfmd_numba
from gfmd_numba.elasticity import topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.roughness import self_affine, statistics

NX = 1280
X = np.arange(NX) / NX
COARSE, FINE = {"punch": 160, "pair": 80}, {"punch": 320, "pair": 160}  # columns of elements
OF_A_LAW = 80, 160
FRICTION, SLIDING = 0.3, 0.6  # sliding over the size of the waves
BODY = {"youngs_modulus": 1.0, "poissons_ratio": 0.2, "aspect_ratio": 1.0}
MODULUS = 1.0 / (1.0 - 0.2**2)
OTHER = {"youngs_modulus": 0.5, "poissons_ratio": 0.35, "aspect_ratio": 0.5}


def waves(size):
    """A crest, and what it faces: two waves, neither in phase with it; heights `[NX]` of zero mean."""
    facing = 0.4 * np.cos(6 * np.pi * (X - 0.07)) + 0.3 * np.sin(2 * np.pi * X)
    return -size * np.cos(2 * np.pi * X), size * facing, 0.5 * size


def self_affine_pair(gradient):
    own, facing = gradient * self_affine.SelfAffineWaves(0.8, 2, 16).heights((NX,), 2018, range(2))
    return own - own.mean(), facing - facing.mean(), 0.1 * gradient


def scene(own, facing, displacement, kind, order, interface=None, sliding=0.0, residual=1e-10):
    """Dataset of one contact of GFMD, the last of a path if it slides."""

    def rough(heights):
        return {"roughness": {"method": "measured", "heights": heights, "units": {"z": "L_x"}}}

    above = rough(facing) if kind == "punch" else {"counter_body": OTHER | rough(facing)}
    asked = {"body": BODY | rough(own), "interface": interface or {"hard_wall": {}}} | above
    file = {"scene": asked | {"loading": {"displacement": displacement}}, "path": [{"sliding": sliding}]}
    found = gfmd_numba.solve(file | {"numerics": {"topography_order": order, "residual": residual}}).isel(step=-1)
    assert found["status"] == 0, (kind, order, displacement)
    return found


def mesh(heights, body, columns):
    """Elements whose nodes are moved by u'', so that their labels are those of two-step GFMD."""
    elastic = ElasticBody(body["poissons_ratio"], body["aspect_ratio"])
    up = topography.formed_surface(heights, elastic)

    def formed(x, z):
        levels, row = np.unique(np.round(z, 12), return_inverse=True)
        moved = inside(up, np.minimum(levels, 0.0), elastic)
        column = np.rint(x * NX).astype(int) % NX
        return moved.u1[row, column], moved.u3[row, column]

    return Body(columns, graded(body["aspect_ratio"], 40, 0.5 / columns), body["poissons_ratio"], formed)


def finite_elements(own, facing, displacement, kind, columns):
    """Displacements of the surfaces, along x and out of each body, on the top nodes."""
    body = mesh(own, BODY, columns)
    if kind == "pair":
        compliances = [(1.0 - each["poissons_ratio"] ** 2) / each["youngs_modulus"] for each in (BODY, OTHER)]
        shares = np.array(compliances) / sum(compliances)
        lower, upper, _ = press_together(body, mesh(facing, OTHER, columns), shares, displacement)
        return [*lower, *upper]
    punch, slope, touching = rigid(own, facing, displacement, columns)
    return body.along_top(body.press_inclined(punch, slope, touching))


def rigid(own, facing, displacement, columns):
    """Height and slope of a punch at places x, and a guess of the top nodes that touch it."""
    spline = CubicSpline(np.append(X, 1.0), np.append(facing, facing[0]), bc_type="periodic")
    top, over = (own + facing).max() - displacement, NX // (2 * columns)
    return lambda x: top - spline(x), lambda x: -spline(x, 1), (own + facing)[::over] > top


def row(name, own, facing, displacement, kind):
    meshes = [finite_elements(own, facing, displacement, kind, columns[kind]) for columns in (COARSE, FINE)]
    compared(name, own, facing, kind, meshes, lambda order: scene(own, facing, displacement, kind, order))


def sliding_row(size):
    """A punch that drags all nodes along."""
    own, facing, displacement = waves(size)
    sliding, interface = SLIDING * size, {"hard_wall": {}, "friction": {"coefficient": FRICTION}}

    def by_elements(columns):
        body, (punch, slope, touching) = mesh(own, BODY, columns), rigid(own, facing, displacement, columns)
        return body.along_top(body.press_inclined(punch, slope, touching, sliding, FRICTION))

    def by_gfmd(order):
        return scene(own, facing, displacement, "punch", order, interface, sliding, 1e-9)

    meshes = [by_elements(columns["punch"]) for columns in (COARSE, FINE)]
    compared(f"waves of size {size:g}, sliding", own, facing, "punch", meshes, by_gfmd)


def law_row(size):
    """A cohesive law that a punch stretches along x; stresses of a body with E* = 1."""
    own, facing, _ = waves(size)
    displacement, sliding, reach = 0.3 * size, 0.1 * size, 0.2 * size
    law = {"work_of_adhesion": 2e-3 * size * MODULUS, "normal_length": reach, "tangential_length": 1.5 * reach}

    def by_gfmd(order):
        return scene(own, facing, displacement, "punch", order, {"cohesive": law}, sliding, 1e-9)

    guess = by_gfmd(2)

    def by_elements(columns):
        punch, slope, _ = rigid(own, facing, displacement, columns)
        start = [guess[name].values[:: NX // (2 * columns)] for name in ("tangential_displacement", "displacement")]
        in_modulus = XuNeedlemanLaw(law["work_of_adhesion"] / MODULUS, *list(law.values())[1:])
        return mesh(own, BODY, columns).under_inclined_law(punch, slope, sliding, in_modulus, start)

    meshes = [by_elements(columns) for columns in OF_A_LAW]
    compared(f"waves of size {size:g}, cohesive law", own, facing, "punch", meshes, by_gfmd)


def compared(name, own, facing, kind, meshes, by_gfmd):
    coarse, fine = meshes
    over = NX // len(fine[0])
    of_mesh = [abs(a - b[::2]).max() for a, b in zip(coarse, fine, strict=True)]
    slopes = ", ".join(f"{statistics.rms_gradient(each):.4f}" for each in (own, facing))
    largest = " ".join(f"{abs(each).max():.1e}" for each in fine)
    print(f"\n{kind}, {name}: rms gradients {slopes}; largest {largest}; mesh {' '.join(f'{e:.1e}' for e in of_mesh)}")
    for order in (0, 1, 2, 3):
        found = by_gfmd(order)
        prefixes = ("",) if kind == "punch" else ("", "counter_body_")
        names = [f"{prefix}{way}displacement" for prefix in prefixes for way in ("tangential_", "")]
        off = [abs(found[each].values[::over] - b).max() for each, b in zip(names, fine, strict=True)]
        print(
            f"  order {order}: {' '.join(f'{each:.1e}' for each in off)}; "
            f"expected {float(found['next_order']):.1e}; transforms {int(found['n_transforms'])}"
        )


if __name__ == "__main__":
    warnings.simplefilter("ignore", UserWarning)  # of slopes
    print("Errors of u_1 and u_3 (of both bodies) against the finer mesh, in L_x")
    for size in (0.005, 0.01, 0.02, 0.04):
        sliding_row(size)
        law_row(size)
    for kind in ("punch", "pair"):
        for size in (0.0025, 0.005, 0.01, 0.02, 0.04):
            row(f"waves of size {size:g}", *waves(size), kind)
        for gradient in (0.01, 0.03, 0.1):
            row(f"self-affine, g = {gradient:g}", *self_affine_pair(gradient), kind)
