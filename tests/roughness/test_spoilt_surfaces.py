"""Spoilt files of one profile: each is read right, refused with its place, or told to be implausible."""

import numpy as np
import pytest

from gfmd_numba.roughness.measured import measured_surface
from gfmd_numba.scene.measured_record import FileUnits, Measured

N, LENGTH = 512, 1e-3
X = np.arange(N) / N * LENGTH


def profile():
    """A periodic self-affine profile of an rms gradient of 0.02, in m."""
    waves = np.zeros(N // 2 + 1, dtype=complex)
    k = np.arange(1, 65)
    phases = np.random.default_rng(0).uniform(0, 2 * np.pi, k.size)
    waves[k] = k**-1.3 * np.exp(1j * phases)
    heights = np.fft.irfft(waves, N)
    return heights * 0.02 / np.sqrt((np.diff(heights, append=heights[0]) ** 2).mean()) * LENGTH / N


Z = profile()


def read(path, length=None, **more):
    units = more.pop("units", None)
    record = Measured(method="measured", file=str(path), units=units and FileUnits(**units), **more)
    return measured_surface(record, length)


def columns(folder, x=X, z=Z, header="x [mm], z [um]", scale=(1e3, 1e6), **form):
    table = np.column_stack([scale[0] * x, scale[1] * z])
    np.savetxt(folder / "p.csv", table, header=header, fmt="%.17g", comments="", **({"delimiter": ","} | form))
    return folder / "p.csv"


def one_column(folder, z, header=""):
    np.savetxt(folder / "p.csv", z, header=header, fmt="%.17g", comments="")
    return folder / "p.csv"


def told(found):
    return "\n".join(found.doubts)


def test_the_sound_file_is_read_without_a_doubt(tmp_path):
    found = read(columns(tmp_path))
    np.testing.assert_allclose(found.heights, Z, rtol=1e-14)
    assert (found.unit, found.doubts, found.done) == ("m", (), ())
    assert found.lengths == pytest.approx((LENGTH,), rel=1e-12)
    assert read(columns(tmp_path), LENGTH).doubts == ()


def test_micrometres_taken_for_metres_are_told(tmp_path):
    found = read(one_column(tmp_path, 1e6 * Z), LENGTH, units={"z": "m"})
    assert "an rms gradient of 2" in told(found)
    assert "periods: check the units of the file" in told(found)
    with pytest.raises(ValueError, match=r"heights without a unit, but a length in m"):
        read(tmp_path / "p.csv", LENGTH)
    assert "check the units" in told(read(tmp_path / "p.csv"))  # or for L_x


def test_a_tilt_is_told_and_subtracted(tmp_path):
    file = columns(tmp_path, z=Z + 0.1 * X)
    assert "a tilt makes up" in told(read(file))
    assert "the heights jump by" in told(read(file))
    assert "a tilt makes up" in told(read(file, periodic="mirror"))
    found = read(file, detrend="tilt")
    assert "a tilt" not in told(found)
    assert read(file, detrend="tilt", periodic="mirror").doubts == ()
    np.testing.assert_allclose(found.heights, Z - np.polyval(np.polyfit(X, Z, 1), X), atol=1e-15)


def test_a_seam_is_told_and_mirrored(tmp_path):
    piece = slice(0, 200)
    file = columns(tmp_path, X[piece], Z[piece])
    jump = abs(Z[0] - Z[199])
    assert f"the heights jump by {1e6 * jump:.3g} um where the period along x closes" in told(read(file))
    found = read(file, periodic="mirror")
    assert "closes" not in told(found)
    np.testing.assert_allclose(found.heights, np.concatenate([Z[piece], Z[piece][::-1]]), rtol=1e-14)
    assert found.lengths == pytest.approx((2 * 200 / N * LENGTH,))
    assert "closes" not in told(read(file, periodic="window"))


def test_a_header_is_no_height(tmp_path):
    header = "Profilometer 7\nOperator: (A. B.)\nScan length (mm): 1.0\nx [mm]; z [um]"
    np.testing.assert_allclose(read(columns(tmp_path, header=header, delimiter=";")).heights, Z, rtol=1e-14)


def test_decimal_commas_are_no_columns(tmp_path):
    file = columns(tmp_path, header="x [mm]; z [um]", delimiter=";")
    file.write_text(file.read_text().replace(".", ","))
    found = read(file)
    np.testing.assert_allclose(found.heights, Z, rtol=1e-14)
    assert found.done == ("read commas as decimal commas",)
    file = one_column(tmp_path, 1e6 * Z)
    file.write_text(file.read_text().replace(".", ","))
    np.testing.assert_allclose(read(file, LENGTH, units={"z": "um"}).heights, Z, rtol=1e-14)


def test_a_gap_is_refused_or_filled_and_told(tmp_path):
    gap = np.where((np.arange(N) >= 100) & (np.arange(N) < 110), np.nan, Z)
    file = columns(tmp_path, z=gap)
    for text in (file.read_text(), file.read_text().replace("nan", "")):
        file.write_text(text)
        with pytest.raises(ValueError, match=r"height nan at index 100 and 9 more, .* write fill: interpolate"):
            read(file)
        found = read(file, fill="interpolate")
        expected = np.interp(X, X[~np.isnan(gap)], Z[~np.isnan(gap)])
        np.testing.assert_allclose(found.heights, expected, rtol=1e-12, atol=1e-20)
        assert found.done == ("filled 10 missing heights of 512 (1.95 %) linearly",)
        assert found.doubts == ()


def test_blocks_of_nothing_are_refused_or_told(tmp_path):
    gap = np.where(np.arange(N) % 64 < 9, np.nan, Z)
    file = columns(tmp_path, z=gap)
    with pytest.raises(ValueError, match=r"height nan at index 0 and 71 more"):
        read(file)
    assert "14.1 % of the heights were missing and filled" in told(read(file, fill="interpolate"))
    gap[: N // 2 + 1] = np.nan
    with pytest.raises(ValueError, match=r"of all heights missing, more than 0.5"):
        read(columns(tmp_path, z=gap), fill="interpolate")


def test_rows_that_are_left_out_are_no_equidistant_positions(tmp_path):
    kept = np.delete(np.arange(N), slice(100, 110))
    file = columns(tmp_path, X[kept], Z[kept])
    for points in (None, N):
        with pytest.raises(ValueError, match=r"height nan at index 100 and 9 more, .* fill: interpolate"):
            read(file, points=points)
        filled = read(file, points=points, fill="interpolate")
        assert filled.done[0] == "left 10 heights empty along x, where positions are missing"
        np.testing.assert_allclose(np.delete(filled.heights, slice(100, 110)), Z[kept], rtol=1e-9)
    uneven = X + 0.2 * (X[1] - X[0]) * np.random.default_rng(0).uniform(size=N)
    with pytest.raises(ValueError, match=r"height nan at index \d+ and [89] more"):
        read(columns(tmp_path, uneven[kept], Z[kept]), points=N)
    assert "interpolated linearly from uneven positions" in read(columns(tmp_path, uneven, Z), points=N).done[0]


def test_one_column_needs_a_unit_and_a_period(tmp_path):
    file = one_column(tmp_path, 1e6 * Z, "height (um)")
    np.testing.assert_allclose(read(file, LENGTH).heights, Z, rtol=1e-14)
    with pytest.raises(ValueError, match=r"heights without positions: give spacing"):
        read(file)
    with pytest.raises(ValueError, match=r"no positions along x in the file, so that units.x has to be left out"):
        read(file, LENGTH, units={"x": "mm"})


def test_two_columns_of_mixed_units(tmp_path):
    for header, units in (("", {"x": "mm", "z": "um"}), ("x [mm], z", {"z": "um"}), ("x, z/µm", {"x": "mm"})):
        np.testing.assert_allclose(read(columns(tmp_path, header=header), units=units).heights, Z, rtol=1e-14)
        with pytest.raises(ValueError, match=r"without a unit"):
            read(tmp_path / "p.csv")
    with pytest.raises(ValueError, match=r"positions over a period of 1 m, .* not length = 0.001 m"):
        read(columns(tmp_path, header="x [m], z [um]"), LENGTH)


def test_descending_positions_are_turned_round(tmp_path):
    found = read(columns(tmp_path, X[::-1], Z[::-1]))
    np.testing.assert_allclose(found.heights, Z, rtol=1e-14)
    assert found.done == ("turned round along x, as its positions descend",)
    order = np.random.default_rng(0).permutation(N)
    with pytest.raises(ValueError, match=r"positions x that are in no order"):
        read(columns(tmp_path, X[order], Z[order]))


@pytest.mark.parametrize("where", [1, 100, N - 2])
def test_a_spike_of_a_hundred_rms_heights_is_told(tmp_path, where):
    spoilt = Z.copy()
    spoilt[where] += 100 * Z.std()
    for periodic in ("none", "mirror", "window"):
        found = read(columns(tmp_path, z=spoilt), periodic=periodic)
        assert f"a spike at index {where}: despike: true" in told(found)


def test_a_long_spoilt_file_gives_what_numpy_gives_by_hand(tmp_path):
    n = 10_000
    x = np.arange(n) * 0.25e-3  # mm
    heights = np.cumsum(np.random.default_rng(0).normal(size=n)) * 1e-2 + 3.0 * x + 7.0  # um
    gap = slice(4000, 4120)
    lines = [f"{a:.17g};{z:.17g}" for a, z in zip(x, heights, strict=True)]
    lines[gap] = [f"{a:.17g};" for a in x[gap]]
    (tmp_path / "p.csv").write_text("Profile 3\nx [mm];z [um]\n" + "\n".join(lines).replace(".", ","))
    found = read(tmp_path / "p.csv", fill="interpolate", detrend="tilt", periodic="mirror")

    kept = np.delete(np.arange(n), gap)
    filled = np.interp(np.arange(n), kept, heights[kept])
    level = filled - np.polynomial.Polynomial.fit(x, filled, 1)(x)
    by_hand = 1e-6 * np.concatenate([level, level[::-1]])
    np.testing.assert_allclose(found.heights, by_hand, rtol=0, atol=1e-12 * np.ptp(by_hand))
    assert found.lengths == pytest.approx((2 * n * 0.25e-6,), rel=1e-12)
    assert [sentence.split()[0] for sentence in found.done] == ["read", "filled", "subtracted", "mirrored"]
