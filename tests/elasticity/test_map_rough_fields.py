"""Fields inside bodies whose surface is a rough map: against profiles, and the field of the true surface's loads."""

import numpy as np
import pytest
from inner_fields import inside

from gfmd_numba.elasticity import fields, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.fields import DISPLACEMENTS, STRAINS, STRESSES
from gfmd_numba.fourier import grid
from support.cases import some_of

NX, NY = 32, 20
NAMES = DISPLACEMENTS + STRAINS + STRESSES
# fields of a profile by the names that they have below a ridge over x, and below one over y
OVER_X = {name: name for name in ("u1", "u3", "strain1", "strain3", "strain5", *STRESSES[:3], "stress5")}
OVER_Y = dict(
    zip(("u2", "u3", "strain2", "strain3", "strain4", "stress2", "stress1", "stress3", "stress4"), OVER_X, strict=True)
)
BODIES = [ElasticBody(0.3, None), ElasticBody(0.3, 0.4), ElasticBody(0.5, 0.4)]
Z = np.array([0.0, -0.02, -0.4])


def smooth(rng, waves=12):
    found = grid.coefficients(rng.normal(size=NX))
    found[0], found[waves:] = 0.0, 0.0
    return grid.signal(found, NX)


def of_profile(body, order, seed=0):
    """Pressure, heights, tangential traction and the fields `[z, x]` of a profile."""
    rng = np.random.default_rng(seed)
    p, h, t = smooth(rng) + 1.0, 0.01 * smooth(rng), smooth(rng) + (0.0 if body.aspect_ratio is None else 0.5)
    flat = fields.surface_under_tractions(np.stack((t, -p)), body)
    found = inside(topography.rough_surface(np.stack((t, -p)), h, body, order), Z, body)
    assert abs(found.stress1 - inside(flat, Z, body).stress1).max() > 0.1
    return p, h, t, found


@pytest.mark.parametrize(
    ("body", "order"), some_of([(BODIES[0], 3), (BODIES[1], 2), (BODIES[2], 1), (BODIES[2], 3)], 1, 2)
)
def test_fields_below_a_rough_ridge_are_those_of_its_profile(body, order):
    p, h, t, expected = of_profile(body, order)
    p, h, t = (np.tile(each, (NY, 1)) for each in (p, h, t))
    ridges = (
        (topography.rough_surface(np.array([t, 0 * t, -p]), h, body, order), "y", OVER_X),
        (topography.rough_surface(np.array([0 * t.T, t.T, -p.T]), h.T.copy(), body, order), "x", OVER_Y),
    )
    for surface, across, names in ridges:
        for name, found in zip(NAMES, fields.Inside((surface,), body).section(Z, NAMES, across, 0.3), strict=True):
            of_profile_ = getattr(expected, names[name]) if name in names else np.zeros_like(found)
            np.testing.assert_allclose(found, of_profile_, atol=1e-13, err_msg=name)
    on_plane = fields.Inside((ridges[0][0],), body).plane(Z[1], ("u1", "stress5"))
    np.testing.assert_allclose(on_plane[0, 4], expected.u1[1], atol=1e-13)
    np.testing.assert_allclose(on_plane[1, 4], expected.stress5[1], atol=1e-13)


@pytest.mark.parametrize("order", [1, 3])
def test_fields_below_a_turned_ridge_are_those_of_its_profile(order):
    """A ridge over x + y: its waves are shorter by the root of 2, and a half-space knows no other length."""
    body, root = BODIES[0], np.sqrt(0.5)
    p, h, t, expected = of_profile(body, order)
    turned = np.add.outer(np.arange(NX), np.arange(NX)) % NX
    drag = root * t[turned]
    surface = topography.rough_surface(np.array([drag, drag, -p[turned]]), root * h[turned], body, order)
    names = (
        "u1",
        "u2",
        "stress3",
        "stress4",
        "stress5",
        "stress1",
        "stress2",
        "stress6",
        "strain1",
        "strain2",
        "strain6",
    )
    for i, z in enumerate(Z):
        u1, u2, s3, s4, s5, s1, s2, s6, e1, e2, e6 = fields.Inside((surface,), body).plane(root * z, names)
        along = {
            "u1": u1 + u2,
            "stress3": s3,
            "stress5": root * (s4 + s5),
            "stress1": 0.5 * (s1 + s2) + s6,
            "strain1": 0.5 * (e1 + e2 + e6),
        }
        for name, found in along.items():
            np.testing.assert_allclose(found, getattr(expected, name)[i][turned], atol=1e-13, err_msg=name)


def bumps(n):
    y, x = np.meshgrid(np.arange(n) / n, np.arange(n) / n, indexing="ij")
    tau = 2.0 * np.pi
    pressure = 1.0 + np.cos(tau * x) + 0.5 * np.sin(tau * (x + y)) + 0.4 * np.cos(tau * y)
    shear = np.sin(tau * (x - y)), 0.5 * np.cos(tau * y)
    heights = np.cos(tau * (x - y)) + 0.5 * np.sin(tau * y)
    slope_x = -tau * np.sin(tau * (x - y))
    return pressure, shear, heights, (slope_x, np.pi * np.cos(tau * y) - slope_x)


def at_points(surface, places, body, names):
    """Named fields `[name, point]` of a flat body at points (x, y, z), wave by wave."""
    found = np.zeros((len(names), len(places)))
    for i, (x, y, z) in enumerate(places):
        for k_y, k_x, waves in surface.waves(max(-z, 0.0), body, names):
            weight = grid.multiplicity(surface.shape[1])[k_x] * np.exp(2j * np.pi * k_x * x)
            found[:, i] += ((waves @ weight) @ np.exp(2j * np.pi * k_y * y)).real
    return found


@pytest.mark.long
def test_every_order_brings_the_fields_nearer_to_those_below_the_true_surface():
    """Tractions on z = 0 are sought, by iteration, that leave the wanted ones alone on the true surface below it.

    The field of a flat body that bears them is in equilibrium everywhere, so it is that of the rough one; a label is
    where u'' takes it.
    """
    n, body = 12, ElasticBody(0.5, 0.4)
    pressure, shear, waves, slopes = bumps(n)
    wanted = np.stack([*shear, -pressure])
    nodes = [(i, j) for i in range(n) for j in range(n)]
    names = ("stress1", "stress6", "stress2", "stress5", "stress4", "stress3")
    errors = []
    for size in (0.004, 0.002):
        lift = 1.6 * size  # the true surface is nowhere above z = 0
        true, tractions = size * waves - lift, wanted.copy()
        on_surface = [(j / n, i / n, true[i, j]) for i, j in nodes]
        for _ in range(14):
            flat = fields.surface_under_tractions(tractions, body)
            s1, s6, s2, s5, s4, s3 = at_points(flat, on_surface, body, names).reshape(6, n, n)
            rows = ((s5, s1, s6), (s4, s6, s2), (s3, s5, s4))
            change = wanted - [s - size * (slopes[0] * along + slopes[1] * across) for s, along, across in rows]
            tractions = tractions + change
            if abs(change).max() < 1e-7:
                break
        assert abs(change).max() < 1e-7
        lower = ElasticBody(body.nu, body.aspect_ratio - lift)
        labels = np.array([(1 / 12, 5 / 12, -0.05), (7 / 12, 3 / 12, -0.15), (3 / 12, 10 / 12, -0.02)])
        moved = at_points(topography.formed_surface(size * waves, lower), labels, lower, DISPLACEMENTS).T
        exact = at_points(flat, labels + moved - [0.0, 0.0, lift], body, NAMES[:1] + NAMES[3:])
        off = []
        for order in (1, 2, 3):
            surface = topography.rough_surface(wanted, size * waves, lower, order)
            found = [
                fields.Inside((surface,), lower).plane(z, NAMES[:1] + NAMES[3:])[:, round(12 * y), round(12 * x)]
                for x, y, z in labels
            ]
            off.append(abs(np.transpose(found) - exact).max())
        errors.append(off)
    falls = np.log2(np.array(errors[0]) / np.array(errors[1]))
    assert (falls > np.array([1.7, 2.6, 3.4])).all(), errors
    assert errors[1][2] < 1e-4
