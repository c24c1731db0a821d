"""Gaps, short waves and instruments' files of measured surfaces."""

import warnings
from pathlib import Path

import numpy as np
import pint
import pytest

import gfmd_numba
from gfmd_numba import make_surface, solve
from gfmd_numba.roughness.measured import measured_surface
from gfmd_numba.roughness.measurements import measurement
from gfmd_numba.roughness.processing import detrended, fill_gaps, made_periodic
from gfmd_numba.roughness.surface_files import read_content
from gfmd_numba.scene import InputError
from gfmd_numba.scene.measured_record import FileUnits, Measured
from support.command_line import gfmd


def test_gaps_of_profiles_are_linear_and_level_at_the_ends():
    nan = np.nan
    filled, done = fill_gaps(np.array([nan, 1.0, nan, nan, 4.0, 2.0, 3.0, nan]), "interpolate")
    np.testing.assert_allclose(filled, [1, 1, 2, 3, 4, 2, 3, 3], rtol=1e-15)
    assert done == ("filled 4 missing heights of 8 (50 %) linearly",)


def test_holes_of_maps_are_harmonic():
    """A harmonic polynomial of the grid, 4-point Laplacian 0, comes back; at an edge the normal derivative is none."""
    y, x = np.mgrid[:30, :40].astype(float)
    heights = x**2 - y**2 + 0.5 * x * y + 3 * x
    spoilt = heights.copy()
    spoilt[5:12, 7:20] = spoilt[20, 30] = np.nan
    filled, (done,) = fill_gaps(spoilt, "interpolate")
    np.testing.assert_allclose(filled, heights, atol=1e-9)
    assert done.startswith("filled 92 missing heights of 1200")
    level = np.where(x < 3, np.nan, 2.0)
    np.testing.assert_allclose(fill_gaps(level, "interpolate")[0], 2.0, rtol=1e-12)
    even = np.where((y > 10) & (y < 20) & (x < 5), np.nan, 3.0 * y)
    np.testing.assert_allclose(fill_gaps(even, "interpolate")[0], 3.0 * y, rtol=1e-9)


def test_heights_without_gaps_are_left_alone():
    heights = np.arange(8.0)
    assert fill_gaps(heights, "refuse") == (heights, ())


@pytest.mark.parametrize("shape", [(64,), (63,), (16, 32), (15, 21)])
def test_a_cutoff_leaves_exactly_the_longer_waves(shape):
    rng = np.random.default_rng(0)
    lengths = tuple(0.5 + i for i in range(len(shape)))
    places = np.meshgrid(*[np.arange(n) / n for n in shape], indexing="ij")
    long, short = np.zeros(shape), np.zeros(shape)
    for _ in range(40):
        k = [int(rng.integers(-(n // 2) + 1, n // 2)) for n in shape]
        if not any(k):
            continue
        wave = np.cos(2 * np.pi * sum(i * place for i, place in zip(k, places, strict=True)) + rng.uniform(0, 6))
        wavelength = 1 / np.hypot.reduce([i / length for i, length in zip(k, lengths, strict=True)])
        if wavelength >= 0.2:
            long += wave
        else:
            short += wave
    assert long.any()
    assert short.any()
    found = made_periodic(long + short + 3.0, lengths, cutoff=0.2)
    np.testing.assert_allclose(found.heights, long + 3.0, atol=1e-12)
    assert found.done == ("left out all waves shorter than 0.2 of its Fourier series",)


def test_a_cutoff_without_effect_or_survivors_is_an_error(tmp_path):
    heights = np.random.default_rng(0).normal(size=32)
    for cutoff, said in ((1 / 16, "no wave shorter than cutoff = 0.0625"), (1.5, "no wave as long as cutoff = 1.5")):
        with pytest.raises(ValueError, match=said):
            made_periodic(heights, (1.0,), cutoff=cutoff)
    np.save(tmp_path / "p.npy", 1e-3 * heights)
    with pytest.raises(InputError, match=r"no wave shorter than cutoff = 0\.01"):
        make_surface({"surface": {"method": "measured", "file": str(tmp_path / "p.npy"), "cutoff": 0.01}})


def test_a_wavelength_is_kept_at_the_cutoff_itself():
    """cos(2 pi 5 x / L) with L = 0.3: 2 pi / (2 pi 5 / 0.3) rounds to either side of 0.06."""
    for length, k in ((0.3, 5), (0.7, 3), (1e-4, 7)):
        wave = np.cos(2 * np.pi * k * np.arange(64) / 64)
        np.testing.assert_allclose(made_periodic(wave, (length,), cutoff=length / k).heights, wave, atol=1e-14)


HEIGHTS = np.random.default_rng(0).normal(size=(6, 8))  # [y, x], in um


@pytest.mark.parametrize("writer", ["gwy", "x3p", "netcdf"])
def test_files_of_instruments_have_their_own_sizes_and_units(tmp_path, writer):
    """Gwyddion's, ISO 25178-72 and its own, written by the writers of SurfaceTopography."""
    library = pytest.importorskip("SurfaceTopography")
    topography = library.Topography(HEIGHTS.T, (4.0, 3.0), unit="um")
    name = f"map.{writer}"
    getattr(topography, f"to_{writer}")(str(tmp_path / name))
    found = measured_surface(Measured(method="measured", file=str(tmp_path / name), periodic="mirror"), 8e-6)
    np.testing.assert_allclose(found.heights[:6, :8], 1e-6 * HEIGHTS, rtol=1e-6)
    assert found.lengths == pytest.approx((6e-6, 8e-6))
    assert found.unit == "m"
    with pytest.raises(ValueError, match=r"heights in u?m as the file says, not nm"):
        measurement(read_content(tmp_path / name), {"z": "nm"})


def test_an_instrument_that_states_no_unit_needs_them(tmp_path):
    library = pytest.importorskip("SurfaceTopography")
    library.Topography(HEIGHTS.T, (4.0, 3.0)).to_netcdf(str(tmp_path / "map.topo"))
    with pytest.raises(ValueError, match=r"without a unit: write units: \{x: mm, y: mm, z: um\}"):
        measurement(read_content(tmp_path / "map.topo"))
    found = measurement(read_content(tmp_path / "map.topo"), {"x": "mm", "y": "mm", "z": "um"})
    np.testing.assert_allclose(found.heights, 1e-6 * HEIGHTS)
    assert found.lengths == pytest.approx((3e-3, 4e-3))


@pytest.mark.parametrize(
    ("given", "name"), [("µm", "um"), ("μm", "um"), ("micron", "um"), ("Å", "angstrom"), ("inch", "in"), ("µin", "uin")]
)
def test_a_unit_has_several_spellings(given, name):
    assert FileUnits(z=given).z == name


def test_an_unknown_unit_is_told_with_its_place(tmp_path):
    np.save(tmp_path / "p.npy", HEIGHTS)
    (tmp_path / "s.yaml").write_text("surface: {method: measured, file: p.npy, units: {z: furlong}}\n")
    done = gfmd("check", tmp_path / "s.yaml")
    assert done.exit_code == 2
    assert "s.yaml:1:53: surface.units.z: you gave 'furlong'; gfmd allows a unit of length: m, km, dm," in done.output


@pytest.mark.usefixtures("undrawn")
def test_doubts_stay_in_the_result_and_are_said(tmp_path):
    np.save(tmp_path / "p.npy", 1e-3 * np.random.default_rng(0).normal(size=64) + np.arange(64) / 640)
    (tmp_path / "s.yaml").write_text("surface: {method: measured, file: p.npy}\n")
    done = gfmd("surface", tmp_path / "s.yaml", "-o", tmp_path / "s.nc")
    assert done.exit_code == 0
    assert "gfmd: a tilt makes up" in done.stderr
    with warnings.catch_warnings(record=True, action="always") as warned:
        found = make_surface(tmp_path / "s.yaml")
    assert found.attrs["validity"].splitlines() == [str(each.message) for each in warned]
    assert len(warned) == 2
    (tmp_path / "s.yaml").write_text("surface: {method: measured, file: p.npy, detrend: tilt, periodic: mirror}\n")
    assert make_surface(tmp_path / "s.yaml").attrs["validity"] == ""


def test_the_example_of_the_page_does_what_the_page_says(tmp_path):
    page = (Path(gfmd_numba.__file__).parents[1] / "docs" / "surfaces.md").read_text(encoding="utf-8")
    example = page.partition("## Measured surfaces")[2].partition("```yaml\n")[2].partition("```")[0]
    (tmp_path / "s.yaml").write_text(example)
    rough = np.convolve(np.random.default_rng(0).normal(size=1050), np.hanning(51), "valid")[:1000]
    rough[100:110] = np.nan
    np.savetxt(tmp_path / "steel.csv", np.column_stack([np.arange(1000) * 1e-3, 0.05 * rough]), delimiter=",")
    found = make_surface(tmp_path / "s.yaml")
    assert found.attrs["validity"] == ""
    done = [sentence.split()[0] for sentence in found.attrs["processing"].splitlines()]
    assert done == ["filled", "found", "subtracted", "mirrored", "left", "resampled"]
    assert found.sizes == {**found.sizes, "x": 4096}
    assert float(found["x"][1]) == pytest.approx(2e-3 / 4096)


@pytest.mark.parametrize(("nodes", "groove", "warned"), [(2, False, True), (4, False, False), (8, True, True)])
def test_points_added_where_a_fourier_series_rings_are_told(nodes, groove, warned):
    """Edges of a groove ring, and so does what has waves of two nodes; a cutoff ends both."""
    q, rng = np.arange(129), np.random.default_rng(1)
    waves = np.where((q > 0) & (q <= 256 // nodes), np.maximum(q, 1.0) ** -1.3, 0.0)
    heights = 1e-4 * np.fft.irfft(waves * np.exp(2j * np.pi * rng.random(129)), 256)
    heights[60:90] -= groove * 1e-6
    record = {"method": "measured", "heights": heights, "units": {"z": "m"}, "spacing": "1 um", "points": 1024}
    for cutoff, told in ({}, warned), ({"cutoff": "4 um"}, False):
        if cutoff and not warned:
            continue
        surface = measured_surface(Measured.model_validate(record | cutoff), None)
        assert any("Fourier series, which rings" in doubt for doubt in surface.doubts) == told


def test_a_way_there_and_back_is_told(tmp_path):
    rows = [f"{i},{i % 7}" for i in (*range(40), *range(39, -1, -1))]
    (tmp_path / "p.csv").write_text("x [um],z [um]\n" + "\n".join(rows))
    with pytest.raises(InputError, match="in no order from index 39 on, and some twice: keep one pass"):
        make_surface({"surface": {"method": "measured", "file": str(tmp_path / "p.csv")}})


def test_points_that_lose_gradient_are_told():
    heights = np.random.default_rng(0).normal(size=256)
    surface = {"method": "measured", "heights": heights, "units": {"z": "um"}, "spacing": "10 um"}
    with pytest.warns(UserWarning, match=r"64 points leave out \d\d\.\d % of the rms gradient that 256 points have"):
        make_surface({"surface": surface | {"points": 64}})
    smooth = surface | {"heights": np.sin(2.0 * np.pi * np.arange(256) / 64)}
    make_surface({"surface": smooth | {"points": 64}})
    make_surface({"surface": smooth | {"points": 512}})


def test_a_form_without_roughness_is_refused_in_scenes_too():
    x = np.linspace(-1.0, 1.0, 512)
    rough = {"method": "measured", "heights": x**2, "spacing": "1 um", "units": {"z": "um"}, "detrend": "curvature"}
    body = {"youngs_modulus": "70 GPa", "poissons_ratio": 0.3}
    scene = {"body": body, "roughness": rough, "interface": {"hard_wall": {}}, "loading": {"pressure": "1 MPa"}}
    for run, file in ((make_surface, {"surface": rough}), (solve, {"scene": scene})):
        with pytest.raises(InputError, match="a flat surface once the trend is gone"):
            run(file)


def test_heights_keep_the_units_of_their_library_and_enough_digits():
    registry = pint.UnitRegistry()
    heights = np.random.default_rng(0).normal(size=64)
    surface = {"method": "measured", "spacing": "10 um"}
    plain = make_surface({"surface": surface | {"heights": heights, "units": {"z": "um"}}})
    given = make_surface({"surface": surface | {"heights": heights * registry.um}})
    np.testing.assert_array_equal(given["height"], plain["height"])
    half = make_surface({"surface": surface | {"heights": heights, "units": {"z": "0.5 um"}}})
    np.testing.assert_allclose(half["height"], 0.5 * plain["height"])
    row = make_surface({"surface": surface | {"heights": heights[None], "units": {"z": "um"}}})
    np.testing.assert_array_equal(row["height"], plain["height"])
    for wrong, said in (
        (surface | {"heights": heights * registry.um, "units": {"z": "m"}}, "heights in um as the file says, not m"),
        (surface | {"heights": heights * registry.volt}, "heights in 'volt', which is no unit of length"),
        (surface | {"heights": [each * registry.um for each in heights]}, "a list of at least 4 numbers"),
        (surface | {"heights": heights.astype(np.float16), "units": {"z": "um"}}, "heights of type float16"),
    ):
        with pytest.raises(InputError, match=said):
            make_surface({"surface": wrong})


def test_tilt_and_curvature_are_told_apart():
    """A tilt of 97 % is no bow: heights of a line and a parabola, whose shares follow from their variances."""
    x = np.linspace(-1.0, 1.0, 2001)
    heights = 3.0 * x + 0.5 * x**2  # variances 9/3 and 0.25 * 4/45
    left, (told,) = detrended(heights, "curvature")
    assert abs(left).max() < 1e-12
    parabola = 0.25 * 4.0 / 45.0 / (3.0 + 0.25 * 4.0 / 45.0)
    assert told == (
        f"subtracted the tilt, {1.0 - parabola:.2g} of the mean square height and "
        f"the curvature, {parabola:.2g} of the mean square height"
    )
