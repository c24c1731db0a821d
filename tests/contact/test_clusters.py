"""Clusters of maps and the largest pressure against plain loops."""

from dataclasses import replace

import numpy as np
import pytest

from gfmd_numba.contact import evaluation
from gfmd_numba.contact.state import Contact
from gfmd_numba.solvers.equilibrium import Equilibrium


def contact(pressure):
    one = np.ones(len(pressure))
    heights = np.zeros_like(pressure)
    return Contact(heights, heights, Equilibrium(heights, pressure, pressure > 0, None, one, one, one, one, one, one))


def flooded(flags):
    """Clusters of a map on a torus, one flood after another."""
    left, clusters = flags.copy(), 0
    while left.any():
        clusters += 1
        front = [tuple(np.argwhere(left)[0])]
        while front:
            y, x = front.pop()
            if left[y, x]:
                left[y, x] = False
                for dy, dx in ((0, 1), (1, 0), (0, -1), (-1, 0)):
                    front.append(((y + dy) % flags.shape[0], (x + dx) % flags.shape[1]))
    return clusters


@pytest.mark.parametrize("density", [0.05, 0.3, 0.5, 0.6, 0.9])
def test_clusters_are_those_of_a_flood_around_the_period(density):
    rng = np.random.default_rng(int(100 * density))
    maps = rng.random((20, 24, 24)) * (rng.random((20, 24, 24)) < density)
    assert evaluation.n_segments(contact(maps)).tolist() == [flooded(each > 0) for each in maps]


@pytest.mark.parametrize("ends", [False, True])
def test_stretches_are_those_that_begin_on_a_profile_and_none_in_full_contact_of_a_period(ends):
    rng = np.random.default_rng(3)
    profiles = (rng.random((30, 20)) < np.linspace(0.0, 1.0, 30)[:, np.newaxis]).astype(float)
    before = np.concatenate([np.zeros((30, 1)) if ends else profiles[:, -1:], profiles[:, :-1]], axis=1)
    expected = [sum(now > last for now, last in zip(*both, strict=True)) for both in zip(profiles, before, strict=True)]
    found = replace(contact(profiles), ends=(ends,))
    assert evaluation.n_segments(found).tolist() == expected
    assert (expected[0], expected[-1]) == (0, int(ends))


@pytest.mark.parametrize("shape", [(3, 40), (3, 12, 12)])
def test_the_peak_is_the_largest_pressure_of_each_realisation(shape):
    pressure = np.random.default_rng(1).normal(size=shape)
    expected = [max(each.ravel().tolist()) for each in pressure]
    assert evaluation.peak_pressure(contact(pressure)).tolist() == expected
