"""What makes a measured surface implausible, and that ordinary surfaces are not."""

import re

import numpy as np
import pytest

from gfmd_numba.roughness import plausibility
from gfmd_numba.roughness.processing import filtered, mirrored
from gfmd_numba.roughness.statistics import rms_gradient
from gfmd_numba.scene.surface_file import SurfaceFile
from gfmd_numba.scene.surfaces import SelfAffine
from gfmd_numba.simulate.surface import make

SEEDS = {"some": range(5), "more": range(5, 15)}
COSINE = 1e-3 * np.cos(2 * np.pi * np.arange(256) / 256)


def doubts(heights, lengths=None):
    lengths = (1.0,) * heights.ndim if lengths is None else lengths
    signs = plausibility.of_field(plausibility.LevelledField(heights, heights, lengths, {"z": "L_x"}))
    return signs.sentences + plausibility.of_surface(heights, lengths, signs)


def ordinary(hurst, dimension, seed, points, roll_off, cut_on):
    surface = SelfAffine(
        method="psd", hurst=hurst, rms_gradient=0.05, points=points, roll_off=roll_off, cut_on=cut_on, plateau=False
    )
    return make(SurfaceFile(surface=surface, dimension=dimension, seed=seed)).heights


@pytest.mark.parametrize("seeds", ["some", pytest.param("more", marks=pytest.mark.long)])
@pytest.mark.parametrize("waves", ["all", "resolved", "few"])
@pytest.mark.parametrize("hurst", [0.0, 0.5, 1.0])
@pytest.mark.parametrize(("dimension", "points"), [(1, 512), (2, 48)])
def test_ordinary_surfaces_are_plausible(dimension, points, hurst, waves, seeds):
    """15 seeds of each, down to Nyquist, on four points a wave, and with a few long waves; mirrored and small, too."""
    shortest = {"all": 2.1, "resolved": 4.0, "few": points / 4}[waves] / points
    for seed in SEEDS[seeds]:
        heights = ordinary(hurst, dimension, seed, points, 1.0, shortest)
        assert doubts(heights) == ()
        assert plausibility.of_surface(mirrored(1e-6 * heights), (2.0,) * dimension) == ()


@pytest.mark.parametrize("n", [4, 5, 8, 16])
def test_waves_on_few_points_are_plausible(n):
    for phase in np.linspace(0, 6, 20):
        heights = 1e-3 * np.cos(2 * np.pi * np.arange(n) / n + phase)
        assert doubts(heights) == ()
        assert doubts(np.add.outer(heights, heights)) == ()


def test_punches_of_textbooks_are_plausible():
    x = np.arange(256) / 256 - 0.5
    for heights in (
        -(x**2),
        -abs(x),
        np.where(abs(x) < 0.25, 0.0, -0.5 * (abs(x) - 0.25)),
        COSINE,
        np.round(COSINE, 6),
    ):
        assert doubts(0.05 * heights) == ()
    assert "whose rounding makes up" in doubts(0.05 * np.round(COSINE, 4))[0]


def test_a_wall_at_the_seam_is_one_of_several():
    steps = 1e-4 * np.repeat([0.0, 1.0] * 8, 32)
    assert doubts(steps) == ()


@pytest.mark.parametrize(
    ("heights", "said"),
    [
        (COSINE[:200], "the heights jump by 0.000829"),
        (COSINE + 0.02 * np.arange(256) / 256, "a tilt makes up 98.5"),
        (200 * COSINE, "an rms gradient of 0.889, above 0.3"),
        (1e4 * COSINE, "heights that range over 20 periods"),
        (
            COSINE + np.where(np.arange(256) == 77, 0.1, 0.0),
            "a spike at index 77: despike: true",
        ),
        (np.where(np.arange(256) == 77, 1e-4, 0.0), "a spike at index 77: despike: true"),
        (COSINE - np.isin(np.arange(256), (77, 150)) * 0.1, "leave them if the surface has such grooves"),
        (np.add.outer(COSINE[::4], COSINE[:200]), "where the period along x closes"),
        (np.add.outer(COSINE[:200], COSINE[::4]), "where the period along y closes"),
        (np.add.outer(np.arange(64) / 6400, COSINE[::4]), "a tilt makes up"),
        (
            np.add.outer(COSINE[::4], COSINE[::4]) + 0.2 * (np.arange(4096) == 130).reshape(64, 64),
            "a spike at index 2, 2: despike",
        ),
    ],
)
def test_signs_are_told_with_their_numbers(heights, said):
    assert any(re.search(said, sentence) for sentence in doubts(heights)), doubts(heights)


def test_a_share_that_was_filled_is_told_from_the_threshold_on():
    for missing, said in ((12, ""), (15, "5.86 % of the heights were missing and filled")):
        measured = np.where(np.arange(256) < missing, np.nan, COSINE)
        (sentence,) = plausibility.of_field(plausibility.LevelledField(measured, COSINE, (1.0,), {})).sentences or ("",)
        assert sentence.startswith(said)
        assert bool(sentence) == bool(said)


@pytest.mark.parametrize("n", [12, 16, 32])
def test_noise_on_few_points_is_plausible(n):
    """The largest of few steps is small; the seam, one of them, then exceeds it by half in one case of twenty."""
    for seed in range(60):
        assert doubts(1e-4 * np.random.default_rng(seed).normal(size=n)) == ()


@pytest.mark.parametrize("dimension", [1, 2])
def test_a_form_that_does_not_stand_out_is_told_where_it_is_most_of_the_height(dimension):
    points = {1: 512, 2: 48}[dimension]
    rough = ordinary(0.8, dimension, 3, points, 0.5, 2.1 / points)
    x = np.sum(np.meshgrid(*[np.linspace(-0.5, 0.5, points)] * dimension), axis=0)
    form = x - 1.5 * x**2
    for times, said in ((0.5, False), ({1: 6.0, 2: 3.0}[dimension], True)):
        heights = rough + times * rough.std() / form.std() * form
        field = plausibility.LevelledField(heights, heights, (1.0,) * dimension, {"z": "L_x"}, mirrored=True)
        found = plausibility.of_field(field).sentences
        assert any("make" in each and "% of the mean square height" in each for each in found) == said


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("quanta", [0.15, 0.4, 1.0, 4.0])
def test_rounding_to_coarse_steps_is_told_with_its_share_of_the_gradient(dimension, quanta):
    exact = ordinary(0.8, dimension, 3, {1: 1024, 2: 128}[dimension], 0.25, 0.02)
    one = (1.0,) * dimension
    step = np.sqrt((np.diff(exact) ** 2).mean()) / quanta
    rounded = np.round(exact / step) * step
    squares = [(np.diff(each) ** 2).mean() for each in (exact, rounded)]
    found = plausibility.of_field(plausibility.LevelledField(rounded, rounded - rounded.mean(), one, {}))
    (told,) = [each for each in found.sentences if "whose rounding makes up" in each] or [""]
    share = 1.0 - squares[0] / squares[1]
    if share < 0.04:
        assert told == ""
        return
    assert float(re.search(r"makes up ([\d.]+) %", told)[1]) == pytest.approx(100.0 * share, abs=5.0)
    assert not any("spike" in each for each in found.sentences)
    assert found.rms_gradient > 0.5 * np.sqrt(squares[0]) * exact.shape[-1]
    advised = re.search(r"cutoff: ([\d.e-]+)", told)
    if advised is None:
        assert exact.std() < 2.0 * step
        return
    cutoff = float(advised[1])
    kept = plausibility.LevelledField(rounded, rounded - rounded.mean(), one, {}, cutoff=cutoff)
    assert not any("rounding" in each for each in plausibility.of_field(kept).sentences)
    kept_waves = [filtered(each, one, cutoff) for each in (exact, rounded)]
    slopes = [float(rms_gradient(each, one)) for each in kept_waves]
    assert slopes[1] == pytest.approx(slopes[0], rel=0.05)
