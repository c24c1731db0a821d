"""Profiles from files: what is read, and which units and positions are refused."""

import numpy as np
import pytest
import xarray as xr

from gfmd_numba.roughness.measured import read_profile

N, LENGTH = 64, 1e-4
X = np.arange(N) / N * LENGTH
HEIGHTS = 1e-7 * np.cos(2 * np.pi * np.arange(N) / N)


def netcdf(folder, x=X, units="m", x_units="m"):
    height = xr.DataArray(HEIGHTS, dims="x", attrs={"units": units} if units else {}, name="height")
    dataset = height.to_dataset().assign_coords(x=("x", x, {"units": x_units} if x_units else {}))
    dataset.to_netcdf(folder / "profile.nc")
    return folder / "profile.nc"


@pytest.mark.parametrize("x", [X, X + 1, X.astype(np.float32), np.linspace(0, LENGTH, N, endpoint=False)])
def test_positions_that_agree_with_the_length_are_read(tmp_path, x):
    np.testing.assert_array_equal(read_profile(netcdf(tmp_path, x), LENGTH), HEIGHTS)
    np.testing.assert_array_equal(read_profile(netcdf(tmp_path, x, None, None), LENGTH), HEIGHTS)


def test_without_a_length_heights_are_in_units_of_the_period(tmp_path):
    np.testing.assert_array_equal(read_profile(netcdf(tmp_path, np.arange(N), "1", None)), HEIGHTS)
    with pytest.raises(ValueError, match="height in units 'm', not in 1, as the scene has no length"):
        read_profile(netcdf(tmp_path))


@pytest.mark.parametrize("units", ["um", "nm", "1", "s"])
def test_other_units_are_refused(tmp_path, units):
    with pytest.raises(ValueError, match=f"height in units '{units}', not in m, as the scene's length"):
        read_profile(netcdf(tmp_path, units=units), LENGTH)
    with pytest.raises(ValueError, match=f"x in units '{units}', not in m"):
        read_profile(netcdf(tmp_path, x_units=units), LENGTH)


@pytest.mark.parametrize(
    ("x", "problem"),
    [
        (X**2, "not equidistant and ascending"),
        (np.where(np.arange(N) == 7, X + 1e-5 * LENGTH, X), "at index 6, not equidistant"),
        (X[::-1], "not equidistant and ascending"),
        (np.zeros(N), "not equidistant and ascending"),
        (np.full(N, np.nan), "x without finite numbers"),
        (np.linspace(0, LENGTH, N), "x over 0.0001015873 m, not over the scene's length of 0.0001 m"),
        (1e6 * X, "x over 100 m"),
    ],
)
def test_positions_that_disagree_are_refused(tmp_path, x, problem):
    with pytest.raises(ValueError, match=problem):
        read_profile(netcdf(tmp_path, x), LENGTH)


def test_positions_beside_a_bare_dimension_are_checked(tmp_path):
    dataset = xr.Dataset({"height": ("i", HEIGHTS), "x": ("i", X**2)})
    dataset.to_netcdf(tmp_path / "profile.nc")
    with pytest.raises(ValueError, match="not equidistant"):
        read_profile(tmp_path / "profile.nc", LENGTH)


def test_a_byte_order_mark_is_no_height(tmp_path):
    (tmp_path / "profile.csv").write_text("1\n2\n3\n4\n", encoding="utf-8-sig")
    assert read_profile(tmp_path / "profile.csv").tolist() == [1, 2, 3, 4]
