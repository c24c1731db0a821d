"""Shards: each is written and read whole, or not at all."""

import numpy as np

from gfmd_numba.campaign import shards


def test_shards_are_all_or_nothing(tmp_path):
    path = tmp_path / "a.shard"
    assert shards.read(path) is None
    arrays = {"kappa": np.array([1.0, np.nan]), "status": np.array([0, 1], dtype=np.int8)}
    shards.write(path, arrays)
    stored = shards.read(path)
    assert stored is not None
    for name, values in arrays.items():
        np.testing.assert_array_equal(stored[name], values)
        assert stored[name].dtype == values.dtype
    content = path.read_bytes()
    (tmp_path / "b.shard").write_bytes(content)
    assert shards.read(tmp_path / "b.shard") is None
    (tmp_path / "b.shard").unlink()
    for cut in range(0, len(content), 7):
        path.write_bytes(content[:cut])
        assert shards.read(path) is None
    assert list(tmp_path.iterdir()) == [path]
