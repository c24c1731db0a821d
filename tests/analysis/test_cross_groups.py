"""Fits of campaigns with cross levels, whose corrections add up."""

import numpy as np
import pytest

from gfmd_numba.analysis import ensemble_mean, fit_tfc, select_limit
from gfmd_numba.analysis.selection import groups_to_fit
from support.cross_levels import crossed
from support.synthetic_campaigns import ALPHA, CROSS, TFC, fails

BOTH = {"eps_f": 1 / 512, "eps_t": 1}
AT_NYQUIST = {"eps_c": 1, "eps_f": 1 / 512}


def test_cross_cases_enter_a_group_with_all_their_levels():
    (group,) = groups_to_fit(crossed(BOTH), "kappa", omit_nyquist=True)
    levels = {name: group.levels[name][-1] for name in group.levels}
    assert levels == {"eps_c": 1 / 2, "eps_f": 1 / 512, "eps_t": 1}
    assert group.reference == {"eps_c": 1 / 2, "eps_f": 1 / 1024, "eps_t": 1 / 2}


def test_a_fit_of_corrections_that_add_up_finds_the_limit_from_cross_levels_too():
    others = {"eps_c": 1 / 8, "eps_f": 1 / 2048}, {"eps_c": 1 / 4, "eps_t": 1}
    fit = fit_tfc(crossed(BOTH, *others), fixed=ALPHA)
    assert fit["kappa_tfc"].item() == pytest.approx(TFC[0.8], rel=1e-6)


def test_cross_cases_at_nyquist_are_left_out_of_a_fit():
    dataset = crossed(*CROSS, AT_NYQUIST)
    broken = dataset.assign(kappa=dataset["kappa"].where(dataset["eps_c"] < 1, 17.0))
    (group,) = groups_to_fit(broken, "kappa", omit_nyquist=True)
    assert 1.0 not in group.levels["eps_c"]
    assert fit_tfc(broken, fixed=ALPHA)["kappa_tfc"].item() == pytest.approx(TFC[0.8], rel=1e-6)
    (whole,) = groups_to_fit(broken, "kappa", omit_nyquist=False)
    assert 1.0 in whole.levels["eps_c"]


def test_a_cross_case_that_fails_is_named_by_all_its_levels():
    dataset = crossed(BOTH, n=4)
    (group,) = groups_to_fit(fails(dataset, case=dataset.sizes["case"] - 1), "kappa", omit_nyquist=True)
    assert group.notes[0] == "left out, no good realisation: eps_c = 1/2, eps_f = 1/512, eps_t = 1"


def test_a_limit_is_selected_without_cross_cases():
    dataset = crossed(BOTH, AT_NYQUIST)
    for limit in ALPHA:
        chosen = select_limit(dataset, limit)
        assert chosen.sizes["case"] == 3
        assert np.isfinite(ensemble_mean(chosen, "kappa")[0]).all()
