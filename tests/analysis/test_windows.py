"""Statistics of contacts without a period: nothing goes around the ends of the window."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba


def window(touching, *attributes):
    """Dataset of a contact with these nodes in contact, with an attribute for each axis (y,) x, or all."""
    dims = ("y", "x")[-touching.ndim :]
    gap = np.where(touching, 0.0, 1.0)
    fields = {"gap": gap, "height": 0.1 - gap, "pressure": touching.astype(float)}
    found = xr.Dataset({name: (dims, values) for name, values in fields.items()})
    found = found.assign(status=0, mean_pressure=float(touching.mean()), full_contact_rms_pressure=1.0)
    attributes = attributes if len(attributes) > 1 else (attributes or ("points_per_window",)) * touching.ndim
    for dim, n, attribute in zip(dims, touching.shape, attributes, strict=True):
        found = found.assign_coords({dim: (dim, np.arange(n) / n, {attribute: n, "units": "1"})})
    return found


@pytest.mark.parametrize(("attribute", "number"), [("points_per_window", 2), ("points_per_period", 1)])
def test_contacts_at_both_ends_of_a_window_are_two(attribute, number):
    of_line = np.zeros(32, dtype=bool)
    of_line[:3] = of_line[-5:] = True
    of_map = np.tile(of_line, (32, 1))
    assert int(gfmd_numba.contact_statistics(window(of_line, attribute))["segments"].sum()) == number
    assert int(gfmd_numba.contact_statistics(window(of_map, attribute))["clusters"].sum()) == number


def test_an_edge_of_the_window_is_an_edge_of_the_contact():
    touching = np.zeros((64, 64), dtype=bool)
    touching[:, :16] = True
    found = gfmd_numba.contact_statistics(window(touching))
    assert float(found["perimeter"]) == pytest.approx(2.0 + 0.5, rel=0.1)
    around = gfmd_numba.contact_statistics(window(touching, "points_per_period"))
    assert float(around["perimeter"]) == pytest.approx(2.0, rel=0.1)


@pytest.mark.filterwarnings("ignore")  # one channel leaks more than walls as far apart on average
def test_no_channel_leads_around_the_ends_of_a_window():
    """The only channel steps from one end of the rows to the other."""
    touching = np.ones((16, 16), dtype=bool)
    touching[:9, 0] = touching[8:, -1] = touching[0, -1] = False
    around, ending = (window(touching, name) for name in ("points_per_period", "points_per_window"))
    for dataset, connects in ((around, 1), (ending, 0)):
        percolation = gfmd_numba.gap_percolation(dataset).sel(direction="y")
        assert int(percolation["gap_connects"]) == connects
        assert float(percolation["critical_gap"]) == connects
        leaks = float(gfmd_numba.leakage(dataset).sel(direction="y")["hydraulic_gap"])
        assert (leaks > 0.0) == bool(connects)
    assert int(gfmd_numba.gap_percolation(ending)["n_gaps"]) == 3


def test_a_window_leaks_as_a_channel_between_its_walls():
    """A gap that is open all over is parallel walls, whatever is at the sides."""
    touching = np.zeros((16, 16), dtype=bool)
    found = gfmd_numba.leakage(window(touching))
    np.testing.assert_allclose(found["hydraulic_gap"], 1.0, rtol=1e-12)


@pytest.mark.filterwarnings("ignore")  # the directions leak unlike each other
@pytest.mark.parametrize("turned", [False, True])
def test_a_period_along_one_axis_joins_the_ends_of_that_alone(turned):
    """A stripe along x at both ends of y, where y has the period: one contact, with two edges along x and none across.

    The gap between them is a channel along x, and one to nowhere along y.
    """
    touching = np.zeros((32, 32), dtype=bool)
    touching[:4] = touching[-4:] = True
    named = ("points_per_period", "points_per_window")
    found = window(touching.T if turned else touching, *(named[::-1] if turned else named))
    statistics, percolation = gfmd_numba.contact_statistics(found), gfmd_numba.gap_percolation(found)
    assert int(statistics["clusters"].sum()) == 1
    along, across = ("y", "x") if turned else ("x", "y")
    assert int(percolation["gap_connects"].sel(direction=along)) == 1
    assert int(percolation["gap_connects"].sel(direction=across)) == 0
    assert float(percolation["largest_contact_fraction"]) == pytest.approx(0.25)
    assert float(statistics["perimeter"]) == pytest.approx(2.0 + 2.0 * 0.25, rel=0.1)
    leaks = gfmd_numba.leakage(found)["hydraulic_gap"]
    assert float(leaks.sel(direction=along)) ** 3 == pytest.approx(0.75, rel=1e-9)
    assert float(leaks.sel(direction=across)) == 0.0
