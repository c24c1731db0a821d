"""Designs for loose targets: a larger error never costs more."""

from itertools import pairwise

import numpy as np
import pytest

from support.pilots import cheapest_design
from support.synthetic_campaigns import ALPHA, CROSS, campaign, noisy, of_limit

LEVELS = {"eps_c": [1 / 2, 1 / 4, 1 / 8, 1 / 4096], "eps_f": [1 / 512, 1 / 1024, 1 / 2048], "eps_t": [1, 1 / 2, 1 / 4]}
TARGETS = (0.3, 0.1, 0.07, 0.06, 0.05, 0.04, 0.03, 0.02)


@pytest.mark.long
def test_a_larger_error_costs_no_more():
    """With a level that costs much and tells little, 10 % cost 8 % more than 5 %."""
    dataset = noisy(campaign(realisations=40, levels=LEVELS, cross=CROSS), np.random.default_rng(5))
    seconds = 1e-3 / (dataset["eps_c"] * dataset["eps_f"] * dataset["eps_t"]).values / 4096
    designs = [cheapest_design(dataset, seconds, target, fixed=ALPHA) for target in TARGETS]
    for target, design in zip(TARGETS, designs, strict=True):
        assert design.error <= target
        assert all(np.count_nonzero(of_limit(dataset, design, limit)) >= 2 for limit in ("eps_c", "eps_f", "eps_t"))
    for looser, tighter in pairwise(designs):
        assert looser.seconds <= tighter.seconds
