"""Maps whose rows processes share: their transforms, their edges and their sums."""

from itertools import pairwise

import numpy as np
import pytest

from gfmd_numba.arrays.processes import Slab
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.distributed import SlabTransform
from support.team_of_threads import together


def _shared(samples, size, work, unit=1):
    """What some work makes of each slab of the samples, put together."""

    def one(communicator):
        slab = Slab.of(communicator, len(samples), unit)
        first = slab.bounds[communicator.rank]
        return work(slab, samples[first : first + slab.rows].copy())

    return np.concatenate(together(size, one))


@pytest.mark.parametrize("shape", [(16, 16), (12, 10), (9, 7), (8, 64)])
def test_stiffness_and_compliance_are_those_of_the_waves_for_any_number_of_processes(shape):
    samples, stiffness = np.random.default_rng(0).normal(size=shape), grid.magnitudes(shape)

    def apply_stiffness(slab, own):
        SlabTransform(slab, shape[1], np.copy).apply_stiffness(own)
        return own

    def apply_compliance(slab, own):
        SlabTransform(slab, shape[1], np.copy).apply_compliance(own)
        return own

    stiff = _shared(samples, 1, apply_stiffness)
    np.testing.assert_allclose(stiff, np.fft.irfft2(np.fft.rfft2(samples) * stiffness, shape), atol=1e-10)
    np.testing.assert_allclose(_shared(stiff, 3, apply_compliance), samples - samples.mean(), atol=3e-13)
    for size in (2, 3, 5):
        np.testing.assert_array_equal(_shared(samples, size, apply_stiffness), stiff)


@pytest.mark.parametrize("size", [1, 2, 3, 4])
def test_edges_are_those_of_the_neighbours(size):
    samples = np.random.default_rng(1).normal(size=(16, 5))

    def edges(slab, own):
        values = np.zeros((len(own) + 4, 5))
        values[2:-2] = own
        slab.fill_edges(values, 2)
        return values[np.newaxis, [0, 1, -2, -1]]

    bounds = [16 * rank // size for rank in range(size + 1)]
    expected = [samples[[first - 2, first - 1, last % 16, (last + 1) % 16]] for first, last in pairwise(bounds)]
    np.testing.assert_array_equal(_shared(samples, size, edges), expected)


def test_sums_are_the_same_to_the_last_bit_and_bounds_are_multiples_of_a_unit():
    samples = np.random.default_rng(2).normal(size=(48, 31))
    sums = [_shared(samples, size, lambda slab, own: slab.total(own.sum(axis=1))[np.newaxis])[0] for size in (1, 2, 5)]
    assert sums[0] == sums[1] == sums[2] == pytest.approx(samples.sum())
    bounds = together(5, lambda communicator: Slab.of(communicator, 48, 4).bounds)
    assert bounds == [(0, 8, 16, 28, 36, 48)] * 5


def test_the_largest_of_all_is_not_a_number_where_one_is():
    found = together(2, lambda communicator: Slab.of(communicator, 4).largest([1.0, np.nan][communicator.rank], 2.0))
    assert np.isnan(found[0][0])
    assert found[1][1] == 2.0


def test_fields_come_together_in_the_first_process():
    samples = np.random.default_rng(3).normal(size=(9, 4))

    def work(communicator):
        slab = Slab.of(communicator, 9)
        first = slab.bounds[communicator.rank]
        return slab.gathered(samples[first : first + slab.rows])

    whole, *others = together(3, work)
    np.testing.assert_array_equal(whole, samples)
    assert others == [None, None]
