"""Limits along a loading path: each step has the limit of contacts under its load, the path as a whole its own."""

import numpy as np
import pytest
import xarray as xr
import yaml

import gfmd_numba
from gfmd_numba.analysis import UnusableDataError, fit_tfc, plot_fit
from gfmd_numba.analysis.allocation import Pilot
from gfmd_numba.analysis.plots.path import plot_path
from support.command_line import gfmd
from support.synthetic_campaigns import ALPHA as EXACT
from support.synthetic_campaigns import campaign, noisy

pytestmark = pytest.mark.usefixtures("laws_that_hold")

ALPHA = {"eps_c": 2.0, "eps_f": 0.7}
LOADED = {
    "name": "loaded",
    "seed": 1,
    "realisations": 3,
    "scene": {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.02},
    },
    "reference": {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2},
    "limits": {"eps_c": [1 / 2, 1 / 8], "eps_f": [1 / 8, 1 / 32]},
    "grid": {"hurst": [0.3, 0.8]},
    "fit": {"fixed": ALPHA},
}
PATH = {"path": [{"reduced_pressure": 0.1}, {"reduced_pressure": 0.05}]}
PULLED = LOADED | {
    "name": "pulled",
    "realisations": 2,
    "scene": LOADED["scene"]
    | {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.25},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-4, "range": 2e-3}},
        "loading": {"displacement": -1e-3},
    },
    "reference": {"eps_c": 1 / 16, "eps_f": 1 / 4, "eps_t": 1},
    "limits": {"eps_c": [1 / 8], "eps_f": [1 / 8]},
    "grid": {},
    "path": [{"displacement": 0.0}, {"displacement": -6e-3}],
}


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    return gfmd_numba.run(LOADED | PATH, tmp_path_factory.mktemp("loaded") / "out", workers=0)


@pytest.fixture(scope="module")
def whole(loaded, laws_that_hold):
    """The limits of all its steps."""
    return fit_tfc(loaded, fixed=ALPHA)


@pytest.mark.long
def test_a_step_has_the_limit_of_contacts_under_its_load(loaded, tmp_path):
    """Without friction and adhesion a contact does not remember how it was loaded."""
    fitted = fit_tfc(loaded, fixed=ALPHA)
    assert fitted["path_step"].values.tolist() == [0, 0, 1, 1, 2, 2]
    assert fitted["hurst"].values.tolist() == [0.3, 0.8] * 3
    for step, load in enumerate((0.02, 0.1, 0.05)):
        scene = LOADED["scene"] | {"loading": {"reduced_pressure": load}}
        alone = fit_tfc(gfmd_numba.run(LOADED | {"scene": scene}, tmp_path / str(step), workers=0), fixed=ALPHA)
        here = fitted.isel(group=fitted["path_step"].values == step)
        for name in ("kappa_tfc", "kappa_tfc_error", "reference"):
            assert here[name].values == pytest.approx(alone[name].values, rel=1e-6), name
        assert here["correction"].values == pytest.approx(alone["correction"].values, abs=1e-6, nan_ok=True)


def test_a_pilot_predicts_the_error_of_each_step():
    draw = np.random.default_rng(0)
    steps = [noisy(campaign(realisations=30), draw, spread=spread, own=spread / 5.0) for spread in (0.01, 0.2)]
    path = steps[0].assign(kappa=xr.concat([each["kappa"] for each in steps], "step"))
    counts = np.full(path.sizes["case"], 30)
    expected = [Pilot.of(each, "kappa", EXACT).predictions(counts)[0].error for each in steps]
    assert [each.error for each in Pilot.of(path, "kappa", EXACT).predictions(counts)] == expected
    assert expected[1] > 1.01 * expected[0]


def test_a_step_that_is_taken_out_has_the_same_limit(loaded, whole):
    last = fit_tfc(loaded.isel(step=-1), fixed=ALPHA)
    assert np.array_equal(whole["kappa_tfc"].values[-2:], last["kappa_tfc"].values)


def test_what_is_known_of_the_path_as_a_whole_has_one_limit(loaded):
    law = 3e-7 * (1.0 + 0.4 * loaded["eps_c"] ** 2 - 0.2 * loaded["eps_f"] ** 0.7)
    noise = 1.0 + 1e-5 * np.random.default_rng(1).standard_normal(loaded["status"].shape)
    loaded = loaded.assign(hysteresis=(("case", "realisation"), law.values[:, None] * noise, {"units": "J m-2"}))
    fitted = fit_tfc(loaded, "hysteresis", fixed=ALPHA)
    assert "path_step" not in fitted
    assert fitted["hysteresis_tfc"].values == pytest.approx(3e-7, rel=1e-4)
    assert fitted["hysteresis_tfc"].attrs["units"] == "J m-2"


def test_a_limit_is_drawn_over_the_steps_and_the_path_at_the_reference(loaded, whole):
    panel = plot_fit(whole).axes[0]
    assert panel.get_xlabel() == "step of the path"
    lines = plot_path(loaded).axes[0].get_lines()
    mean = loaded["contact_area_fraction"].isel(case=loaded["is_reference"].values).mean("realisation")
    assert sorted(line.get_ydata()[1] for line in lines if len(line.get_ydata()) == 3) == sorted(mean[:, 1].values)


@pytest.mark.long
def test_a_run_prints_limits_of_pull_off_and_of_every_step(tmp_path):
    (tmp_path / "pulled.yaml").write_text(yaml.safe_dump(PULLED))
    done = gfmd("run", tmp_path / "pulled.yaml", "-o", tmp_path / "out", "--workers", "0")
    assert done.exit_code == 0, done.output
    for variable in ("pull_off_pressure (1e-", "hysteresis (1e-", "contact_area_fraction"):
        assert f"{variable}" in done.output
    assert (tmp_path / "out" / "pulled.png").exists()
    fitted = tmp_path / "fit.nc"
    done = gfmd("fit", tmp_path / "out", "--variable", "pull_off_pressure", "-o", fitted)
    assert done.exit_code == 0, done.output
    assert gfmd("plot", fitted).exit_code == 0


def test_one_step_is_fitted_alone_where_it_is_named(loaded, whole):
    one = fit_tfc(loaded, fixed=ALPHA, step=1)
    assert one["path_step"].values.tolist() == [1, 1]
    assert np.array_equal(one["kappa_tfc"].values, whole["kappa_tfc"].values[2:4])
    for wrong in (loaded, loaded.isel(step=0)):
        with pytest.raises(UnusableDataError, match=r"step: you gave 3; gfmd allows (a step from 0 to 2|nothing)"):
            fit_tfc(wrong, fixed=ALPHA, step=3)
    with pytest.raises(UnusableDataError, match=r"step: you gave 'last'; gfmd allows a step from 0 to 2"):
        fit_tfc(loaded, fixed=ALPHA, step="last")


def test_a_step_without_contact_has_no_limit_and_says_so(loaded):
    apart = loaded.copy(deep=True)
    apart["contact_area_fraction"][{"step": 1}] = 0.0
    fitted = fit_tfc(apart, "contact_area_fraction", fixed=ALPHA)
    assert fitted["fit_status"].values.tolist() == ["ok", "ok", "refused", "refused", "ok", "ok"]
    assert fitted["message"].values[2].startswith("it is 0 in all realisations of a case")
