"""By how much fits differ beyond chance, and which levels are left out of them."""

import re

import numpy as np
import pytest

from gfmd_numba.analysis import fit_tfc
from gfmd_numba.analysis.allocation import Pilot
from gfmd_numba.analysis.limit_errors import Rival, disagreement
from support.doubts import without_doubts
from support.synthetic_campaigns import TFC, campaign, noisy
from support.unseen_slope import factor

LEVELS = [1 / 128, 1 / 256, 1 / 512, 1 / 1024, 1 / 2048]


@pytest.mark.parametrize(
    ("rival", "variance", "beyond"),
    [
        (3.0, 0.05, np.sqrt(1.0 - 4 * 0.04)),
        (1.0, 0.05, -np.sqrt(1.0 - 4 * 0.04)),
        (2.39, 0.05, 0.0),  # two standard deviations of the difference
        (2.5, 0.01, np.sqrt(0.25 - 4e-5)),
        (2.5, 0.001, np.sqrt(0.25 - 4e-5)),  # a rival that is surer has no scatter of its own
    ],
)
def test_a_rival_that_is_less_sure_may_differ_by_chance(rival, variance, beyond):
    """Of a value of 2 with a variance of 0.01: variances of the difference are those of nested data (Hausman 1978)."""
    assert disagreement(2.0, 0.01, rival, variance) == pytest.approx(beyond)
    assert Rival("", [], {}).error(2.0, 0.01, rival, variance) == pytest.approx(abs(beyond))
    by_theory = Rival("", [], {}, from_theory=True).error(2.0, 0.01, rival, variance)
    assert by_theory**2 == pytest.approx((rival - 2.0) ** 2 + max(0.0, variance - 0.01))


@pytest.mark.parametrize("moved", [[], [0], [0, 1]])
def test_coarse_levels_that_no_law_describes_are_left_out(moved, monkeypatch):
    """As long as enough are left to tell."""
    truth = campaign(levels={"eps_f": LEVELS}, coefficients={"eps_f": 6.0}, realisations=30).rename(kappa="kappa_r")
    dataset = noisy(truth.rename(kappa_r="kappa"), np.random.default_rng(1), spread=0.02, own=0.002)
    for level in moved:
        dataset["kappa"][np.flatnonzero(dataset["eps_f"] == LEVELS[level])] += 0.1
    fit = fit_tfc(dataset.rename(kappa="kappa_r"), "kappa_r", fixed={"eps_f": 0.6})
    left_out = re.findall(r"eps_f = 1/(\d+) is left out, as no law describes it", fit["message"].item())
    assert left_out == [f"{1 / LEVELS[level]:g}" for level in moved]
    assert fit["misfit"].item() == 1.0
    assert abs(fit["kappa_r_tfc"].item() - TFC[0.8]) < 3.0 * fit["kappa_r_tfc_error"].item()


def test_the_limit_by_each_law_is_told_and_a_design_follows_the_likeliest(monkeypatch):
    without_doubts(monkeypatch)
    whole = campaign(levels={"eps_f": LEVELS}, coefficients={}, realisations=60)
    whole = whole.assign(kappa=whole["kappa"] * [[factor(0.8, eps)] for eps in whole["eps_f"].values])
    dataset = noisy(whole, np.random.default_rng(0), spread=0.02, own=0.002)
    fit = fit_tfc(dataset, fixed={"eps_f": (0.3, 2.0)})
    told = re.findall(r"([\d.]+)±([\d.]+) by (.*?) \((\d+)%\)", fit["message"].item())
    assert [law for _, _, law, _ in told] == ["a power of eps_f", "the law of the unseen slope"]
    value, error, weight = np.array([[float(each) for each in (v, e, w)] for v, e, _, w in told]).T
    weight = weight / 100.0
    assert weight @ value == pytest.approx(fit["kappa_tfc"].item(), abs=2e-3)
    scatter = np.sqrt(weight @ (error**2 + (value - weight @ value) ** 2))
    assert scatter == pytest.approx(fit["kappa_tfc_error"].item(), rel=0.05)
    wrong = {"eps_f": (1.0, 2.0)}  # no power in this range goes with the levels
    (pilot,) = Pilot.of(dataset, "kappa", wrong).ensembles
    assert pilot.kappa == pytest.approx(TFC[0.8], abs=0.03)
    # the curve begins a little before the coarsest level and ends a little beyond the finest
    curve = fit["curve_eps"].sel(limit="eps_f").values[0]
    assert LEVELS[0] < curve[0] < 1.2 * LEVELS[0]
    assert 0.7 * LEVELS[-1] < curve[-1] < LEVELS[-1]
    assert (np.diff(curve) < 0.0).all()
