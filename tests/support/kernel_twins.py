"""A kernel as it is compiled and as plain Python."""

import pytest


def both(kernel):
    """The compiled kernel and what it was compiled from, which are one and the same with NUMBA_DISABLE_JIT=1."""
    source = getattr(kernel, "py_func", kernel)
    return pytest.param(kernel, id=f"{kernel.__name__}-compiled"), pytest.param(source, id=f"{kernel.__name__}-python")
