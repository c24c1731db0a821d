"""The limits of a campaign as a smooth function of its parameters, with an error that holds between them."""

import sys

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from click.testing import CliRunner

from gfmd_numba.analysis import UnusableDataError
from gfmd_numba.analysis.smooth_function import smooth_function
from gfmd_numba.cli import main

HURSTS, PRESSURES = [0.0, 0.3, 0.5, 0.8, 1.0], [1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3]


def truth(hurst, pressure):
    return 3.3 - 1.4 * hurst**1.5 + 0.08 * np.log(pressure / 0.01) * (hurst - 0.5)


def nearly_full(hurst, pressure):
    """Falls as contact becomes full, as kappa does, but not as Persson's theory has it."""
    return truth(hurst, pressure) / (1.0 + (1.5 * pressure) ** 1.5)


def fit(hursts=HURSTS, pressures=PRESSURES, error=0.01, seed=0, alike=0.0, of=truth):
    """A fit over a grid, whose limits are off by their errors, which are `alike` over a part of the grid."""
    hurst, pressure = (each.ravel() for each in np.meshgrid(hursts, pressures))
    rng, value = np.random.default_rng(seed), of(hurst, pressure)
    apart = np.hypot(np.subtract.outer(hurst, hurst), np.subtract.outer(*2 * [np.log10(pressure) / 2.5]))
    own = rng.multivariate_normal(np.zeros(value.size), np.exp(-((apart / max(alike, 1e-3)) ** 2) / 2))
    of_parameters = {"axis": "physics", "units": "1"}
    return xr.Dataset(
        {
            "kappa_tfc": ("group", value * (1 + error * own), {"units": "1"}),
            "kappa_tfc_error": ("group", error * value),
            "fit_status": ("group", ["ok"] * value.size),
        },
        {
            "hurst": ("group", hurst, of_parameters | {"rank": 0}),
            "reduced_pressure": ("group", pressure, of_parameters | {"rank": 1}),
            "aspect_ratio": ("group", np.full(value.size, np.inf), of_parameters | {"rank": 2}),
        },
        {"variable": "kappa", "omit_nyquist": "True"},
    )


@pytest.mark.long
@pytest.mark.parametrize(
    ("of", "alike", "error"),
    [(truth, 0.3, 0.01), (nearly_full, 0.0, 1e-3)],
)
def test_the_error_holds_between_the_limits(of, alike, error):
    """Whether errors are independent, or alike for neighbours: mostly within twice the error."""
    rng, off, width = np.random.default_rng(1), [], []
    for seed in range(2):
        found = smooth_function(fit(seed=seed, alike=alike, error=error, of=of))
        assert found["kappa_tfc"].dims == ("hurst", "reduced_pressure")
        hurst, pressure = rng.uniform(0, 1, 12), 10 ** rng.uniform(-3, -0.53, 12)
        at = {name: xr.DataArray(each, dims="place") for name, each in zip(found.dims, (hurst, pressure), strict=False)}
        there = found[["kappa_tfc", "kappa_tfc_error"]].interp(at)
        off.append((there["kappa_tfc"] - of(hurst, pressure)) / there["kappa_tfc_error"])
        width.append((there["kappa_tfc_error"] / there["kappa_tfc"]).max())
    assert np.mean(np.abs(off) < 2) > 0.9
    assert np.sqrt(np.mean(np.square(off))) > 0.2  # no error for its own sake
    assert 0.4 * error < np.max(width) < 2.0 * error + 0.005


def test_the_error_holds_if_all_limits_are_off_together():
    right, off = fit(error=0.01, seed=2), fit(error=0.01, seed=2)
    off["kappa_tfc"] = off["kappa_tfc"] + off["kappa_tfc_error"]
    found = smooth_function(off)
    shift = (found["kappa_tfc"] - smooth_function(right)["kappa_tfc"]) / found["kappa_tfc_error"]
    assert 0.8 < shift.mean() < 1.05
    assert shift.max() < 1.2


def test_a_limit_that_is_off_is_found_out():
    dataset = fit()
    dataset["kappa_tfc"][7] *= 1.08
    found = smooth_function(dataset)
    joint = abs(found["held_out"] / found["held_out_error"])
    assert np.argmax(joint.values) == 7
    assert joint.max() > 4
    for name in ("hurst", "reduced_pressure"):
        assert found[f"point_{name}"][7] == dataset[name][7]


def test_refused_limits_are_left_out_and_few_are_refused():
    dataset = fit()
    dataset["fit_status"][3] = "refused"
    dataset["kappa_tfc"][3] = np.nan
    assert smooth_function(dataset).sizes["point"] == len(HURSTS) * len(PRESSURES) - 1
    for given, said in (
        (fit(hursts=[0.3, 0.8]), r"hurst = 0\.3, 0\.8; gfmd allows 3 or more"),
        (fit(hursts=[0.3], pressures=[0.1]), "of which no parameter varies"),
        (fit().assign(fit_status=("group", ["refused"] * 30)), "without a limit that is known"),
    ):
        with pytest.raises(UnusableDataError, match=said):
            smooth_function(given)


def test_a_parameter_of_one_value_is_no_dim():
    found = smooth_function(fit(hursts=[0.8]))
    assert found["kappa_tfc"].dims == ("reduced_pressure",)
    assert found.attrs["logarithmic"] == "reduced_pressure"
    steps = np.diff(np.log(found["reduced_pressure"]))
    np.testing.assert_allclose(steps, steps[0])


@pytest.fixture
def fitted(monkeypatch, tmp_path):
    """A campaign whose fit is known."""
    monkeypatch.setattr("gfmd_numba.cli.fits._fit", lambda *given, **asked: few())
    monkeypatch.setattr("gfmd_numba.cli.fits.of_fit", lambda fitted: iter(()))
    monkeypatch.setattr("gfmd_numba.cli.fits.of_goal", lambda *given: iter(()))
    file = tmp_path / "x.nc"
    few().to_netcdf(file)
    monkeypatch.setattr("gfmd_numba.campaign.results.read_results", lambda given: few())
    return file


def few():
    return fit(HURSTS[::2], PRESSURES[::2])


@pytest.mark.parametrize("suffix", [".nc", pytest.param(".csv", marks=pytest.mark.long)])
def test_the_command_writes_what_others_read_without_gfmd(fitted, tmp_path, suffix):
    path = tmp_path / f"kappa{suffix}"
    result = CliRunner().invoke(main, ["fit", str(fitted), "--function", str(path)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    assert "kappa_tfc over hurst, reduced_pressure" in result.stdout
    assert "held out" in result.stdout
    expected = smooth_function(few())
    if suffix == ".nc":
        with xr.open_dataset(path) as read:
            xr.testing.assert_allclose(read["kappa_tfc"], expected["kappa_tfc"])
    else:
        read = pd.read_csv(path, comment="#")
        assert list(read) == ["hurst (1)", "reduced_pressure (1)", "kappa_tfc (1)", "kappa_tfc_error (1)"]
        np.testing.assert_allclose(read["kappa_tfc (1)"], expected["kappa_tfc"].values.ravel())


def test_without_the_library_the_command_says_how_to_get_it(fitted, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "sklearn.exceptions", None)
    result = CliRunner().invoke(main, ["fit", str(fitted), "--function", str(tmp_path / "x.csv")])
    said = " ".join(f"{result.stderr} {result.exception}".split())
    assert "--function: you have no scikit-learn, which it needs; gfmd allows it after `pip install" in said
    assert not isinstance(result.exception, ModuleNotFoundError)
    assert not (tmp_path / "x.csv").exists()


@pytest.mark.long
def test_the_table_of_three_parameters_is_no_larger_than_one_can_use():
    each = [
        fit(HURSTS[::2], PRESSURES[::2], seed=seed).assign_coords(aspect_ratio=("group", [ratio] * 9))
        for seed, ratio in enumerate((0.1, 0.3, 1.0))
    ]
    dataset = xr.concat(each, "group", combine_attrs="override")
    for rank, name in enumerate(("hurst", "reduced_pressure", "aspect_ratio")):
        dataset[name].attrs = {"axis": "physics", "units": "1", "rank": rank}
    found = smooth_function(dataset)
    assert len(found["kappa_tfc"].dims) == 3
    assert 20_000 < found["kappa_tfc"].size <= 40_000
