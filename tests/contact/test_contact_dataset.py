"""The fields of a contact in the units of its file."""

import numpy as np
import pytest

from gfmd_numba.arrays.threads import shared_by
from gfmd_numba.contact.contact_dataset import scaled


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("shape", [(), (3,), (600, 513)])
def test_values_are_scaled_one_by_one_whoever_shares_the_work(shape, threads):
    values = np.random.default_rng(1).normal(size=shape)
    with shared_by(threads):
        np.testing.assert_array_equal(scaled(np.asarray(values), 0.3), values * 0.3)


def test_counts_that_need_no_scale_stay_whole():
    assert scaled(np.array([1, 2]), 1.0).dtype.kind == "i"
