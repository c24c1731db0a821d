"""Maps of instruments that are no squares, and maps of three columns."""

import re

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.roughness.measured import measured_surface
from gfmd_numba.scene.measured_record import Measured

UNITS = {"x": "mm", "y": "mm", "z": "um"}


def wave(x, y):
    """Heights in m at positions in m."""
    return 1e-6 * (np.cos(2e3 * np.pi * x) + 0.5 * np.sin(4e3 * np.pi * y))


def written(folder, nx, ny, dx, dy):
    """netCDF of a map whose positions are in m."""
    x, y = np.arange(nx) * dx, np.arange(ny) * dy
    height = xr.DataArray(wave(x, y[:, None]), dims=("y", "x"), attrs={"units": "m"}, name="height")
    coordinates = {name: (name, each, {"units": "m"}) for name, each in (("x", x), ("y", y))}
    height.to_dataset().assign_coords(coordinates).to_netcdf(folder / "map.nc")
    return folder / "map.nc"


def read(path, **more):
    return measured_surface(Measured(method="measured", file=str(path), **more), None)


def test_the_middle_of_a_rectangle_is_cut_out(tmp_path):
    path = written(tmp_path, nx=48, ny=40, dx=1e-4 / 8, dy=1e-4 / 8)
    found, whole = read(path, crop="square"), read(path)
    np.testing.assert_array_equal(found.heights, whole.heights[:, 4:44])
    assert found.lengths == pytest.approx((5e-4, 5e-4))
    assert found.done == ("cut out the middle 40 x 40 of 40 x 48 points, a square",)


def test_a_square_is_left_as_it_is(tmp_path):
    path = written(tmp_path, nx=32, ny=32, dx=1e-5, dy=1e-5)
    assert read(path, crop="square").done == ()


def test_unequal_spacings_are_resampled_to_the_same_surface(tmp_path):
    path = written(tmp_path, nx=70, ny=160, dx=1e-3 / 64, dy=1e-3 / 128)
    found = read(path, crop="square", points=64)
    assert found.heights.shape == (64, 64)
    assert found.lengths == pytest.approx((70e-3 / 64, 70e-3 / 64))
    whole = read(written(tmp_path, nx=64, ny=200, dx=1e-3 / 64, dy=1e-3 / 128), crop="square", points=32)
    assert whole.lengths == pytest.approx((1e-3, 1e-3))
    x = np.arange(32) * 1e-3 / 32  # a whole period, which begins at the 36th row
    np.testing.assert_allclose(whole.heights, wave(x, x[:, None] + 36e-3 / 128), atol=1e-18)


def test_a_stretch_is_stated(tmp_path):
    path = written(tmp_path, nx=10, ny=40, dx=1e-4, dy=0.37e-4)
    found = read(path, crop="square")
    assert found.heights.shape == (27, 10)
    assert found.lengths == pytest.approx((1e-3, 1e-3))
    assert "a square once stretched by 0.1 %" in found.done[0]


@pytest.mark.filterwarnings("ignore:periodic. window fades")
def test_a_rectangle_in_a_scene_names_the_remedy(tmp_path):
    scene = {
        "roughness": {
            "method": "measured",
            "file": str(written(tmp_path, 48, 160, 1e-5, 1e-5 / 3)),
            "detrend": "tilt",
            "periodic": "window",
        },
        "body": {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": "10 MPa"},
    }
    with pytest.raises(gfmd_numba.InputError, match="crop: square cuts one out"):
        gfmd_numba.solve({"scene": scene})
    scene["roughness"]["crop"] = "square"
    with pytest.raises(gfmd_numba.InputError, match="points: 144 resamples it"):
        gfmd_numba.solve({"scene": scene})
    scene["roughness"]["points"] = 64
    assert gfmd_numba.solve({"scene": scene}).status.item() == 0


def test_a_profile_has_no_square(tmp_path):
    np.save(tmp_path / "p.npy", np.arange(8.0))
    with pytest.raises(ValueError, match="leave crop out"):
        read(tmp_path / "p.npy", crop="square")


@pytest.mark.parametrize("order", ["xy", "yx", "any"])
def test_rows_of_three_columns_are_points_of_a_map(tmp_path, order):
    x, y = np.meshgrid(np.arange(6) * 0.25, np.arange(5) * 0.25)
    points = np.stack([x.ravel(), y.ravel(), 1e6 * wave(1e-3 * x, 1e-3 * y).ravel()], 1)
    rows = {"xy": np.arange(30), "yx": np.arange(30).reshape(5, 6).T.ravel()}.get(
        order, np.random.default_rng(1).permutation(30)
    )
    np.savetxt(tmp_path / "m.txt", points[rows], header="x [mm] y [mm] z [um]")
    found = read(tmp_path / "m.txt")
    np.testing.assert_allclose(found.heights, wave(1e-3 * x, 1e-3 * y), atol=1e-18)
    assert found.lengths == pytest.approx((1.25e-3, 1.5e-3))
    np.savetxt(tmp_path / "n.txt", points[rows])
    np.testing.assert_array_equal(read(tmp_path / "n.txt", units=UNITS).heights, found.heights)


def test_points_left_out_are_missing_heights(tmp_path):
    x, y = np.meshgrid(np.arange(6), np.arange(5))
    points = np.stack([x.ravel(), y.ravel(), (x + 10.0 * y).ravel()], 1)
    np.savetxt(tmp_path / "m.txt", np.delete(points, 14, axis=0))
    with pytest.raises(ValueError, match="height nan at index 2, 2"):
        read(tmp_path / "m.txt", units=UNITS)
    filled = read(tmp_path / "m.txt", units=UNITS, fill="interpolate")
    np.testing.assert_allclose(filled.heights, 1e-6 * (x + 10.0 * y))


def test_points_along_a_line_are_a_profile(tmp_path):
    np.savetxt(tmp_path / "p.txt", np.stack([np.full(8, 3.0), np.arange(8), np.arange(8) ** 2], 1))
    found = read(tmp_path / "p.txt", units={"y": "mm", "z": "um"})
    np.testing.assert_allclose(found.heights, 1e-6 * np.arange(8.0) ** 2)
    assert found.lengths == pytest.approx((8e-3,))


@pytest.mark.parametrize(
    ("points", "problem"),
    [
        (np.random.default_rng(0).random((40, 3)), "40 points of three columns x, y and z at 40 different x"),
        ([[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 0, 2]], "the point x = 1, y = 0 twice, again in row 4"),
        ([[0, 0, 1], [1, np.nan, 1], [0, 1, 1]], "a point without a finite x and y in row 2"),
    ],
)
def test_points_on_no_grid_are_refused(tmp_path, points, problem):
    np.savetxt(tmp_path / "m.txt", points)
    with pytest.raises(ValueError, match=problem):
        read(tmp_path / "m.txt", units=UNITS)


@pytest.mark.parametrize("points", [None, 16])
def test_uneven_maps_are_to_be_made_even_first(tmp_path, points):
    x, y = np.meshgrid(np.arange(6) ** 1.1, np.arange(5))
    np.savetxt(tmp_path / "m.txt", np.stack([x.ravel(), y.ravel(), np.arange(30)], 1))
    with pytest.raises(ValueError, match="not equidistant; interpolate the map to a regular grid"):
        read(tmp_path / "m.txt", units=UNITS, points=points)


def test_a_period_of_many_metres_is_doubted(tmp_path):
    found = read(written(tmp_path, nx=16, ny=16, dx=1.0, dy=1.0))
    assert any("a period of 16 m: check the units" in doubt for doubt in found.doubts)


def test_a_contact_of_a_faded_surface_is_warned_of():
    heights = np.random.default_rng(0).normal(size=32)
    surface = {"method": "measured", "heights": 1e-3 * heights, "units": {"z": "L_x"}, "periodic": "window"}
    scene = {"roughness": surface, "body": {"poissons_ratio": 0.3}, "interface": {"hard_wall": {}}}
    with pytest.warns(UserWarning, match="periodic: window fades"):
        gfmd_numba.solve({"scene": scene | {"loading": {"reduced_pressure": 0.1}}})


@pytest.mark.parametrize(("nx", "ny"), [(16, 128), (128, 16)])
def test_points_that_leave_out_waves_along_one_axis_alone_are_doubted(tmp_path, nx, ny):
    x, y = (np.arange(n) * 64e-6 / n for n in (nx, ny))
    heights = 1e-8 * np.random.default_rng(0).normal(size=(ny, nx))
    positions = {"x": ("x", x, {"units": "m"}), "y": ("y", y, {"units": "m"})}
    xr.DataArray(heights, positions, ("y", "x"), "height", {"units": "m"}).to_netcdf(tmp_path / "map.nc")
    for points in (16, 24, 64):
        told = rf"{points} x {points} points leave out \d\d(\.\d)? % of the rms gradient that {ny} x {nx} points have"
        assert re.search(told, "\n".join(read(tmp_path / "map.nc", points=points).doubts))
