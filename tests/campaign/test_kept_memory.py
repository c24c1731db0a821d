"""A worker makes its arrays of memory that it has, not of new pages of the system."""

import os
import platform
import subprocess
import sys
import threading

import pytest

from gfmd_numba.campaign import execution
from gfmd_numba.campaign.execution import keep_freed_memory

FAULTS = """
import resource
import numpy as np
from gfmd_numba.campaign.execution import keep_freed_memory

def faults():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(100):
        np.ones(2**17), np.ones(2**19)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before

before = faults()
keep_freed_memory()
faults()
print(before, faults())
"""


@pytest.mark.long
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="other libraries know no such thresholds")
def test_arrays_are_made_of_kept_pages_also_under_a_nanny():
    environment = os.environ | {"MALLOC_TRIM_THRESHOLD_": "65536"}  # as dask sets it for its workers
    said = subprocess.run([sys.executable, "-c", FAULTS], env=environment, capture_output=True, text=True, check=True)
    before, after = map(int, said.stdout.split())
    assert before > 100 * 256  # the pages of the smaller one
    assert after < 256


def test_nothing_happens_without_a_library_that_knows_it(monkeypatch):
    for missing in (OSError("no such library"), TypeError("no name")):

        def lacking(_, error=missing):
            raise error

        monkeypatch.setattr("ctypes.CDLL", lacking)
        keep_freed_memory.__wrapped__()
    monkeypatch.setattr("ctypes.CDLL", lambda _: object())
    keep_freed_memory.__wrapped__()


def test_only_a_process_of_workers_keeps_memory(tmp_path, monkeypatch):
    """That of the user keeps its own ways."""
    kept = threading.Event()
    monkeypatch.setattr(execution, "keep_freed_memory", kept.set)
    execution.perform((), tmp_path, None)
    assert not kept.is_set()
    execution.compute((), "run", {}, None)
    assert kept.is_set()
