"""Channels through maps made by hand and solved, and the narrowest place of each against a search on copies of it."""

import bisect

import numpy as np
import pytest
import scipy
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis import UnusableDataError
from gfmd_numba.analysis.channels import connecting
from gfmd_numba.arrays.regions import regions
from support.solved_maps import made, pressed, wave

DRAWN = {
    "a straight wall along y": (["..#...", "..#...", "..#...", "..#..."], (0, 1)),
    "a wall with a hole": (["..#...", "......", "..#...", "..#..."], (1, 1)),
    "a staircase that closes at corners": (["#.....", ".#....", "..#...", "...#.."], (1, 1)),
    "a closed staircase around the period": (["##....", ".##...", "..##..", "####.."], (0, 1)),
    "open everywhere": (["......", "......", "......", "......"], (1, 1)),
    "full contact": (["######", "######", "######", "######"], (0, 0)),
}


@pytest.mark.parametrize("name", DRAWN)
def test_a_channel_leads_from_side_to_side_or_not(name):
    rows, expected = DRAWN[name]
    touching = np.array([[node == "#" for node in row] for row in rows])
    found = gfmd_numba.gap_percolation(made(touching))
    assert tuple(found["gap_connects"].values) == expected
    assert tuple(found["critical_gap"].values) == expected


def test_a_channel_along_x_may_leave_through_the_period_of_y():
    touching = np.array([[node == "#" for node in row] for row in ["..##", "####", "####", "##.."]])
    assert gfmd_numba.gap_percolation(made(touching))["gap_connects"].values.tolist() == [0, 0]
    touching[0, 2] = touching[3, 0] = False
    found = gfmd_numba.gap_percolation(made(touching))
    assert found["gap_connects"].values.tolist() == [1, 0]
    assert found["n_gaps"] == 1


def test_gaps_and_contacts_of_different_sizes_are_told_apart():
    touching = np.ones((8, 8), dtype=bool)
    touching[1, 1:4] = False
    touching[5, [0, 7]] = False  # one gap across the period
    touching[3, 6] = False
    found = gfmd_numba.gap_percolation(made(touching))
    assert found["n_gaps"] == 3
    assert found["largest_gap_fraction"] == 3 / 64
    assert found["largest_contact_fraction"] == 58 / 64
    assert found["contact_connects"].values.tolist() == [1, 1]


def widest(gap, axis):
    """Largest gap at which, on five by five copies of the map, a node connects with its copy some periods along."""
    n, copies = len(gap), 5
    tiled = np.tile(np.moveaxis(gap, axis, 0), (copies, copies))

    def winds(level):
        labels = scipy.ndimage.label(tiled >= level)[0].reshape(copies, n, copies, n)
        pairs = ((labels[i], labels[j]) for j in range(copies) for i in range(j))
        pairs = ((one[:, m], two[:, k]) for one, two in pairs for m in range(copies) for k in range(copies))
        return any(((one == two) & (one > 0)).any() for one, two in pairs)

    levels = np.append(np.unique(gap[gap > 0.0])[::-1], 0.0)
    return levels[bisect.bisect_left(levels, True, hi=len(levels) - 1, key=winds)]


@pytest.mark.parametrize("share", [0.0, 0.3, 0.45])
def test_the_critical_gap_is_that_of_the_widest_way(share):
    rng = np.random.default_rng(int(100 * share))
    gaps = np.maximum(rng.random((4, 12, 12)) - share, 0.0)
    found = gfmd_numba.gap_percolation(made(gaps == 0.0, gaps))
    expected = [[widest(gap, 1), widest(gap, 0)] for gap in gaps]
    np.testing.assert_array_equal(found["critical_gap"], expected)
    np.testing.assert_array_equal(found["gap_connects"], np.array(expected) > 0.0)


def test_where_the_period_is_cut_changes_no_channel():
    rng = np.random.default_rng(3)
    gaps = np.maximum(rng.random((8, 16, 16)) - 0.4, 0.0)
    dataset = made(gaps == 0.0, gaps)
    found = gfmd_numba.gap_percolation(dataset)
    for rolled in ({"x": 5}, {"y": 8}, {"x": 3, "y": 11}):
        xr.testing.assert_equal(gfmd_numba.gap_percolation(dataset.roll(rolled)), found)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_ridge_closes_the_direction_across_it_only(axis):
    """The ridge varies along `axis`; along it the gap is widest in the valley, where Westergaard's wave is lowest."""
    dataset = pressed(wave(64, 0.01, axis), 0.3 * np.pi * 0.01)
    found = gfmd_numba.gap_percolation(dataset)
    assert found["gap_connects"].sel(direction="xy"[axis]) == 1
    assert found["gap_connects"].sel(direction="yx"[axis]) == 0
    assert float(found["critical_gap"].max()) == pytest.approx(float(dataset["gap"].max()), rel=1e-9)
    assert found["contact_connects"].sum() == 1


def test_sites_of_a_square_lattice_percolate_near_their_threshold():
    """Site percolation: 0.592746 (Newman & Ziff, PRL 85:4104, 2000); below 0.55 and above 0.64 hardly a doubt."""
    rng = np.random.default_rng(5)
    below, above = (
        np.mean([connecting(rng.random((200, 200)) < share, 0).any() for _ in range(20)]) for share in (0.55, 0.64)
    )
    assert below < 0.1
    assert above > 0.9


def test_regions_on_a_torus_have_the_numbers_one_to_n():
    flags = np.random.default_rng(1).random((50, 50)) < 0.5
    labels = regions(flags, (True, True))
    assert set(labels[flags]) == set(range(1, labels.max() + 1))
    assert not labels[~flags].any()


def test_profiles_have_no_channels():
    with pytest.raises(UnusableDataError, match="you gave "):
        gfmd_numba.gap_percolation(made([[True, False, True, False]] * 4).isel(y=0))
    with pytest.raises(UnusableDataError, match="you gave "):
        gfmd_numba.gap_percolation(xr.Dataset())
