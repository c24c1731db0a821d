"""Designs of campaigns with cross levels, at which several discretisations differ from the reference at once."""

import numpy as np
import pytest
import xarray as xr

from gfmd_numba.analysis import UnusableDataError
from support.cross_levels import crossed
from support.pilots import cheapest_design
from support.synthetic_campaigns import ALPHA, CROSS, noisy, of_limit

pytestmark = pytest.mark.usefixtures("laws_that_hold")

CHEAP = {"eps_f": 1 / 512, "eps_t": 1}
DEAR = {"eps_c": 1 / 512, "eps_t": 1 / 64}


def priced(dataset, seed=0):
    """Pilot of a campaign, and the seconds of a realisation of each case."""
    dataset = noisy(dataset, np.random.default_rng(seed))
    return dataset.rename(kappa="kappa_r"), 1e-3 / (
        dataset["eps_c"] * dataset["eps_f"] * dataset["eps_t"]
    ).values / 4096


def test_a_cheap_cross_level_is_kept_and_one_that_costs_much_and_tells_little_is_not():
    dataset, seconds = priced(crossed(*CROSS, DEAR))
    design = cheapest_design(dataset, seconds, target=0.01, variable="kappa_r", fixed=ALPHA)
    *cheap, dear = of_limit(dataset, design, "cross")
    assert min(cheap) >= 20
    assert dear == 0


def test_an_accuracy_that_interactions_forbid_asks_for_cross_levels():
    for levels in ((), CROSS[:2]):
        with pytest.raises(UnusableDataError, match=r"cross levels for every pair of limits \(`cross`\)"):
            cheapest_design(*priced(crossed(*levels)), target=0.01, variable="kappa_r", fixed=ALPHA)
    dataset, seconds = priced(crossed(*CROSS))
    design = cheapest_design(dataset, seconds, target=0.01, variable="kappa_r", fixed=ALPHA)
    assert min(of_limit(dataset, design, "cross")) >= 20


@pytest.mark.long
def test_cross_levels_get_more_realisations_where_the_error_is_that_of_interactions():
    dataset, seconds = priced(crossed(*CROSS))
    loose, tight = (
        cheapest_design(dataset, seconds, target=target, variable="kappa_r", fixed=ALPHA) for target in (0.04, 0.01)
    )
    fewest = [min(of_limit(dataset, design, "cross")) for design in (loose, tight)]
    assert fewest[1] > 3 * fewest[0]


@pytest.mark.long
def test_a_cross_level_at_nyquist_is_never_worth_a_surface():
    dataset, seconds = priced(crossed({"eps_c": 1, "eps_t": 1}, *CROSS))
    design = cheapest_design(dataset, seconds, target=0.02, variable="kappa_r", fixed=ALPHA)
    assert of_limit(dataset, design, "cross")[0] == 0


@pytest.mark.long
def test_a_limit_keeps_its_own_levels_next_to_cross_ones():
    dataset, seconds = priced(crossed(*CROSS))
    design = cheapest_design(dataset, seconds, target=0.01, variable="kappa_r", fixed=ALPHA)
    assert all(np.count_nonzero(of_limit(dataset, design, limit)) >= 2 for limit in ("eps_c", "eps_f", "eps_t"))


def test_a_cross_level_is_one_whatever_eps_the_grid_varies():
    fine = crossed(CHEAP, DEAR)
    coarse = fine.copy(deep=True).assign_coords(eps_c=2 * fine["eps_c"])
    grid = xr.concat([fine, coarse.isel(case=coarse["limit"].values != "eps_c")], "case")
    grid = grid.isel(case=grid["limit"].values != "eps_c")  # an eps of the grid is in no limit, and in no cross level
    grid = grid.isel(case=~((grid["limit"] == "cross") & (grid["eps_t"] == DEAR["eps_t"])).values)
    grid["eps_c"].attrs = fine["eps_c"].attrs
    grid["case_id"] = ("case", [f"case-{i}" for i in range(grid.sizes["case"])])
    assert (grid["limit"] == "cross").sum() == 2
    dataset, seconds = priced(grid)
    design = cheapest_design(dataset, seconds, target=0.05, variable="kappa_r", fixed=ALPHA)
    assert len(set(of_limit(dataset, design, "cross"))) == 1
