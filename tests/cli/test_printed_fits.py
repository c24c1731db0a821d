"""What a fit prints belongs where it stands: exponents to groups, seconds to the campaign."""

import re
from functools import cache

import numpy as np
import pytest
import xarray as xr

from gfmd_numba import fit_tfc
from gfmd_numba.cli.tables import of_fit, of_goal, of_target
from gfmd_numba.cli.terminal import tell
from support.command_line import unfolded
from support.synthetic_campaigns import ALPHA, campaign, noisy

pytestmark = pytest.mark.usefixtures("undrawn")


def fitted(dataset):
    return fit_tfc(dataset, exponents="free", fixed=ALPHA)


@cache
def _once(hursts):
    return fitted(noisy(campaign(hursts), np.random.default_rng(1)))


def fit_of(*hursts):
    """The fit of groups of these Hurst exponents, for a test to alter."""
    return _once(hursts).copy(deep=True)


def exponent_line(alphas, capsys):
    """What is printed of a fit whose groups have these exponents of eps_f."""
    fit = fit_of(0.8).isel(group=[0] * len(alphas))
    fit["alpha"].loc[{"limit": "eps_f"}] = alphas
    fit["alpha_error"].loc[{"limit": "eps_f"}] = np.nan
    tell(of_fit(fit))
    said = unfolded(capsys.readouterr().out)
    return re.search("fractal eps_f: power, exponent (.*?), extrapolated from", said)[1].replace(",", "")


def test_every_group_has_its_exponent_at_its_place(capsys):
    assert exponent_line([0.9, 0.8, 0.7, 0.8, 0.6, 0.5], capsys) == "0.9 0.8 0.7 0.8 0.6 0.5"


def test_a_group_without_an_exponent_keeps_its_place(capsys):
    assert exponent_line([0.9, np.nan, 0.7, np.nan, 0.6, 0.5], capsys) == "0.9 - 0.7 - 0.6 0.5"


def test_one_exponent_of_all_groups_is_printed_once(capsys):
    assert exponent_line([0.7] * 6, capsys) == "0.7"


def test_exponents_of_many_groups_are_a_range(capsys):
    assert exponent_line([0.9, 0.8, 0.7, 0.8, 0.6, np.nan, 0.8], capsys) == "0.6 to 0.9"


@pytest.mark.long
def test_a_problem_that_cases_share_is_paid_for_once(capsys):
    dataset = noisy(campaign(), np.random.default_rng(1))
    half = dataset.sizes["case"] // 2
    dataset["case_seconds"] = ("case", np.full(2 * half, 10.0))
    apart = fitted(dataset)
    shared = fitted(dataset.assign_coords(case_id=("case", [f"problem-{i % half}" for i in range(2 * half)])))
    assert apart.attrs["cpu_seconds"] == 2 * shared.attrs["cpu_seconds"] == 20.0 * half
    np.testing.assert_array_equal(apart["seconds"], shared["seconds"])
    tell(of_fit(shared))
    assert f"{10 * half} s of processor time" in unfolded(capsys.readouterr().out)


def test_a_campaign_that_does_not_tell_its_seconds_prints_none(capsys):
    fit = fit_of(0.8)
    assert "cpu_seconds" not in fit.attrs
    tell(of_fit(fit))
    assert "processor time" not in capsys.readouterr().out


def test_parts_of_the_error_and_notes_have_the_unit_of_the_table(capsys):
    dataset = noisy(campaign(), np.random.default_rng(1))
    dataset["mean_gap"] = (1e-6 * dataset["kappa"]).assign_attrs(units="m")
    of_gap = fit_tfc(dataset, "mean_gap", fixed=ALPHA | {"eps_f": (0.5, 1.0)})
    tell(of_fit(of_gap))
    said = unfolded(capsys.readouterr().out)
    assert "mean_gap (µm) and its limit" in said
    sampling = 1e6 * float(of_gap["error_budget"].sel(source="sampling").max())
    assert f"sampling {sampling:.2g}" in said
    assert "largest parts in µm, added in quadrature" in said
    assert "nm: add `cross` to the limits" in said
    tell(of_fit(fit_of(0.8)))
    assert "parts in" not in capsys.readouterr().out


def test_a_missed_target_is_told_with_what_reaches_it(capsys):
    limits = {"kappa_tfc": ("group", [2.0, 2.0]), "kappa_tfc_error": ("group", [0.1, 0.2])}
    tell(of_target(xr.Dataset(limits, attrs={"variable": "kappa"}), 0.08))
    said = unfolded(capsys.readouterr().out)
    assert "5.00%, 10.00%; missed by 1 of 2 groups" in said
    assert "`gfmd run --until` goes on" in said


def test_an_exponent_that_no_data_narrow_is_said_to_be_assumed(capsys):
    fit = fit_of(0.8)
    fit["alpha_low"].loc[{"limit": "eps_f"}], fit["alpha_high"].loc[{"limit": "eps_f"}] = 0.5, 1.5
    for error, said in ((0.99 / 12**0.5, True), (0.5 / 12**0.5, False)):
        fit["alpha_error"].loc[{"limit": "eps_f"}] = error
        tell(of_fit(fit))
        assert ("exponent anywhere from 0.5 to 1.5, as assumed" in unfolded(capsys.readouterr().out)) == said


@pytest.mark.long
def test_a_note_that_many_groups_have_with_other_numbers_is_told_once(capsys):
    fit = fit_of(0.3, 0.8).isel(group=[0, 1, 0, 0])
    fit["message"] = ("group", [f"means lie {factor} times off" for factor in (1.1, 1.3, 1.2, 1.25)])
    tell(of_fit(fit))
    said = unfolded(capsys.readouterr().out)
    assert "4 groups, such as H = 0.8: means lie 1.3 times off" in said
    assert said.count("times off") == 1
    fit["message"] = ("group", ["means lie 1.1 times off", "means lie 1.2 times off", "", ""])
    tell(of_fit(fit))
    said = unfolded(capsys.readouterr().out)
    assert "H = 0.3: means lie 1.1 times off" in said
    assert "H = 0.8: means lie 1.2 times off" in said


@pytest.mark.parametrize(
    ("aspect_ratio", "said"),
    [
        (np.inf, ""),
        pytest.param(0.1, "as eps_t -> 0 a slab becomes infinitely thick", marks=pytest.mark.long),
        (None, "as eps_t -> 0 layers become infinitely thick"),
    ],
    ids=["half-space", "slab", "layers"],
)
def test_a_limit_of_eps_t_says_what_becomes_of_slabs_and_layers(aspect_ratio, said, capsys):
    dataset = noisy(campaign(), np.random.default_rng(1))
    heights = dataset["aspect_ratio"]
    if aspect_ratio is None:
        dataset = dataset.drop_vars("aspect_ratio")
    else:
        dataset = dataset.assign_coords(aspect_ratio=heights.copy(data=np.full(heights.shape, aspect_ratio)))
    tell(of_fit(fitted(dataset)))
    printed = unfolded(capsys.readouterr().out)
    assert said in printed
    assert ("infinitely thick" in printed) == bool(said)


def test_an_energy_without_a_length_is_no_pressure(capsys):
    dataset = noisy(campaign(), np.random.default_rng(1)).rename(kappa="elastic_energy")
    dataset["elastic_energy"].attrs["units"] = "Pa"
    tell(of_fit(fit_tfc(dataset, "elastic_energy", fixed=ALPHA)))
    assert "elastic_energy (Pa L_x) and its limit" in unfolded(capsys.readouterr().out)


@pytest.mark.parametrize(
    ("error", "told"), [(0.04, True), (0.6, False), (1e-10, False)], ids=["known", "no relative error", "exact"]
)
def test_a_tenth_of_an_error_has_a_price_where_that_makes_sense(error, told, capsys):
    """A limit that may be 0 has no relative error, and that of full contact is exact."""
    of_round = {"round_error": error, "round_error_factor": 1.0, "round_predicted_error": np.nan}
    rounds = {name: ("round", [value]) for name, value in (of_round | {"round_cpu_seconds": 3.0}).items()}
    results = xr.Dataset(rounds, {"round": [0]}, {"target": '{"kappa": 0.03}', "ended": "reached", "reached": "kappa"})
    tell(of_goal(results, fit_of(0.8)))
    said = unfolded(capsys.readouterr().out)
    assert "until kappa to 3.00%: reached" in said
    assert ("a tenth of this error" in said) == told
