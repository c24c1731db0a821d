"""Flow through gaps by the Reynolds equation: closed forms, duality in the plane, and a dense solve node by node."""

import numpy as np
import pytest
import scipy

import gfmd_numba
from gfmd_numba.analysis import UnusableDataError, channels, leakage
from gfmd_numba.contact.contact_dataset import POINTS_OF_WINDOW
from support.solved_maps import made, pressed, wave

OPEN = np.zeros((32, 32), dtype=bool)


def cubes(touching, gap=1.0):
    found = leakage(made(touching, gap))
    assert (found["flow_residual"] < 1e-9).all()
    return found["hydraulic_gap"].values ** 3


@pytest.mark.parametrize("gap", [1.0, 1e-9, 1e-300, 1e90])
def test_a_straight_channel_leaks_by_its_width_and_the_cube_of_its_gap(gap):
    touching = ~OPEN
    touching[5:13] = False  # a quarter of the width, along x
    found = leakage(made(touching, gap))["hydraulic_gap"]
    np.testing.assert_allclose(found / gap, [0.25 ** (1 / 3), 0.0], rtol=1e-12)


def test_parallel_walls_have_the_flow_factor_one():
    found = leakage(made(OPEN, 0.3))
    np.testing.assert_allclose(found["flow_factor"], 1.0, rtol=1e-12)
    np.testing.assert_allclose(found["hydraulic_gap"], 0.3, rtol=1e-12)


def test_the_flow_is_that_of_poiseuille_between_parallel_walls():
    """b^3 W P / (12 eta L): 3 um apart, at 2 bar, water."""
    walls = made(OPEN, 3e-6).isel(y=slice(0, 16))
    walls["gap"].attrs["units"] = "m"
    walls = walls.assign_coords({dim: (1e-3 * walls[dim]).assign_attrs(units="m") for dim in ("x", "y")})
    flow = 2.7e-17 * 2e5 / (12.0 * 1e-3)
    found = gfmd_numba.leakage(walls, "1 mPa s", "2 bar")["flow"]
    np.testing.assert_allclose(found, [0.5 * flow, 2.0 * flow])
    assert found.units == "m3 s-1"
    seal = gfmd_numba.leakage(walls, 1e-3, 2e5, ("1 mm", 0.3))["flow"]
    np.testing.assert_allclose(seal, 300.0 * flow)


@pytest.mark.parametrize(
    ("fluid", "said"),
    [
        ({"viscosity": "1 mPa s"}, "^pressure: you gave nothing"),
        ({"seal": (1, 2)}, "^viscosity: you gave nothing"),
        ({"viscosity": "1 cSt", "pressure": 1.0}, "^viscosity: .* allows a dynamic viscosity in Pa s, mPa s"),
        ({"viscosity": 1.0, "pressure": 1.0, "seal": ("1 mm",)}, "^seal: .* allows a list of 2 numbers"),
        ({"viscosity": 1.0, "pressure": 1.0}, "^viscosity: .* nothing for a contact without a length"),
    ],
)
def test_fluids_that_make_no_sense_are_refused(fluid, said):
    with pytest.raises(gfmd_numba.InputError, match=said):
        gfmd_numba.leakage(made(OPEN, 0.3), **fluid)


@pytest.mark.parametrize("depth", [0.3, 0.7])
def test_a_wave_across_the_flow_is_a_series_of_resistances(depth):
    """1 + e cos: the mean of u^-3 is (2 + e^2) / (2 (1 - e^2)^(5/2)), that of u^3 is 1 + 3 e^2 / 2."""
    gap = np.broadcast_to(1.0 + depth * np.cos(2.0 * np.pi * np.arange(128) / 128), (128, 128))
    series = 2.0 * (1.0 - depth**2) ** 2.5 / (2.0 + depth**2)
    np.testing.assert_allclose(cubes(gap == 0.0, gap), [series, 1.0 + 1.5 * depth**2], rtol=1e-9)


def test_waves_in_both_directions_leak_as_their_geometric_mean():
    """Keller (J. Math. Phys. 5:548, 1964): as u^3 shifted by half a period is u^-3, neither leaks more; order h^2."""
    errors = []
    for n in (32, 64, 128):
        x = 2.0 * np.pi * (np.arange(n) + 0.5) / n  # mirrored at the sides, so that a period goes on behind them
        gap = np.exp(0.5 * np.cos(x) * np.cos(x)[:, np.newaxis])
        errors.append(abs(cubes(gap == 0.0, gap) - 1.0))
    assert errors[2].max() < 1e-3
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), 2.0, atol=0.1)
    np.testing.assert_allclose(np.log2(errors[1] / errors[2]), 2.0, atol=0.1)


def dense(gap):
    """Flow along the first axis of a torus from a full matrix, assembled node by node, with the mean gradient in it."""
    k, (rows, columns) = gap**3, gap.shape
    matrix, source, crossing = np.zeros((gap.size, gap.size)), np.zeros(gap.size), np.zeros(gap.size)
    number = np.arange(gap.size).reshape(gap.shape)
    mean = 0.0
    for i, j in np.ndindex(*gap.shape):
        for below, right, fall in ((1, 0, 1.0 / rows), (0, 1, 0.0)):
            end = (i + below) % rows, (j + right) % columns
            here, there, face = number[i, j], number[end], 2.0 / (1.0 / k[i, j] + 1.0 / k[end])
            for one, other in ((here, there), (there, here)):
                matrix[one, one] += face
                matrix[one, other] -= face
            source[there] += face * fall
            source[here] -= face * fall
            crossing[here] += face * below
            crossing[there] -= face * below
            mean += face * fall
    pressure = np.linalg.lstsq(matrix, source)[0]
    return (crossing @ pressure + mean) / columns


def test_a_random_gap_leaks_as_a_dense_solve_says():
    gap = np.random.default_rng(4).uniform(0.2, 2.0, (12, 12))
    np.testing.assert_allclose(cubes(gap == 0.0, gap), [dense(gap.T), dense(gap)], rtol=1e-10)


def test_closed_nodes_are_those_of_a_vanishing_gap():
    rng = np.random.default_rng(4)
    gap = rng.uniform(0.2, 2.0, (14, 14)) * (rng.random((14, 14)) > 0.25)
    expected = [dense(np.maximum(each, 1e-4)) for each in (gap.T, gap)]
    np.testing.assert_allclose(cubes(gap == 0.0, gap), expected, rtol=1e-6)


@pytest.mark.parametrize("closed", [0.0, 0.3])
def test_where_the_period_is_cut_does_not_matter(closed):
    rng = np.random.default_rng(7)
    dataset = made(rng.random(OPEN.shape) < closed, rng.lognormal(0.0, 1.0, OPEN.shape))
    found = leakage(dataset)
    assert (found["hydraulic_gap"] > 0.0).all()
    for rolled in ({"x": 11}, {"x": 16, "y": 23}):
        again = leakage(dataset.roll(rolled))
        np.testing.assert_allclose(again["hydraulic_gap"], found["hydraulic_gap"], rtol=1e-9)
        np.testing.assert_allclose(again["local_flow"], found["local_flow"].roll(rolled), atol=1e-8)


@pytest.mark.parametrize("rise", [1, 2, 3])
def test_a_channel_that_spirals_leaks_along_both_axes(rise):
    """One file of nodes goes around x once and around y `rise` times: n (rise + 1) faces in series."""
    n, touching = 24, np.ones((24, 24), dtype=bool)
    for column in range(n):
        touching[np.arange(rise * column, rise * (column + 1) + 1) % n, column] = False
    found = leakage(made(touching).roll(y=7))
    np.testing.assert_allclose(found["hydraulic_gap"] ** 3, np.array([1.0, rise**2]) / (n * (rise + 1)), rtol=1e-10)


def test_a_checkerboard_leaks_as_the_geometric_mean_of_its_squares():
    """Keller and Dykhne: d^6 = a^3 b^3 for gaps a and b."""
    errors = []
    for n in (8, 16, 32):
        here = np.add.outer(np.arange(4 * n) // n, np.arange(4 * n) // n) % 2 == 0
        gap = np.where(here, 1.0, 0.6)
        errors.append(abs(cubes(gap == 0.0, gap) / 0.6**1.5 - 1.0).max())
    assert errors[2] < 0.01
    assert errors[2] < errors[1] < errors[0]


def test_the_ends_of_a_window_are_at_one_pressure_each():
    """A wedge of a window: d^-3 is the mean of u^-3 along it and d^3 that of u^3 across."""
    gap = np.broadcast_to(np.linspace(0.2, 1.0, 32), (32, 32))
    dataset = made(OPEN, gap)
    for dim in ("x", "y"):
        dataset[dim].attrs = {POINTS_OF_WINDOW: 32}
    np.testing.assert_allclose(
        leakage(dataset)["hydraulic_gap"] ** 3, [1.0 / (gap**-3.0).mean(), (gap**3).mean()], rtol=1e-10
    )


def test_what_no_channel_connects_does_not_leak():
    rng = np.random.default_rng(6)
    touching = rng.random((12, 16, 16)) < 0.4
    dataset = made(touching, rng.random(touching.shape) + 0.1)
    leaks = leakage(dataset)["hydraulic_gap"] > 0.0
    connects = gfmd_numba.gap_percolation(dataset)["gap_connects"] > 0
    np.testing.assert_array_equal(leaks, connects)
    assert 0 < leaks.sum() < leaks.size
    assert (leakage(made(~OPEN))["flow_factor"] == 0.0).all()


@pytest.mark.parametrize("narrow", [1e-2, 1e-3, 1e-4, 1e-5])
def test_two_narrow_places_resist_one_after_the_other(narrow):
    """What is wide between them resists the less, by the cube of the ratio; their resistances add to 2 / u^3."""
    gap = np.random.default_rng(1).uniform(0.5, 1.0, (40, 40))
    for row in (10, 25):
        gap[row] = 0.0
        gap[row, 7] = narrow
    found = leakage(made(gap == 0.0, gap))
    assert float(found["hydraulic_gap"].sel(direction="y")) == pytest.approx(0.5 ** (1 / 3) * narrow, rel=1e-5)


def test_a_place_too_narrow_to_tell_its_flow_is_not_a_number():
    gap = np.ones((20, 20))
    gap[[5, 15]] = 0.0
    gap[[5, 15], 7] = 1e-7
    found = leakage(made(gap == 0.0, gap)).sel(direction="y")
    assert np.isnan(found["hydraulic_gap"])
    assert np.isnan(found["flow_factor"])
    assert found["flow_residual"] > 1e-3


def test_a_pressed_ridge_leaks_along_itself_only():
    dataset = pressed(wave(64, 0.01), 0.3 * np.pi * 0.01)
    found = leakage(dataset)
    expected = float((dataset["gap"] ** 3).mean())  # channels in parallel
    assert found["hydraulic_gap"].sel(direction="x") == 0.0
    assert float(found["hydraulic_gap"].sel(direction="y")) ** 3 == pytest.approx(expected, rel=1e-9)
    assert found["hydraulic_gap"].units == dataset["gap"].units


@pytest.mark.parametrize("lift", [0.0, 0.01])
def test_the_grooves_of_a_profile_leak_in_parallel_and_across_them_in_series(lift):
    """As the map of the same grooves does."""
    of_map = pressed(wave(64, 0.01), 0.3 * np.pi * 0.01)
    of_map["gap"] = of_map["gap"] + lift
    found, expected = leakage(of_map.isel(y=0).drop_vars("y")), leakage(of_map)
    cubes = [0.0 if lift == 0.0 else 1.0 / float((of_map["gap"] ** -3.0).mean()), float((of_map["gap"] ** 3).mean())]
    np.testing.assert_allclose(found["hydraulic_gap"] ** 3, cubes, rtol=1e-12)
    for name in ("hydraulic_gap", "flow_factor"):
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-9)
    np.testing.assert_allclose(found["local_flow"], expected["local_flow"].isel(y=0), atol=1e-9)
    assert "its grooves go on without end along y" in found.validity


def test_the_flow_through_a_profile_needs_the_width_of_a_seal():
    grooves = made(OPEN, 3e-6).isel(y=0).drop_vars("y")
    grooves["gap"].attrs["units"] = grooves["x"].attrs["units"] = "m"
    with pytest.raises(gfmd_numba.InputError, match=r"^seal: you gave nothing; gfmd allows the length and the width"):
        gfmd_numba.leakage(grooves, 1e-3, "2 bar")
    with pytest.warns(UserWarning, match="that of a profile"):
        found = gfmd_numba.leakage(grooves, 1e-3, "2 bar", ("1 mm", "10 mm"))["flow"]
    np.testing.assert_allclose(found, 2.7e-17 * 2e5 / 12e-3 * 10.0)


def test_both_directions_of_a_period_share_what_is_factored_and_those_of_a_window_do_not(monkeypatch):
    factored, factor = [], scipy.sparse.linalg.splu

    def counted(matrix, **options):
        factored.append(matrix.shape[0])
        return factor(matrix, **options)

    monkeypatch.setattr(scipy.sparse.linalg, "splu", counted)
    leakage(made(OPEN, 0.3))
    assert factored == [OPEN.size]
    window = made(OPEN, 0.3)
    for dim in ("x", "y"):
        window[dim].attrs = {POINTS_OF_WINDOW: 32}
    leakage(window)
    assert factored[1:] == [OPEN.size + 1] * 2  # and the room at both ends


def test_the_flow_through_nodes_is_that_of_the_channel_they_are_in():
    touching = ~OPEN
    touching[5:13] = False  # a quarter of the width, along x
    touching[20:24, :30] = False  # a dead end
    channel = np.isin(np.arange(32), np.arange(5, 13))[:, np.newaxis] & ~touching
    found = leakage(made(touching))["local_flow"]
    np.testing.assert_allclose(found.sel(direction="x"), np.where(channel, 4.0, 0.0))
    assert (found.sel(direction="y") == 0.0).all()


def test_waves_across_the_flow_carry_the_same_everywhere_and_along_it_by_the_cube():
    gap = np.broadcast_to(1.0 + 0.5 * np.cos(2.0 * np.pi * np.arange(64) / 64), (64, 64))
    found = leakage(made(gap == 0.0, gap))["local_flow"]
    np.testing.assert_allclose(found.sel(direction="x"), 1.0, rtol=1e-9)
    np.testing.assert_allclose(found.sel(direction="y"), gap**3 / (gap**3).mean(), rtol=1e-9)


def test_factors_above_one_or_unlike_in_both_directions_are_told_with_their_values():
    grooves = np.broadcast_to(1.0 + 0.6 * np.cos(2.0 * np.pi * np.arange(64) / 64), (64, 64))
    with pytest.warns(UserWarning, match="flow factor") as told:
        said = gfmd_numba.leakage(made(grooves == 0.0, grooves)).validity.splitlines()
    assert [str(each.message) for each in told] == said
    assert [sentence[:50] for sentence in said] == [
        "The flow factor along y is 1.54. The gap leaks mor",
        "The flow factors along x and y are 0.278 and 1.54.",
    ]


def test_the_step_of_a_path_whose_factors_surprise_is_named():
    even = np.ones((3, 32, 32))
    even[1, :, 8:24] = 0.1
    said = leakage(made(even == 0.0, even)).validity
    assert "along y in step 1 is" in said
    assert "along x and y in step 1 are" in said


def test_every_step_without_a_channel_is_named():
    touching = np.ones((7, 16, 16), dtype=bool)
    touching[[0, 4], 3] = touching[[0, 4], :, 2] = False
    said = leakage(made(touching)).validity
    assert "along x in steps 1 to 3, 5 to 6 of 6: on this grid" in said


def test_a_direction_without_an_open_channel_is_told():
    touching = ~OPEN
    touching[5:13] = False  # open along x alone
    said = leakage(made(touching)).validity
    assert "No channel is open along y: on this grid nothing leaks there" in said
    assert "along x and y" not in said


@pytest.mark.parametrize("gap", [1.0, 0.3 + np.random.default_rng(2).random((32, 32))], ids=["parallel", "random"])
def test_factors_that_are_alike_are_no_matter(gap):
    assert leakage(made(OPEN, gap)).validity == ""


def test_more_nodes_than_memory_takes_are_told(monkeypatch):
    def factorise(*arguments, **options):
        raise MemoryError

    monkeypatch.setattr(channels.scipy.sparse.linalg, "splu", factorise)
    with pytest.raises(UnusableDataError, match="you gave channels of 1024 nodes, whose flow takes more memory"):
        leakage(made(OPEN))
