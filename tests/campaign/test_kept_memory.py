"""A worker makes its arrays of memory that it has, not of new pages of the system."""

import platform
import resource

import numpy as np
import pytest

from gfmd_numba.campaign import cluster


def faults():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(100):
        np.ones(2**17), np.ones(2**19)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


@pytest.mark.long
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="other libraries know no such thresholds")
def test_arrays_of_a_worker_are_made_of_kept_pages():
    with cluster.local(1) as client:
        client.submit(faults, pure=False).result()
        assert client.submit(faults, pure=False).result() < 256  # of 100 * 256 pages of the smaller array
