"""Stiffness from differences of loads against Westergaard, a linear solve on the contact, and the elastic energy."""

import numpy as np
import pytest
import textbook
import xarray as xr
import yaml

import gfmd_numba
from gfmd_numba.analysis import UnusableDataError, secant_stiffness
from gfmd_numba.fourier import grid
from gfmd_numba.theory import closed_forms

AMPLITUDE = 0.01
WAVE = {
    "scene": {
        "body": {"poissons_ratio": 0.33},
        "roughness": {"method": "measured", "file": "wave.npy"},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.002},
    },
}


@pytest.fixture
def wave(tmp_path):
    """Solver of paths of loads, in E*, on a wave of so many nodes."""

    def solve(nodes, pressures):
        heights = AMPLITUDE * np.cos(2 * np.pi * np.arange(nodes) / nodes)
        np.save(tmp_path / "wave.npy", heights)
        gradient = np.sqrt(2) * np.pi * AMPLITUDE
        first, *others = ({"reduced_pressure": float(p / gradient)} for p in pressures)
        scene = WAVE["scene"] | {"loading": first}
        (tmp_path / "wave.yaml").write_text(yaml.safe_dump({"scene": scene, "path": others}))
        return gfmd_numba.solve(tmp_path / "wave.yaml")

    return solve


def test_the_stiffness_of_a_wave_is_westergaards(wave):
    """Differences of the closed form, whose error falls as the grid is refined; at light loads its slope as well."""
    full = np.pi * AMPLITUDE
    pressures = full * np.array([0.02, 0.021, 0.2, 0.21, 0.9, 0.91])
    gaps = np.array([textbook.westergaard_mean_gap(p, AMPLITUDE) for p in pressures])
    exact = np.diff(pressures) / -np.diff(gaps)
    coarse, fine = (secant_stiffness(wave(nodes, pressures)) for nodes in (512, 2048))
    error = abs(fine["stiffness"].values / exact - 1)
    assert (error < 2e-3).all()
    assert error.max() < 0.3 * abs(coarse["stiffness"].values / exact - 1).max()
    slope = np.pi / np.log(full / fine["mean_pressure"].values)
    np.testing.assert_allclose(exact[::2], slope[::2], rtol=1e-3)
    rms_height = AMPLITUDE / np.sqrt(2)
    np.testing.assert_allclose(fine["stiffness_reduced"], fine["stiffness"] * rms_height / fine["mean_pressure"])


def test_a_load_that_dwells_has_no_stiffness(wave):
    """Its pressures differ by rounding."""
    dataset = wave(256, [0.003, 0.006, 0.006])
    dataset["mean_pressure"].loc[{"step": 2}] *= 1.0 + 1e-15
    found = secant_stiffness(dataset)["stiffness"].values
    assert found[0] > 0.0
    assert np.isnan(found[1])


def test_the_mean_gap_is_that_of_the_closed_form():
    """From the amplitude without load to nothing in full contact, with the slope of a row of flat punches."""
    full = np.pi * AMPLITUDE
    assert textbook.westergaard_mean_gap(0.0, AMPLITUDE) == AMPLITUDE
    assert textbook.westergaard_mean_gap(full, AMPLITUDE) == pytest.approx(0.0, abs=1e-17)
    width = closed_forms.westergaard_half_width(0.4 * full, AMPLITUDE)
    step = 1e-5 * full
    gaps = [textbook.westergaard_mean_gap(0.4 * full + s, AMPLITUDE) for s in (-step, step)]
    assert (gaps[0] - gaps[1]) / (2 * step) == pytest.approx(-2 / np.pi * np.log(np.sin(np.pi * width)), rel=1e-6)


ROUGH = {
    "scene": {
        "length": 1e-4,
        "body": {"youngs_modulus": 70e9, "poissons_ratio": 0.33},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05},
    },
    "numerics": {"residual": 1e-12},
    "discretisation": {"eps_c": 0.25, "eps_f": 1 / 16, "eps_t": 0.5},
}


def test_stiffness_is_one_linear_solve_with_the_contact_held():
    """A load too small to change the contact presses it like a rigid punch: K = n / sum_ij (A_ff^-1)_ij."""
    path = gfmd_numba.solve(ROUGH | {"path": [{"reduced_pressure": 0.05 * (1 + 1e-6)}]})
    free = (path["gap"] > 0).values
    np.testing.assert_array_equal(free[0], free[1])
    n, e_star = path.sizes["x"], 70e9 / (1 - 0.33**2)
    stiffness = grid.signal(0.5 * grid.wavenumbers(n) * grid.coefficients(np.eye(n)), n)[np.ix_(free[0], free[0])]
    exact = n / np.linalg.solve(stiffness, np.ones(free[0].sum())).sum() * e_star / 1e-4
    found = secant_stiffness(path)
    assert float(found["stiffness"][0]) == pytest.approx(exact, rel=1e-4)
    assert found["stiffness"].units == "Pa m-1"
    assert np.isnan(found["stiffness_error"]).all()


CAMPAIGN = """
name: loads
seed: 4
realisations: 5
scene:
  length: 1e-4
  body: {youngs_modulus: 70e9, poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.02}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
reference: {eps_c: 1/4, eps_f: 1/32, eps_t: 1/2}
limits: {eps_c: [1/2]}
grid: {hurst: [0.3, 0.8], reduced_pressure: [0.1, 0.05, 0.06]}
"""


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    file = tmp_path_factory.mktemp("loads") / "loads.yaml"
    file.write_text(CAMPAIGN)
    return gfmd_numba.run(file, file.parent / "loads")


@pytest.mark.long
def test_campaign_is_compared_load_by_load(campaign):
    found = secant_stiffness(campaign)
    assert found.sizes == {"interval": 8}  # two intervals of two Hurst exponents and two grids
    assert (found["n_realisations"] == 5).all()
    between = sorted(set(np.round(found["reduced_pressure"].values, 6)))
    np.testing.assert_allclose(between, [0.01 / np.log(1.2), 0.04 / np.log(10 / 6)], rtol=1e-4)
    lower = found["reduced_pressure"] < 0.06
    one = found.isel(interval=((found["hurst"] == 0.3) & (found["eps_c"] == 0.25) & lower).values).squeeze()
    chosen = (campaign["hurst"] == 0.3) & (campaign["eps_c"] == 0.25)
    cases = campaign.isel(case=chosen.values).sortby("reduced_pressure")
    approach = -cases["mean_gap"].diff("case").isel(case=0).values
    rise = float(cases["mean_pressure"][1, 0] - cases["mean_pressure"][0, 0])
    assert float(one["stiffness"]) == pytest.approx(rise / approach.mean())
    error = rise * approach.std(ddof=1) / np.sqrt(5) / approach.mean() ** 2
    assert float(one["stiffness_error"]) == pytest.approx(error)
    assert "stiffness_reduced" not in found


@pytest.mark.long
def test_stiffness_stores_the_elastic_energy(campaign):
    """dE = p d(approach) = p dp / K; where K grows as p^a, a <= 2, its trapezoid is off by a/12 of the (d ln p)^2."""
    close = campaign.isel(case=(campaign["reduced_pressure"] < 0.07).values)
    for _, cases in close.groupby(["hurst", "eps_c"]):
        cases = cases.sortby("reduced_pressure")
        stored = np.diff(cases["elastic_energy"].mean("realisation"))[0]
        pressures = cases["mean_pressure"].mean("realisation").values
        found = float(secant_stiffness(cases)["stiffness"][0])
        assert pressures.mean() * np.diff(pressures)[0] / found == pytest.approx(stored, rel=2 * np.log(1.2) ** 2 / 12)


def test_a_surface_that_failed_at_one_load_is_left_out(campaign):
    spoilt = campaign.copy(deep=True)
    spoilt["status"][0, 2] = 1
    found = secant_stiffness(spoilt)
    assert sorted(found["n_realisations"].values) == [4, 5, 5, 5, 5, 5, 5, 5]


def test_reduced_stiffness_is_that_of_each_surface(campaign):
    heights = xr.full_like(campaign["mean_gap"], 2e-8)
    found = secant_stiffness(campaign.assign(rms_height=heights))
    np.testing.assert_allclose(found["stiffness_reduced"], found["stiffness"] * 2e-8 / found["mean_pressure"])
    relative = found["stiffness_reduced_error"] / found["stiffness_reduced"]
    np.testing.assert_allclose(relative, found["stiffness_error"] / found["stiffness"])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda ds: xr.Dataset({"x": [0.0]}), "no results of several loads"),
        (lambda ds: ds.isel(case=[0]), "one load of each surface"),
        (lambda ds: ds.isel(case=(ds["reduced_pressure"] == 0.1).values), "one load of each surface"),
    ],
)
def test_one_load_has_no_stiffness(campaign, change, message):
    with pytest.raises(UnusableDataError, match=message):
        secant_stiffness(change(campaign))


@pytest.mark.parametrize("a", [0.5, 1.0, 1.5, 3.0])
def test_the_difference_of_loads_is_off_as_the_docstring_says(a):
    """K = p^a: the gap falls by the integral of p^-a, and the load is the logarithmic mean."""
    p = np.array([1.0, 1.3])
    closed = np.log(p) if a == 1.0 else p ** (1.0 - a) / (1.0 - a)
    values = {"mean_pressure": p, "mean_gap": 10.0 - closed, "status": np.zeros(2, dtype=np.int8)}
    found = secant_stiffness(xr.Dataset({name: ("step", each) for name, each in values.items()}))
    off = float(found["stiffness"][0] / found["mean_pressure"][0] ** a) - 1.0
    assert off == pytest.approx(a * (1.0 - a) * np.log(1.3) ** 2 / 24.0, rel=0.1, abs=1e-12)


@pytest.mark.long
def test_under_a_hardness_the_way_of_the_punch_includes_the_flattening():
    """The work of the load along the way is what is stored and what is lost in dents."""
    scene = {"length": "1 mm", "body": {"youngs_modulus": "70 GPa", "poissons_ratio": 0.3}}
    scene |= {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05}, "loading": {"pressure": "10 MPa"}}
    scene |= {"interface": {"hard_wall": {"hardness": "1 GPa"}}}
    levels, loads = {"eps_c": 1 / 8, "eps_f": 1 / 8, "eps_t": 1}, [f"{p} MPa" for p in np.geomspace(10, 400, 30)]
    file = {"scene": scene, "discretisation": levels, "seed": 3}
    path = gfmd_numba.solve({**file, "path": [{"pressure": load} for load in loads[1:]]})
    pressure = path["mean_pressure"].values
    of_energies = float(path["elastic_energy"][-1] - path["elastic_energy"][0] + path["energy_lost"][1:].sum())
    ways = np.diff(pressure) / secant_stiffness(path)["stiffness"].values
    assert np.sum(0.5 * (pressure[1:] + pressure[:-1]) * ways) == pytest.approx(of_energies, rel=1e-3)
    of_curve = gfmd_numba.load_curve(file, loads)["contact_stiffness"].values
    assert np.trapezoid(pressure / of_curve, pressure) == pytest.approx(of_energies, rel=0.05)
