"""Designs that reach an accuracy at the least cost: predicted against achieved."""

import numpy as np
import pytest

from gfmd_numba.analysis import UnusableDataError, fit_tfc
from support.expected_interactions import drawn
from support.pilots import cheapest_design
from support.synthetic_campaigns import ALPHA, CROSS, TFC, campaign, noisy, of_limit

pytestmark = pytest.mark.usefixtures("laws_that_hold")

LEVELS = {"eps_c": [1 / 2, 1 / 4, 1 / 8], "eps_f": [1 / 512, 1 / 1024, 1 / 2048], "eps_t": [1, 1 / 2, 1 / 4]}
CAMPAIGN = {"levels": LEVELS, "cross": CROSS}


def whole(seed, n):
    """Campaign whose interactions are drawn from what is expected of them."""
    rng = np.random.default_rng(seed)
    return noisy(campaign(realisations=n, **CAMPAIGN, **drawn(rng)), rng)


def pilot(seed=0, n=40):
    dataset = whole(seed, n)
    seconds = 1e-3 / (dataset["eps_c"] * dataset["eps_f"] * dataset["eps_t"]).values / 4096
    return dataset, seconds


def achieved(design, seeds=40):
    """How far kappa_tfc of repeated campaigns of a design is off, relative and root mean square."""
    return off([left(whole(1000 + seed, design.realisations.max()), design) for seed in range(seeds)])


def off(datasets):
    found = np.array([fit_tfc(dataset, fixed=ALPHA)["kappa_tfc"].item() for dataset in datasets])
    return np.sqrt(np.mean((found / TFC[0.8] - 1.0) ** 2))


def left(dataset, design):
    """What a campaign of that design has of a dataset."""
    counts = design.realisations
    kept = np.arange(dataset.sizes["realisation"]) < counts[:, None]
    dataset = dataset.assign(kappa=dataset["kappa"].where(kept)).assign_coords(realisations=("case", counts))
    return dataset.isel(case=counts > 0)


@pytest.mark.long
def test_the_target_is_met_with_fewer_fine_levels_and_so_cheaper_than_by_equal_numbers():
    """Seconds times squared error are a constant of a design."""
    design = cheapest_design(*pilot(), target=0.01, fixed=ALPHA)
    by_design, by_equal_numbers = achieved(design), off([whole(1000 + seed, 200) for seed in range(40)])
    assert design.error <= 0.01
    assert 0.4 * design.error < by_design < 1.15 * design.error
    assert design.seconds * by_design**2 < 0.8 * 200 * sum(pilot()[1]) * by_equal_numbers**2


@pytest.mark.long
def test_a_level_that_costs_much_and_tells_little_is_left_out():
    levels = LEVELS | {"eps_c": [1 / 2, 1 / 4, 1 / 8, 1 / 4096]}
    dataset = noisy(campaign(realisations=40, levels=levels, cross=CROSS), np.random.default_rng(5))
    seconds = 1e-3 / (dataset["eps_c"] * dataset["eps_f"] * dataset["eps_t"]).values / 4096
    design = cheapest_design(dataset, seconds, target=0.01, fixed=ALPHA)
    assert design.realisations[dataset["eps_c"].values == 1 / 4096] == 0
    assert all(np.count_nonzero(of_limit(dataset, design, limit)) >= 2 for limit in ("eps_c", "eps_f", "eps_t"))


@pytest.mark.long
def test_half_the_error_costs_four_times_as_much():
    coarse, fine = (cheapest_design(*pilot(), target=target, fixed=ALPHA) for target in (0.01, 0.005))
    assert fine.seconds / coarse.seconds == pytest.approx(4.0, rel=0.1)
    assert [coarse.error, fine.error] == pytest.approx([0.01, 0.005], rel=0.02)  # more would be dearer


def test_what_cannot_be_reached_is_told():
    ranges = {"eps_c": (1, 2), "eps_f": (0.3, 1.5), "eps_t": (0.5, 2)}
    dataset, seconds = pilot()
    with pytest.raises(
        UnusableDataError, match=r"you gave a target of 0.01%, where 1000000 realisations of all cases leave"
    ):
        cheapest_design(dataset, seconds, target=0.0001, fixed=ranges)
    with pytest.raises(UnusableDataError, match=r"you gave a pilot of 4 good realisations; gfmd allows at least 20"):
        cheapest_design(dataset.isel(realisation=slice(4)), seconds, target=0.1, fixed=ranges)
