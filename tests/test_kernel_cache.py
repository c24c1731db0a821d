"""Compiled kernels: found again, compiled again when damaged, and no reason to fail where nothing can be stored."""

import os
import subprocess
import sys

import pytest

from gfmd_numba import kernel_cache

COMPILE = """
import numpy as np
from gfmd_numba import kernels
spectrum = np.ones((1, 4), dtype=complex)
kernels.multiply(spectrum, np.full(4, 2.0), np.array([0]))
assert (spectrum == 2.0).all()
print(sum(kernels.multiply.stats.cache_hits.values()) if hasattr(kernels.multiply, "stats") else -1)
"""


def compile_in(folder, **environment):
    surroundings = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA")}
    ran = subprocess.run(
        [sys.executable, "-c", COMPILE],
        env=surroundings | {"GFMD_CACHE_DIR": str(folder)} | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return int(ran.stdout)


def test_kernels_are_compiled_once_and_again_when_damaged(tmp_path):
    assert compile_in(tmp_path) == 0
    assert compile_in(tmp_path) == 1
    code = next(tmp_path.rglob("*.nbc"))
    content = bytearray(code.read_bytes())
    content[len(content) // 2] ^= 0xFF
    code.write_bytes(content)
    assert compile_in(tmp_path) == 0
    assert compile_in(tmp_path) == 1


@pytest.mark.parametrize("content", ["", "[]", "{", '{"gone.nbi": "0"}'])
def test_a_damaged_seal_discards(tmp_path, content):
    kernel = tmp_path / "kernel.nbi"
    kernel.write_bytes(b"code")
    kernel_cache.seal(tmp_path)
    kernel_cache.discard_damaged(tmp_path)
    assert kernel.exists()
    (tmp_path / "seal.json").write_text(content)
    kernel_cache.discard_damaged(tmp_path)
    assert not kernel.exists()


def test_no_cache_is_no_failure(tmp_path):
    """A file where the folder should be: not even root can write there."""
    (tmp_path / "file").touch()
    assert compile_in(tmp_path / "file" / "cache", HOME=str(tmp_path / "file")) == 0
