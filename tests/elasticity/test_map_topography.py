"""Maps that are not flat, order by order: against slabs of another height, and the field on the true surface."""

import numpy as np
import pytest

from gfmd_numba.elasticity import fields, topography
from gfmd_numba.elasticity.body import ElasticBody

N = 12
Y, X = np.meshgrid(np.arange(N) / N, np.arange(N) / N, indexing="ij")
PRESSURE = 1.0 + np.cos(2 * np.pi * X) + 0.5 * np.sin(2 * np.pi * (X + Y)) + 0.4 * np.cos(2 * np.pi * Y)
BUMPY = np.cos(2 * np.pi * (X - Y)) + 0.5 * np.sin(2 * np.pi * Y) - 1.6  # nowhere above z = 0


def displaced(body):
    """Normal displacement of the flat body under the pressure."""
    return body.response((N, N)).apply(np.stack([0 * PRESSURE, 0 * PRESSURE, -PRESSURE]))[2]


def falls(errors):
    return np.log2(np.array(errors)[:-1] / np.array(errors)[1:])


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_uniform_topography_is_a_higher_slab(order):
    nu, a, errors = 0.3, 0.5, []
    for height in (0.04, 0.02, 0.01):
        low, high = (displaced(ElasticBody(nu, each)) for each in (a, a + height))
        found = topography.respond(PRESSURE, np.full((N, N), height), ElasticBody(nu, a), order)
        errors.append(abs(found.u3 - (high - low)).max())
    assert (falls(errors) > order + 0.5).all()


def on_surface(tractions, heights, body, names):
    """Named fields of the flat body on the true surface `[field, y, x]`, node by node."""
    surface = fields.surface_under_tractions(tractions, body)
    found = np.empty((len(names), N, N))
    for i, j in np.ndindex(N, N):
        found[:, i, j] = fields.Inside((surface,), body).section(heights[i, j : j + 1], names, "y", i / N)[:, 0, j]
    return found


@pytest.mark.long
def test_every_order_brings_the_surface_nearer_to_where_the_true_one_goes():
    """Tractions on z = 0 are sought, by iteration, that leave the pressure alone on the true, tilted surface."""
    in_x, in_y = (2 * np.pi * each for each in (-np.sin(2 * np.pi * (X - Y)), np.sin(2 * np.pi * (X - Y))))
    in_y = in_y + np.pi * np.cos(2 * np.pi * Y)
    body, wanted, errors = ElasticBody(0.3, None), np.stack([0 * PRESSURE, 0 * PRESSURE, -PRESSURE]), []
    for size in (0.004, 0.002):
        heights, tractions = size * BUMPY, wanted.copy()
        for _ in range(14):
            names = ("stress1", "stress6", "stress2", "stress5", "stress4", "stress3", "u3")
            s1, s6, s2, s5, s4, s3, u3 = on_surface(tractions, heights, body, names)
            slopes = size * in_x, size * in_y
            rows = ((s5, s1, s6), (s4, s6, s2), (s3, s5, s4))
            change = wanted - [s - slopes[0] * along - slopes[1] * across for s, along, across in rows]
            change[:2] -= change[:2].mean(axis=(1, 2), keepdims=True)
            tractions = tractions + change
            if abs(change).max() < 1e-7:
                break
        assert abs(change).max() < 1e-7
        flat = displaced(body)
        responses = [topography.respond(PRESSURE, heights, body, order).u3 for order in (0, 1, 2, 3)]
        off = [u3 - flat - response for response in responses]
        errors.append([abs(each - each.mean()).max() for each in off])
    assert (falls(errors)[0] > np.array([0.8, 1.7, 2.6, 3.4])).all(), errors
    assert errors[1][3] < 1e-4 * abs(flat).max()
