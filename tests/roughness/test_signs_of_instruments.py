"""Spoilt measurements are told by their cause, and what despike does."""

import re

import numpy as np
import pytest

from gfmd_numba.roughness.form import form
from gfmd_numba.roughness.measured import measured_field, measured_surface, periodic_surface
from gfmd_numba.scene.measured_record import FileUnits, Measured

N, LENGTH = 2048, 4e-3
X = np.arange(N) / N * LENGTH


def rough(shape, seed=0, hurst=0.7, gradient=0.03):
    """A piece of a periodic self-affine surface with a roll-off, with this rms gradient on points 2 um apart."""
    frequencies = np.sqrt(sum(np.square(each) for each in np.meshgrid(*map(np.fft.fftfreq, shape), indexing="ij")))
    amplitude = np.where(frequencies > 0, np.maximum(frequencies, 0.02), np.inf) ** (-hurst - len(shape) / 2)
    amplitude[frequencies > 0.2] = 0.0
    noise = np.random.default_rng(seed).normal(size=shape)
    heights = np.fft.ifftn(np.fft.fftn(noise) * amplitude).real
    steps = np.sqrt(sum((np.diff(heights, axis=axis) ** 2).mean() for axis in range(len(shape))))
    return heights * gradient * LENGTH / N / steps


def read(z, **more):
    """Surface of heights in m on points 2 um apart, given in um and mm."""
    import xarray as xr

    dims = ("y", "x")[-z.ndim :]
    positions = {
        dim: (dim, 1e3 * LENGTH / N * np.arange(n), {"units": "mm"}) for dim, n in zip(dims, z.shape, strict=True)
    }
    heights = xr.DataArray(1e6 * z, dims=dims, coords=positions, attrs={"units": "um"})
    more.setdefault("periodic", "mirror")
    return measured_surface(Measured(method="measured", heights=heights, **more), None)


def told(z, **more):
    return "\n".join(read(z, **more).doubts)


def waves_of_a_quarter(shape):
    """A field of a rough surface whose longest waves are a quarter of it."""
    longer = tuple(3 * n for n in shape)
    q = np.sqrt(sum(k**2 for k in np.meshgrid(*[np.fft.fftfreq(n, 1 / n) for n in longer], indexing="ij")))
    amplitude = np.where(q > 11, np.maximum(q, 1.0) ** -(0.8 + len(shape) / 2), 0.0)
    noise = np.fft.fftn(np.random.default_rng(5).normal(size=longer))
    z = np.fft.ifftn(noise * amplitude).real[tuple(slice(0, n) for n in shape)]
    return 2e-7 * z / z.std()


def waves_in_a_period():
    q = np.fft.rfftfreq(N, 1 / N)
    waves = np.exp(2j * np.pi * np.random.default_rng(7).random(q.size)) * np.maximum(q, 4.0) ** -1.3 * (q > 0)
    z = np.fft.irfft(waves, N)
    return 2e-7 * z / z.std()


def test_a_measurement_that_is_not_spoilt_has_no_signs():
    assert read(rough((N,)), detrend="tilt").doubts == ()
    assert read(rough((128, 128)), detrend="tilt").doubts == ()


@pytest.mark.parametrize(("radius", "said"), [(50e-3, "50 mm (convex)"), (-10e-3, "10 mm (concave)")])
def test_the_form_of_a_cylinder_is_told_with_its_radius_and_share(radius, said):
    z, form = rough((N,)), -((X - LENGTH / 2) ** 2) / 2 / radius
    level, left = (z + form - np.polynomial.Polynomial.fit(X, z + form, order)(X) for order in (1, 2))
    share = np.floor(1e4 * (1 - left.var() / level.var())) / 100
    sentence = told(z + form, detrend="tilt")
    assert f"a curvature of radius {said} makes up {share:.4g} %" in sentence
    assert "detrend: curvature" in sentence
    assert "units" not in sentence
    assert read(z + form, detrend="curvature").doubts == ()


def test_a_map_has_a_cylinder_of_one_radius_a_ball_or_two_radii():
    z, x = rough((128, 128)), (np.arange(128) - 64) * LENGTH / N
    across = np.add.outer(x, x) / np.sqrt(2)
    assert "a curvature of radius 0.1 mm (convex) makes up" in told(z - across**2 / 2e-4)
    assert "a curvature of radius 0.1 mm (concave) makes up" in told(z + across**2 / 2e-4)
    saddle = told(z - np.add.outer(x**2 / 2e-4, -(x**2) / 4e-4))
    radii = re.search(r"of radius (.*) mm \(convex\) and (.*) mm \(concave\) makes up", saddle).groups()
    assert [float(radius) for radius in radii] == pytest.approx([0.1, 0.2], rel=0.01)


@pytest.mark.parametrize("shape", [(N,), (128, 128)])
@pytest.mark.parametrize("radius", [np.inf, 5e-3])
def test_all_spikes_are_counted_despite_a_form_and_replaced(shape, radius):
    z, x = rough(shape), (np.arange(shape[-1]) - shape[-1] / 2) * LENGTH / N
    z = z - x**2 / 2 / radius
    rng = np.random.default_rng(1)
    at = 7 + 13 * rng.choice(z.size // 13 - 1, 25, replace=False)
    spoilt = z.copy()
    spoilt.flat[at] += rng.choice([-1, 1], 25) * 20 * rough(shape).std()
    sentences = told(spoilt).splitlines()
    spikes = [i for i, each in enumerate(sentences) if each.startswith("25 heights in spikes, the first at index")]
    assert len(spikes) == 1
    assert not any("units" in each for each in sentences)
    cured = read(spoilt, despike=True)
    assert "spike" not in "\n".join(cured.doubts)
    first = ", ".join(map(str, np.unravel_index(min(at), shape)))
    how = "linearly" if len(shape) == 1 else "by a harmonic function"
    assert f"interpolated 25 heights in spikes {how}, of {z.size}, at index {first}" in cured.done[0]
    mended = read(spoilt, despike=True, periodic="none").heights
    np.testing.assert_allclose(np.delete(mended, at), np.delete(z, at), rtol=1e-15)
    steps = [abs(mended - np.roll(mended, k, axis)) for axis in range(len(shape)) for k in (1, -1)]
    usual = np.median(steps[0])
    assert max(np.min(steps, axis=0).flat[at]) < 4 * usual  # none sticks out of its neighbours
    assert abs(mended - z).max() < 0.5 * rough(shape).std()


@pytest.mark.parametrize("shape", [(N,), (96, 96)])
@pytest.mark.parametrize("share", [0.35, 0.6, 0.85, 0.92])
def test_a_tilt_is_told_wherever_the_ends_are_apart(shape, share):
    z = waves_of_a_quarter(shape)
    tilt = np.linspace(-1.0, 1.0, shape[-1]) * np.ones(shape)
    tilted = z + tilt * z.std() / tilt.std() * np.sqrt(share / (1 - share))
    for periodic in ("mirror", "none"):
        assert "a tilt makes up" in told(tilted, periodic=periodic)
        assert "a tilt" not in told(z, periodic=periodic)


@pytest.mark.parametrize("shape", [(N,), (96, 96)])
@pytest.mark.parametrize("share", [0.6, 0.85, 0.92])
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_bow_is_told_in_a_field_that_is_mirrored(shape, share, sign):
    z, x = waves_of_a_quarter(shape), np.linspace(-1.0, 1.0, shape[-1])
    bow = sign * (x**2 - (x**2).mean()) * np.ones(shape)
    assert "a curvature of radius" in told(z + bow * z.std() / bow.std() * np.sqrt(share / (1 - share)))
    assert "a curvature" not in told(z)


@pytest.mark.parametrize("cutoff", [None, 8e-6, 20e-6])
def test_a_cutoff_does_not_hide_where_the_ends_of_a_period_are_apart(cutoff):
    z = waves_of_a_quarter((N,))
    z += 8 * z.std() * (X > 0.9 * LENGTH) * (X / LENGTH - 0.9) * 10  # a tilt of the last tenth alone
    assert "where the period along x closes" in told(z, periodic="none", cutoff=cutoff)
    assert "where the period along x closes" not in told(waves_in_a_period(), periodic="none", cutoff=cutoff)


@pytest.mark.parametrize("shape", [(N,), (128, 128)])
def test_a_cutoff_of_which_the_field_has_few_waves_is_told(shape):
    """As lambda_c is taken for the cutoff: an evaluation length has five of it (ISO 4288)."""
    z, field = rough(shape), LENGTH / N * shape[-1]
    assert "only 5 waves as long as the cutoff fit into the field, so that waviness alone is left" in told(
        z, cutoff=field / 5.0
    )
    assert "waviness" not in told(z, cutoff=field / 12.0)
    assert re.search(r"waves of [\d.]+ .m and shorter make up 5\d.* % of its mean square gradient", read(z).outcome[-1])


def test_what_is_said_of_a_window_knows_of_no_jump_between_its_ends():
    z = rough((N,)) + 40e-6 * X / LENGTH
    record = Measured(method="measured", heights=(1e6 * z).tolist(), units=FileUnits(z="um"))
    field = measured_field(record)
    told, closed = (periodic_surface(field, LENGTH, periodic=each).outcome[-1] for each in (False, True))
    slope = np.sqrt(((np.diff(z) / (LENGTH / N)) ** 2).mean())
    assert float(re.search(r"rms gradient of ([\d.]+)", told)[1]) == pytest.approx(slope, rel=0.05)
    assert float(re.search(r"rms gradient of ([\d.]+)", closed)[1]) > 2.0 * slope


@pytest.mark.parametrize("n", [128, 256, 257, 512, 1000])
@pytest.mark.parametrize("radius", [0.02, 0.1])
def test_rounding_of_a_parabola_is_no_sign(n, radius):
    x = (np.arange(n) - n / 2) * LENGTH / N
    assert told(-(x**2) / 2 / radius) == ""


def test_the_form_of_many_points_is_that_of_all():
    """The means that it is found from leave the least-squares shares as they are."""
    z = np.cumsum(np.random.default_rng(3).normal(size=70_001))
    x = np.linspace(-1.0, 1.0, z.size)
    left = [z - np.polynomial.Polynomial.fit(x, z, order)(x) for order in (0, 1, 2)]
    found = form(z)
    assert found.tilt.share == pytest.approx(1 - left[1].var() / left[0].var(), abs=1e-4)
    assert found.curvature.share == pytest.approx(1 - left[2].var() / left[1].var(), abs=1e-4)


@pytest.mark.parametrize("shape", [(N,), (96, 96)])
def test_a_step_is_told_with_its_place(shape):
    z = rough(shape)
    z[..., 50:] += 10 * z.std()
    assert "um behind index 49, and stay there" in told(z)
    if len(shape) == 2:
        assert "um behind row 49, and stay there" in told(z.T)


@pytest.mark.parametrize(
    ("between", "said"), [(9, "and are back: if dust"), (400, "and are back"), (None, "and stay there")]
)
def test_a_plateau_is_told_from_a_step(between, said):
    z = rough((N,))
    z[300 : None if between is None else 300 + between] += 10 * z.std()
    assert f"behind index {299 if between is None else 299 + between}, {said}" in told(z)


def test_saturated_and_stuck_heights_and_marks_of_missing_ones_are_told():
    z = rough((N,))
    top = np.quantile(z, 0.95)
    assert f"{(z >= top).sum()} of 2048 heights are exactly" in told(np.minimum(z, top))
    assert "the largest height: if the instrument was saturated" in told(np.minimum(z, top))
    assert "the smallest height: if the instrument was saturated" in told(np.maximum(z, -top))
    stuck = np.where((np.arange(N) >= 300) & (np.arange(N) < 380), np.median(z), z)
    assert "in 1 run: if the instrument was stuck there" in told(stuck)
    marked = z.copy()
    marked[::37] = -99e-6
    sentences = told(marked)
    assert "56 of 2048 heights are exactly -99 um: if that marks missing heights" in sentences
    assert len(sentences.splitlines()) == 1


@pytest.mark.parametrize(
    ("mark", "places", "said"),
    [
        (-9999.0, [700, 1200], "2 of 2048 heights are exactly -9999 um"),
        (65535.0, [3], "1 of 2048 heights is exactly 65535 um"),
        (1e10, [1, 2, 90], "3 of 2048 heights are exactly 1e+10 um"),
        (-99.0, [1, 2, 90], "3 of 2048 heights are exactly -99 um"),
    ],
)
def test_a_few_marks_of_missing_heights_are_no_spikes(mark, places, said):
    marked = rough((N,))
    marked[places] = 1e-6 * mark
    sentences = told(marked)
    assert f"{said}: if that marks missing heights, write nan for them, and fill: interpolate" in sentences
    assert "spike" not in sentences


def test_heights_in_a_wrong_unit_are_told():
    z = rough((N,))
    assert "check the units" in told(1e3 * z)
    assert "smoother than polished glass: check the units" in told(1e-3 * z)


def test_columns_that_are_confused_are_told(tmp_path):
    np.savetxt(tmp_path / "p.csv", np.column_stack([1e6 * rough((N,)), 1e3 * X]), delimiter=",")
    record = Measured(method="measured", file=str(tmp_path / "p.csv"), units=FileUnits(x="mm", z="um"))
    with pytest.raises(ValueError, match=r"the heights are evenly spaced: if the two columns are confused"):
        measured_surface(record, None)


def test_few_digits_and_bits_are_no_sign():
    for z in (rough((N,)), rough((128, 128))):
        for quanta in (200, 2000):
            quantum = np.ptp(z) / quanta
            assert read(np.round(z / quantum) * quantum).doubts == ()


@pytest.mark.parametrize("shape", [(N,), (128, 128)])
def test_waviness_is_told_and_a_pure_wave_is_not(shape):
    wave = np.cos(2 * np.pi * (1.7 * np.arange(shape[-1]) / shape[-1] + 0.1)) * np.ones(shape)
    assert "waves longer than two fifths of the field make up 99" in told(rough(shape) + 20 * rough(shape).std() * wave)
    assert "waves longer" not in told(20 * rough(shape).std() * wave)


def test_spikes_that_stand_together_are_not_taken_for_a_wrong_unit():
    z = rough((N,))
    z[[40, 300, 301, 302, 303, 304, 305, 900]] += 40 * z.std()
    sentences = told(z)
    assert "2 heights in spikes" in sentences
    assert "units" not in sentences


@pytest.mark.parametrize("detrend", ["tilt", "curvature"])
def test_a_trend_fitted_to_marks_too_is_no_form_of_the_surface(detrend):
    """Marks of missing heights along one edge draw the fitted plane down, and what is left is tilted."""
    heights = 1e-6 * np.random.default_rng(3).normal(size=(64, 64)).cumsum(axis=1)
    heights[:, -4:][np.random.default_rng(4).random((64, 4)) < 0.5] = -9999e-6
    record = Measured(method="measured", heights=heights, units={"z": "m"}, spacing=1e-6, detrend=detrend)
    doubts = measured_surface(record, None).doubts
    assert any("marks missing heights" in each for each in doubts)
    assert not any("detrend" in each for each in doubts)
