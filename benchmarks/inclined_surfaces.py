"""Inclined surfaces that touch without friction, beside finite elements: the tables of two-step.md."""

import warnings

import numpy as np
from finite_elements import Body, graded
from finite_elements_of_two import press_together
from scipy.interpolate import CubicSpline

import gfmd_numba
from gfmd_numba.elasticity import fields, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.roughness import self_affine, statistics

NX = 1280
X = np.arange(NX) / NX
COARSE, FINE = {"punch": 160, "pair": 80}, {"punch": 320, "pair": 160}  # columns of elements
BODY = {"youngs_modulus": 1.0, "poissons_ratio": 0.2, "aspect_ratio": 1.0}
OTHER = {"youngs_modulus": 0.5, "poissons_ratio": 0.35, "aspect_ratio": 0.5}


def waves(size):
    """A crest, and what it faces: two waves, neither in phase with it; heights `[NX]` of zero mean."""
    facing = 0.4 * np.cos(6 * np.pi * (X - 0.07)) + 0.3 * np.sin(2 * np.pi * X)
    return -size * np.cos(2 * np.pi * X), size * facing, 0.5 * size


def self_affine_pair(gradient):
    own, facing = gradient * self_affine.profiles(0.8, 2, 16, NX, 2018, range(2))
    return own - own.mean(), facing - facing.mean(), 0.1 * gradient


def scene(own, facing, displacement, kind, order):
    """Dataset of one contact of GFMD."""

    def rough(heights):
        return {"roughness": {"method": "measured", "heights": heights, "units": {"z": "L_x"}}}

    above = rough(facing) if kind == "punch" else {"counter_body": OTHER | rough(facing)}
    asked = {"body": BODY | rough(own), "interface": {"hard_wall": {}}, "loading": {"displacement": displacement}}
    found = gfmd_numba.solve({"scene": asked | above, "numerics": {"topography_order": order, "residual": 1e-10}})
    assert found["status"] == 0, (kind, order, displacement)
    return found


def mesh(heights, body, columns):
    """Elements whose nodes are moved by u'', so that their labels are those of two-step GFMD."""
    elastic = ElasticBody(body["poissons_ratio"], body["aspect_ratio"])
    up = topography.formed_surface(heights, elastic)

    def formed(x, z):
        levels, row = np.unique(np.round(z, 12), return_inverse=True)
        moved = fields.fields_inside(up, NX, np.minimum(levels, 0.0), elastic)
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
    punch = CubicSpline(np.append(X, 1.0), np.append(facing, facing[0]), bc_type="periodic")
    top, over = (own + facing).max() - displacement, NX // (2 * columns)
    touching = (own + facing)[::over] > top
    return body.along_top(body.press_inclined(lambda x: top - punch(x), lambda x: -punch(x, 1), touching))


def row(name, own, facing, displacement, kind):
    coarse, fine = (finite_elements(own, facing, displacement, kind, columns[kind]) for columns in (COARSE, FINE))
    over = NX // len(fine[0])
    of_mesh = [abs(a - b[::2]).max() for a, b in zip(coarse, fine, strict=True)]
    slopes = ", ".join(f"{statistics.rms_gradient(each):.4f}" for each in (own, facing))
    largest = " ".join(f"{abs(each).max():.1e}" for each in fine)
    print(f"\n{kind}, {name}: rms gradients {slopes}; largest {largest}; mesh {' '.join(f'{e:.1e}' for e in of_mesh)}")
    for order in (0, 1, 2, 3):
        found = scene(own, facing, displacement, kind, order)
        prefixes = ("",) if kind == "punch" else ("", "counter_body_")
        names = [f"{prefix}{way}displacement" for prefix in prefixes for way in ("tangential_", "")]
        off = [abs(found[each].values[::over] - b).max() for each, b in zip(names, fine, strict=True)]
        print(
            f"  order {order}: {' '.join(f'{each:.1e}' for each in off)}; "
            f"expected {float(found['expected_error']):.1e}; transforms {int(found['n_transforms'])}"
        )


if __name__ == "__main__":
    warnings.simplefilter("ignore", UserWarning)  # of slopes
    print("Errors of u_1 and u_3 (of both bodies) against the finer mesh, in L_x")
    for kind in ("punch", "pair"):
        for size in (0.0025, 0.005, 0.01, 0.02, 0.04):
            row(f"waves of size {size:g}", *waves(size), kind)
        for gradient in (0.01, 0.03, 0.1):
            row(f"self-affine, g = {gradient:g}", *self_affine_pair(gradient), kind)
