"""Measured fields: readers and what makes a field periodic."""

import builtins

import numpy as np
import pytest

from gfmd_numba.roughness.measurements import measurement
from gfmd_numba.roughness.processing import detrended, made_periodic, mirrored, windowed
from gfmd_numba.roughness.surface_files import read_content


def test_arrays_and_tables_are_read_alike(tmp_path):
    heights = np.random.default_rng(0).normal(size=(5, 7))
    np.save(tmp_path / "map.npy", heights)
    np.savetxt(tmp_path / "map.csv", heights, delimiter=",", fmt="%.17g")
    for name in ("map.npy", "map.csv"):
        found = measurement(read_content(tmp_path / name))
        np.testing.assert_array_equal(found.heights, heights)
        assert found.lengths is None
    np.savetxt(
        tmp_path / "line.csv",
        np.column_stack([0.5 * np.arange(7), heights[0]]),
        delimiter=",",
        header="x [m], z [m]",
        fmt="%.17g",
    )
    found = measurement(read_content(tmp_path / "line.csv"))
    np.testing.assert_array_equal(found.heights, heights[0])
    assert found.lengths == pytest.approx((3.5,))


def test_a_format_of_an_instrument_is_read_with_its_units(tmp_path):
    topography = pytest.importorskip("SurfaceTopography")
    heights = np.random.default_rng(0).normal(size=(6, 8))
    topography.Topography(heights.T, (4.0, 3.0), unit="um").to_netcdf(str(tmp_path / "map.x"))
    found = measurement(read_content(tmp_path / "map.x"))
    np.testing.assert_allclose(found.heights, 1e-6 * heights)
    assert found.lengths == pytest.approx((3e-6, 4e-6))
    (tmp_path / "junk.xyzzy").write_bytes(b"\0\1\2")
    with pytest.raises(ValueError, match="no format that SurfaceTopography knows"):
        measurement(read_content(tmp_path / "junk.xyzzy"))


def test_a_format_of_an_instrument_without_its_reader_says_what_to_install(tmp_path, monkeypatch):
    load = builtins.__import__

    def without(name, *arguments):
        if name.startswith("SurfaceTopography"):
            raise ImportError
        return load(name, *arguments)

    (tmp_path / "map.opd").touch()
    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ValueError, match=r"SurfaceTopography, which `pip install 'gfmd-numba\[instruments\]'` adds"):
        measurement(read_content(tmp_path / "map.opd"))


@pytest.mark.parametrize("detrend", ["none", "mean", "tilt", "curvature"])
def test_detrending_removes_exactly_the_polynomial(detrend):
    y, x = np.mgrid[:9, :12].astype(float)
    trends = {"none": 0.0 * x, "mean": 3.0 + 0 * x, "tilt": 3 + x - 2 * y, "curvature": 3 + x - y + x * y + x**2 - y**2}
    found, done = detrended(trends[detrend], detrend)
    np.testing.assert_allclose(found, 0.0, atol=1e-11)
    assert len(done) == (detrend != "none")
    rest, _ = detrended(trends["curvature"], "tilt")
    assert abs((rest * x).sum()) < 1e-9  # what is left is orthogonal to what was fitted
    assert rest.std() > 1.0


def test_mirrored_fields_are_even_and_have_no_jump():
    heights = np.random.default_rng(0).normal(size=(4, 6))
    found = mirrored(heights)
    assert found.shape == (8, 12)
    np.testing.assert_array_equal(found[:4, :6], heights)
    np.testing.assert_array_equal(found, found[::-1])
    np.testing.assert_array_equal(found, found[:, ::-1])
    assert made_periodic(heights, (2.0, 3.0), "mirror").lengths == (4.0, 6.0)


def test_windowed_fields_fade_at_their_ends_and_keep_their_mean_square():
    heights = np.random.default_rng(0).normal(size=(64, 80)) + 5.0
    found = windowed(heights)
    assert found.std() == pytest.approx(heights.std())
    assert found.mean() == pytest.approx(0.0, abs=1e-14)
    assert abs(found[0] - found[0].mean()).max() < 0.02
    assert abs(found[:, 0] - found[:, 0].mean()).max() < 0.02
    np.testing.assert_array_equal(windowed(np.ones(8)), 0.0)


def test_resampling_keeps_the_aspect_of_a_map_and_says_so():
    heights = np.random.default_rng(0).normal(size=(6, 12))
    found = made_periodic(heights, (1.0, 2.0), points=24)
    assert found.heights.shape == (12, 24)
    np.testing.assert_allclose(found.heights[::2, ::2], heights, atol=1e-12)
    assert found.done == ("resampled from 6 x 12 to 12 x 24 points by its Fourier series",)
    with pytest.raises(ValueError, match="2 x 4 points after resampling"):
        made_periodic(heights, (1.0, 2.0), points=4)
