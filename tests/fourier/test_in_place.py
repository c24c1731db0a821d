"""Transforms in place, and of rows that other arrays own."""

import numpy as np
import pytest

from gfmd_numba.arrays import threads as threading
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform, aligned_rows


@pytest.mark.parametrize("shape", [(16, 16), (12, 10), (9, 7), (8, 64)])
def test_stiffness_and_compliance_are_those_of_the_waves(shape):
    """Of the second of three maps, which leaves the others as they are."""
    rng = np.random.default_rng(0)
    batch = Transform(3, *shape, in_place=True)
    field = batch.row(1)
    samples, stiffness = rng.normal(size=shape), grid.magnitudes(shape) + 0.5
    stiffness[0, 0] = np.inf
    field.samples[0] = samples
    field.apply_stiffness(stiffness)
    stiffness[0, 0] = 0.0
    expected = np.fft.irfft2(np.fft.rfft2(samples) * stiffness, shape)
    np.testing.assert_allclose(batch.samples[1], expected, rtol=1e-12, atol=1e-10)
    field.apply_compliance(stiffness)
    np.testing.assert_allclose(batch.samples[1], samples - samples.mean(), atol=3e-13)
    assert batch.n_transforms.tolist() == [0, 4, 0]
    assert not batch.samples[::2].any()


@pytest.mark.parametrize("nx", [64, 100, 1024, 4096])
def test_rows_are_an_odd_number_of_cache_lines(nx):
    made = Transform(2, 3, nx, in_place=True)
    assert made.waves.strides[1] % 128 == 64
    assert made.samples.shape == (2, 3, nx)
    assert all(each.ctypes.data % 64 == 0 for each in made.samples)
    assert np.shares_memory(made.samples, made.waves)


@pytest.mark.parametrize("n", [7, 64, 101])
def test_rows_of_other_arrays_are_transformed_as_those_of_a_batch(n):
    symbol, rows = np.arange(n // 2 + 1.0), aligned_rows(4, n)
    batch, field = Transform(3, n), Transform(1, n, sources=0)
    rows[:3, :n] = batch.sources[0][:, :n] = np.random.default_rng(0).normal(size=(3, n))
    batch.apply(batch.symbol(symbol), np.arange(3))
    for i in range(3):
        field.transfer(field.symbol(symbol), rows[i], rows[3])
        np.testing.assert_array_equal(rows[3], batch.result[i])


@pytest.mark.parametrize(("shape", "filled"), [((16, 16), 8), ((32, 40), 24), ((64, 64), 1)])
def test_a_transform_of_filled_rows_is_the_whole_one_there_and_leaves_the_others(shape, filled):
    """Of the second of two maps; what the other rows hold does not matter."""
    rng = np.random.default_rng(0)
    batch = Transform(2, *shape, in_place=True, filled=filled)
    field, stiffness = batch.row(1), grid.magnitudes(shape)
    batch.memory[:] = 7.0
    field.samples[0, :filled] = samples = rng.normal(size=(filled, shape[1]))
    field.apply_compliance(stiffness, filled=True)
    stiffness[0, 0] = np.inf
    expected = np.fft.irfft2(np.fft.rfft2(samples, shape) / stiffness, shape)[:filled]
    np.testing.assert_allclose(field.samples[0, :filled], expected, atol=1e-14)
    assert (batch.memory[1, filled:] == 7.0).all()
    assert (batch.memory[0] == 7.0).all()
    assert batch.n_transforms.tolist() == [0, 2]


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize(("shape", "filled"), [((64, 64), 32), ((48, 40), 40), ((50, 24), 25)])
def test_a_map_transformed_in_pieces_is_the_whole_one_for_any_number_of_threads(monkeypatch, shape, filled, threads):
    rng = np.random.default_rng(0)
    samples, stiffness = rng.normal(size=shape), grid.magnitudes(shape)
    samples[filled:] = 0.0
    coarse = tuple(n // 2 for n in shape)
    whole, pieces, fewer = Transform(1, *shape, in_place=True), Transform(1, *shape, in_place=True, filled=filled), []
    monkeypatch.setattr(threading, "cores", lambda: 3)
    monkeypatch.setattr(threading, "_FEWEST", 0)
    with threading.shared_by(threads):
        for field in (whole, pieces):
            field.samples[0] = samples
            fewer.append(Transform(1, *coarse, in_place=True))
            field.coarsen(fewer[-1], filled=True)
            field.samples[0] = samples
            field.apply_stiffness(stiffness)
    np.testing.assert_allclose(fewer[1].samples, fewer[0].samples, atol=1e-14)
    np.testing.assert_allclose(pieces.samples, whole.samples, atol=1e-12)
    alone = Transform(1, *shape, in_place=True, filled=filled)
    alone.samples[0] = samples
    alone.apply_stiffness(stiffness)
    np.testing.assert_array_equal(pieces.samples, alone.samples)


@pytest.mark.parametrize(("nodes", "busy"), [(2**16, 1), (2**20, 2)])
def test_small_work_is_not_shared(monkeypatch, nodes, busy):
    monkeypatch.setattr(threading, "cores", lambda: 2)
    used, done = [], []
    with threading.shared_by(2):
        threading.team().share(lambda *part: used.append(part), 64, nodes, lambda: done.append("before"))
    assert done == ["before"]
    assert [each for _, *part in sorted(used, key=lambda part: part[1]) for each in range(*part)] == [*range(64)]
    assert used == [(0, 0, 64)] if busy == 1 else len(used) == 8


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_sums_of_pieces_come_in_their_order_for_any_number_of_threads(monkeypatch, threads):
    monkeypatch.setattr(threading, "cores", lambda: 3)
    monkeypatch.setattr(threading, "_FEWEST", 0)
    monkeypatch.setattr(threading, "_PIECE", 7)
    numbers = np.random.default_rng(0).permutation(100)
    with threading.shared_by(threads):
        found = threading.team().in_pieces(lambda some: numbers[some].tolist(), 100)
    assert [len(each) for each in found] == 14 * [7] + [2]
    assert np.concatenate(found).tolist() == numbers.tolist()


def test_what_shared_work_raises_is_raised_and_a_team_within_a_team_waits_for_no_one(monkeypatch):
    monkeypatch.setattr(threading, "cores", lambda: 2)
    monkeypatch.setattr(threading, "_FEWEST", 0)
    made = []
    with threading.shared_by(2):
        team = threading.team()
        team.share(lambda *_: made.append(1), 8, 8, lambda: team.share(lambda *_: made.append(2), 8, 8))
        with pytest.raises(ValueError, match="no such piece"):
            team.in_pieces(lambda some: int("no such piece"), 2**15)
    assert sorted(made) == 8 * [1] + 8 * [2]
