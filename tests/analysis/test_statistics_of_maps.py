"""Distributions over maps: closed forms of Hertz, Westergaard and Persson, and clusters counted one by one."""

import numpy as np
import pytest
import textbook
from scipy.special import erf

import gfmd_numba
from gfmd_numba.analysis import UnusableDataError, plot_statistics, secant_stiffness
from gfmd_numba.theory import closed_forms
from support.solved_maps import made, paraboloid, pressed, wave

ROUGH = {
    "dimension": 2,
    "body": {"poissons_ratio": 0.33},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.05},
    "discretisation": {"eps_c": 1 / 2, "eps_f": 1 / 16, "eps_t": 1 / 4},
}


@pytest.fixture(scope="module")
def rough():
    return gfmd_numba.solve(ROUGH | {"path": [{"reduced_pressure": load} for load in (0.1, 0.3, 5.0)]})


@pytest.fixture(scope="module")
def statistics(rough):
    return gfmd_numba.contact_statistics(rough)


def width(statistics, dim):
    return float(statistics[dim][1] - statistics[dim][0])


def test_pressures_of_a_paraboloid_are_those_of_hertz():
    """Of the area pi a^2 a share 1 - (p / p_0)^2 has more than the pressure p, as p = p_0 (1 - r^2/a^2)^(1/2)."""
    n, a = 192, 24.0 / 192
    force = 4.0 / 3.0 * a**3 / 100.0
    dataset = pressed(paraboloid(n, radius=100.0), force)
    found = gfmd_numba.contact_statistics(dataset)
    s = float(dataset["full_contact_rms_pressure"])
    peak = 1.5 * force / (np.pi * a**2) / s
    above = np.cumsum(found["pressure_density"].values[::-1])[::-1] * width(found, "pressure")
    level = found["pressure"].values - width(found, "pressure") / 2
    inner = level > 0.2 * peak  # counted nodes reach a little beyond the edge
    expected = np.pi * a**2 * np.maximum(1.0 - (level / peak) ** 2, 0.0)
    np.testing.assert_allclose(above[inner], expected[inner], atol=0.01 * np.pi * a**2)
    assert found["clusters"].sum() == 1
    assert float(found["perimeter"]) == pytest.approx(2.0 * np.pi * a, rel=0.02)


@pytest.mark.parametrize("axis", [0, pytest.param(1, marks=pytest.mark.long)])
def test_ridges_have_the_pressures_and_gaps_of_westergaard(axis):
    n, amplitude, load = 256, 0.01, 0.3 * np.pi * 0.01
    dataset = pressed(wave(n, amplitude, axis), load)
    assert float(dataset["mean_pressure"]) == pytest.approx(load, rel=1e-9)
    found = gfmd_numba.contact_statistics(dataset)
    assert float(found["mean_gap"] * dataset["height"].std()) == pytest.approx(
        textbook.westergaard_mean_gap(load, amplitude), rel=2e-3
    )
    x = np.linspace(-0.5, 0.5, 200_001)
    s = float(dataset["full_contact_rms_pressure"])
    expected = closed_forms.westergaard_pressure(x, load, amplitude) / s
    edges = np.append(found["pressure"] - width(found, "pressure") / 2, np.inf)
    above = [(expected > max(edge, 1e-9)).mean() for edge in edges]
    cumulated = np.cumsum(found["pressure_density"].values[::-1])[::-1] * width(found, "pressure")
    np.testing.assert_allclose(cumulated, above[:-1], atol=2.5 / n)  # a node at each of two edges
    assert found["clusters"].sum() == 1
    assert float(found["perimeter"]) == pytest.approx(2.0, rel=1e-6)


def test_the_stiffness_of_ridges_is_that_of_koiters_cracks():
    amplitude, loads = 0.01, np.array([0.1, 0.101])
    path = pressed(wave(256, amplitude), loads[0] * np.pi * amplitude, [loads[1] * np.pi * amplitude])
    found = secant_stiffness(path)
    load = loads.mean()  # over p_full
    assert float(found["stiffness"][0]) == pytest.approx(np.pi / -np.log(load), rel=5e-3)


def test_distributions_hold_every_node_and_cluster_of_a_map(rough, statistics):
    found = statistics
    touching = rough["contact_area_fraction_counted"]
    assert found.sizes["step"] == 4
    np.testing.assert_allclose(found["pressure_density"].sum("pressure") * width(found, "pressure"), touching)
    np.testing.assert_allclose(found["gap_density"].sum("gap") * width(found, "gap"), 1.0 - touching, atol=1e-12)
    np.testing.assert_array_equal(found["clusters"].sum("area"), np.maximum(rough["n_segments"], 1))
    assert found["perimeter"][-1] == 0.0
    np.testing.assert_allclose(found["mean_gap"], rough["mean_gap"] / rough["height"].std(["y", "x"]))


def test_perssons_area_and_pressures_stand_next_to_a_map(rough, statistics):
    """On a half-space s = g E*/2 for any spectrum; in full contact the pressures are Gaussian as the heights are."""
    found = statistics
    expected = erf(np.sqrt(2.0) * rough["reduced_pressure"].values)
    np.testing.assert_allclose(found["contact_area_fraction_persson"], expected, rtol=1e-9)
    full = rough["pressure"].isel(step=3) / rough["full_contact_rms_pressure"].isel(step=3)
    second = (found["pressure"] ** 2 * found["pressure_density_persson"]).isel(step=3).sum() * width(found, "pressure")
    assert float(second) == pytest.approx(float((full**2).mean()), rel=0.01)


@pytest.mark.long
def test_the_energy_of_a_map_is_the_work_of_loading():
    loads = np.geomspace(0.01, 2.0, 40)
    pressed = {"loading": {"reduced_pressure": loads[0]}, "path": [{"reduced_pressure": p} for p in loads[1:]]}
    path = gfmd_numba.solve(ROUGH | pressed | {"discretisation": {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2}})
    pressure, gap, energy = (path[name].values for name in ("mean_pressure", "mean_gap", "elastic_energy"))
    work = energy[0] + np.cumsum(0.5 * (pressure[1:] + pressure[:-1]) * -np.diff(gap))
    np.testing.assert_allclose(work, energy[1:], rtol=0.01)


def flooded(flags):
    """Sizes of the clusters of a map on a torus, one flood after another."""
    left, found = flags.copy(), []
    while left.any():
        front, size = [tuple(np.argwhere(left)[0])], 0
        while front:
            y, x = front.pop()
            if left[y, x]:
                left[y, x] = False
                size += 1
                around = ((y + dy, x + dx) for dy, dx in ((0, 1), (1, 0), (0, -1), (-1, 0)))
                front += [(y % flags.shape[0], x % flags.shape[1]) for y, x in around]
        found.append(size)
    return found


@pytest.mark.parametrize("density", [0.1, 0.4, 0.6, 0.9])
def test_clusters_are_counted_by_their_size(density):
    maps = np.random.default_rng(int(100 * density)).random((5, 16, 16)) < density
    found = gfmd_numba.contact_statistics(made(maps))["clusters"]
    octaves = 2.0 ** np.arange(9)
    for one, counted in zip(maps, found, strict=True):
        np.testing.assert_array_equal(counted, np.histogram(flooded(one), octaves)[0])
    np.testing.assert_allclose(found["area"], np.sqrt(2.0) * octaves[:-1] / 256)


@pytest.mark.parametrize("angle", [0.0, 0.2, np.pi / 8, 0.6, np.pi / 4])
def test_the_perimeter_of_straight_edges_is_right_to_half_a_percent(angle):
    n = 400
    x, y = np.meshgrid(np.arange(n) - n / 2 + 0.3, np.arange(n) - n / 2 + 0.1)
    along, across = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
    square = (abs(along) < n / 4) & (abs(across) < n / 4)
    assert float(gfmd_numba.contact_statistics(made(square))["perimeter"]) == pytest.approx(2.0, rel=0.005)


@pytest.mark.parametrize(("outer", "inner"), [(3.0, 0.0), (40.0, 0.0), (20.0, 18.0)])
def test_the_perimeter_of_discs_and_rings_is_right_to_a_percent(outer, inner):
    across = np.arange(128) - np.random.default_rng(0).uniform(60.0, 68.0, (2, 20, 1))
    r = np.hypot(across[0][:, :, np.newaxis], across[1][:, np.newaxis])
    found = gfmd_numba.contact_statistics(made((r <= outer) & (r >= inner)))["perimeter"]
    assert found.size == 20
    assert found.mean() == pytest.approx(2.0 * np.pi * (outer + inner) / 128, rel=0.01)


def test_a_picture_of_maps_shows_their_clusters(rough):
    contacts = plot_statistics(gfmd_numba.contact_statistics(rough)).axes[2]
    assert contacts.get_ylabel() == "Clusters"
    assert len(contacts.lines) == 4


@pytest.mark.parametrize("cut", [{"x": slice(0, 50)}, {"y": slice(None, None, 2)}])
def test_a_part_of_a_map_has_no_clusters(rough, cut):
    with pytest.raises(UnusableDataError, match=r"you gave \d+ of the 256 nodes along (x|y); gfmd allows all nodes"):
        gfmd_numba.contact_statistics(rough.isel(cut))
