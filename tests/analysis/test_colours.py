"""Lines of the pictures can be told apart in grey and by dichromats, and none is faint on white."""

from itertools import combinations, pairwise

import numpy as np
import pytest
import xarray as xr

from gfmd_numba.analysis.plots.campaign import looks_of
from gfmd_numba.analysis.plots.style import COLOURS, ordered_colours
from support import eyes

LINES = COLOURS[:3]  # of lines and points; all other colours fill areas


@pytest.mark.parametrize("colour", [*LINES, *ordered_colours(8)])
def test_a_line_has_a_contrast_of_3_to_white(colour):
    assert eyes.contrast_to_white(colour) >= 2.99


@pytest.mark.parametrize("count", range(2, 9))
def test_ordered_colours_keep_a_distance_in_grey(count):
    grey = [eyes.lightness(colour) for colour in ordered_colours(count)]
    assert np.diff(grey).min() > 40.0 / count


@pytest.mark.parametrize("seen_by", [None, *eyes.DICHROMATS])
def test_neighbouring_colours_differ_for_any_colour_vision(seen_by):
    assert all(eyes.difference(one, other, seen_by) > 10.0 for one, other in combinations(LINES, 2))
    for count in range(2, 9):
        assert all(eyes.difference(*pair, seen_by) > 40.0 / count for pair in pairwise(ordered_colours(count)))


def test_sticking_and_slipping_nodes_differ_in_grey():
    assert eyes.lightness(COLOURS[5]) - eyes.lightness(COLOURS[0]) > 20.0


@pytest.mark.parametrize(("hursts", "loads"), [(8, 1), (1, 8), (3, 4)])
def test_no_two_groups_of_a_campaign_have_one_marker_and_one_grey(hursts, loads):
    hurst, load = (each.ravel() for each in np.meshgrid(np.linspace(0.1, 0.9, hursts), np.linspace(0.1, 0.8, loads)))
    axes = {"hurst": ("case", hurst, {"axis": "physics"}), "reduced_pressure": ("case", load, {"axis": "physics"})}
    found = looks_of(xr.Dataset(coords=axes | {"case": np.arange(hurst.size)}))
    assert len(found.of) == hurst.size
    for one, other in combinations(found.of.values(), 2):
        apart = abs(eyes.lightness(one["color"]) - eyes.lightness(other["color"]))
        assert one["marker"] != other["marker"] or one["linestyle"] != other["linestyle"] or apart > 5.0
