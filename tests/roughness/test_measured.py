"""Profiles from files: what is read, and which units and positions are refused."""

import numpy as np
import pytest
import xarray as xr

from gfmd_numba import make_surface
from gfmd_numba.roughness.measured import measured_surface
from gfmd_numba.scene import InputError
from gfmd_numba.scene.measured_record import Measured

N, LENGTH = 64, 1e-4
X = np.arange(N) / N * LENGTH
HEIGHTS = 1e-7 * np.cos(2 * np.pi * np.arange(N) / N)


def netcdf(folder, x=X, units="m", x_units="m"):
    height = xr.DataArray(HEIGHTS, dims="x", attrs={"units": units} if units else {}, name="height")
    dataset = height.to_dataset().assign_coords(x=("x", x, {"units": x_units} if x_units else {}))
    dataset.to_netcdf(folder / "profile.nc")
    return folder / "profile.nc"


def read(path, length=LENGTH, **more):
    return measured_surface(Measured(method="measured", file=str(path), **more), length)


@pytest.mark.parametrize(("x", "length"), [(X + 1, LENGTH), (X.astype(np.float32), LENGTH), (X[::-1], None)])
def test_positions_that_agree_with_the_length_are_read(tmp_path, x, length):
    turned = x[0] > x[-1]
    found = read(netcdf(tmp_path, x), length)
    np.testing.assert_array_equal(found.heights, HEIGHTS[::-1] if turned else HEIGHTS)
    assert found.lengths == pytest.approx((LENGTH,))
    assert found.done == (("turned round along x, as its positions descend",) if turned else ())


def test_positions_of_few_digits_are_read(tmp_path):
    x = np.round(X * 1e6, 2) * 1e-6  # as an instrument prints them, by up to half a percent of a spacing
    assert 1e-3 < abs(np.diff(x) / np.diff(X) - 1.0).max() < 1e-2
    np.testing.assert_array_equal(read(netcdf(tmp_path, x), None).heights, HEIGHTS)


def test_a_mirrored_field_has_half_the_period_whoever_tells_its_size(tmp_path):
    own = read(netcdf(tmp_path), 2 * LENGTH, periodic="mirror")
    np.save(tmp_path / "p.npy", HEIGHTS)
    told = read(tmp_path / "p.npy", None, periodic="mirror", units={"z": "m"}, spacing=LENGTH / N)
    np.testing.assert_array_equal(own.heights, told.heights)
    assert own.lengths == pytest.approx((2 * LENGTH,))
    assert told.lengths == pytest.approx((2 * LENGTH,))
    with pytest.raises(ValueError, match=r"spacing: 1.5625e-06 m in its place if .*, or spacing: 7.8125e-07 m if"):
        read(tmp_path / "p.npy", LENGTH, periodic="mirror", units={"z": "m"})
    with pytest.raises(
        ValueError, match=r"positions over a period of 0.0002 m once mirrored, .* not length = 0.0001 m"
    ):
        read(netcdf(tmp_path), LENGTH, periodic="mirror")


@pytest.mark.parametrize(
    ("x", "problem"),
    [
        (X**2, "not equidistant; `points: 64`, or twice as many with"),
        (np.where(np.arange(N) == 7, X + 1e-3 * LENGTH, X), "at index [67], where .* is the mean: not equidistant"),
        (np.roll(X, 5), "positions x that are in no order from index 4 on"),
        (np.full(N, np.nan), "position x = nan at index 0, not a finite number"),
        (np.linspace(0, LENGTH, N), "positions over a period of 0.0001015873 m, .* not length = 0.0001 m"),
    ],
)
def test_positions_that_disagree_are_refused(tmp_path, x, problem):
    with pytest.raises(ValueError, match=problem):
        read(netcdf(tmp_path, x))


def test_uneven_positions_are_interpolated_if_points_are_asked_for(tmp_path):
    order = np.random.default_rng(0).permutation(N)
    x = np.sort(np.random.default_rng(1).uniform(0, LENGTH, N))
    dataset = xr.Dataset({"height": ("x", (1e-2 * x)[order], {"units": "m"})}, {"x": ("x", x[order], {"units": "m"})})
    dataset.to_netcdf(tmp_path / "p.nc")
    found = read(tmp_path / "p.nc", None, points=N)
    np.testing.assert_allclose(found.heights, 1e-2 * np.linspace(x[0], x[-1], N), rtol=1e-12)
    assert found.done[0].startswith("interpolated linearly from uneven positions x, at most ")
    dataset["x"] = ("x", np.where(x[order] == x[3], x[4], x[order]), {"units": "m"})
    dataset.to_netcdf(tmp_path / "p.nc")
    with pytest.raises(ValueError, match=r"the position x = .* twice"):
        read(tmp_path / "p.nc", None, points=N)


def test_positions_along_a_bare_dimension_are_checked(tmp_path):
    dataset = xr.Dataset({"height": ("i", HEIGHTS), "x": ("i", X**2)})
    dataset.to_netcdf(tmp_path / "profile.nc")
    with pytest.raises(ValueError, match="not equidistant"):
        read(tmp_path / "profile.nc")


def test_a_map_with_positions_along_one_direction_is_refused(tmp_path):
    dataset = xr.Dataset({"height": (("y", "x"), np.outer(HEIGHTS[:8], HEIGHTS), {"units": "m"})}, {"x": X})
    dataset.to_netcdf(tmp_path / "map.nc")
    with pytest.raises(ValueError, match="positions along one direction: give them along both"):
        read(tmp_path / "map.nc")


def test_a_dimension_that_the_caller_cannot_use_is_refused(tmp_path):
    np.save(tmp_path / "map.npy", np.outer(HEIGHTS[:8], HEIGHTS))
    record = Measured(method="measured", file=str(tmp_path / "map.npy"))
    assert measured_surface(record, None, 2).heights.shape == (8, N)
    with pytest.raises(ValueError, match="a map of 8 x 64 heights, where dimension: 1 needs a profile"):
        measured_surface(record, None, 1)


def test_a_byte_order_mark_is_no_height(tmp_path):
    for encoding in ("utf-8-sig", "utf-16"):
        (tmp_path / "profile.csv").write_text("1\n2\n3\n4\n", encoding=encoding)
        assert read(tmp_path / "profile.csv", None).heights.tolist() == [1, 2, 3, 4]


@pytest.mark.parametrize("spacing", [0.5, 0.61, 1.3, -12.3])
def test_even_positions_of_few_digits_are_even(tmp_path, spacing):
    heights = np.random.default_rng(0).normal(size=400) * 1e-2
    rows = [f"{1e-3 * (7.0 + spacing * i):.3f}\t{z:.7f}" for i, z in enumerate(heights)]
    (tmp_path / "profile.txt").write_text("x [mm]\tz [um]\n" + "\n".join(rows))
    found = make_surface({"surface": {"method": "measured", "file": str(tmp_path / "profile.txt"), "detrend": "mean"}})
    assert float(found["x"][1]) == pytest.approx(1e-6 * abs(spacing), rel=2e-3)
    expected = 1e-6 * (heights - heights.mean())[:: 1 if spacing > 0.0 else -1]
    np.testing.assert_allclose(found["height"], expected, atol=1e-11)
    assert "rounded to 0.001" in found.attrs["processing"]


def test_missing_positions_are_not_taken_for_rounded_ones(tmp_path):
    rows = [f"{0.01 * i:.2f}\t{z:.5f}" for i, z in enumerate(np.random.default_rng(0).normal(size=400)) if i % 30 != 7]
    (tmp_path / "profile.txt").write_text("x [mm]\tz [um]\n" + "\n".join(rows))
    surface = {"method": "measured", "file": str(tmp_path / "profile.txt")}
    with pytest.raises(InputError, match="fill: interpolate"):
        make_surface({"surface": surface})


def test_a_mark_beyond_all_heights_is_told_how_to_be_written(tmp_path):
    rows = [f"{0.01 * i:.2f}\t{'1.70141e38' if i == 7 else 0.01 * (i % 5)}" for i in range(64)]
    (tmp_path / "profile.txt").write_text("x [mm]\tz [um]\n" + "\n".join(rows))
    with pytest.raises(InputError, match=r"height 1.70141e\+38 at index 7, .*write nan, and fill: interpolate"):
        make_surface({"surface": {"method": "measured", "file": str(tmp_path / "profile.txt")}})
