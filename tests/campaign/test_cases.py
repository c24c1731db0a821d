"""Cases of a campaign: which there are, which problems are the same, and how they are cut into blocks."""

import numpy as np

import gfmd_numba
from gfmd_numba.campaign.cases import blocks
from gfmd_numba.campaign.failures import Ending
from gfmd_numba.campaign.plan import plan
from support.campaigns import SMALL, campaign


def test_limits_are_one_at_a_time_around_one_reference(tmp_path):
    cases = plan(campaign(tmp_path)).cases
    assert len(cases) == 2 * 5
    eps = [(c.scene.roughness.hurst, c.limit, c.discretisation.eps_c, c.discretisation.eps_f) for c in cases[:5]]
    assert eps == [
        (0.3, "reference", 1 / 4, 1 / 16),
        (0.3, "eps_c", 1 / 2, 1 / 16),
        (0.3, "eps_c", 1 / 8, 1 / 16),
        (0.3, "eps_f", 1 / 4, 1 / 8),
        (0.3, "eps_f", 1 / 4, 1 / 32),
    ]
    assert {c.scene.roughness.hurst for c in cases[5:]} == {0.8}


def test_grid_is_a_full_product(tmp_path):
    text = SMALL.replace("limits: {eps_c: [1/2, 1/4, 1/8], eps_f: [1/8, 1/16, 1/32]}", "")
    text = text.replace("hurst: [0.3, 0.8]", "eps_c: [1/2, 1/4], eps_f: [1/8, 1/16], reduced_pressure: [0.1, 0.2]")
    cases = plan(campaign(tmp_path, text)).cases
    assert len(cases) == 8
    assert len({c.problem.identity for c in cases}) == 8


def test_equal_problems_are_solved_once(tmp_path):
    """A half-space knows nu only through E*, a deep slab is a half-space, the gradient only scales."""
    grid = "poissons_ratio: [0.2, 0.33], aspect_ratio: [.inf, 6, 0.5], rms_gradient: [0.01, 0.1]"
    planned = plan(campaign(tmp_path, **{"hurst: [0.3, 0.8]": grid}))
    assert len(planned.cases) == 2 * 3 * 2 * 5
    assert len(planned.problems) == 5 * (1 + 2)
    assert (
        sum(effect.state == "dropped" for effect in planned.effects) == 1 + 2
    )  # the half-space's Poisson's ratio; a = 6 at either Poisson's ratio


def test_identity_follows_what_decides_the_numbers(tmp_path):
    def identity(**changes):
        return plan(campaign(tmp_path, **changes)).cases[0].problem.identity

    base = identity()
    assert identity(**{"70e9": "1e9"}) == base
    assert identity(**{"rms_gradient: 0.01": "rms_gradient: 0.02"}) == base
    for old, new in (
        ("seed: 1", "seed: 2"),
        ("0.05", "0.06"),
        ("[0.3, 0.8]", "[0.4]"),
        ("eps_f: 1/16, eps_t", "eps_f: 1/32, eps_t"),
        ("grid:", "numerics: {residual: 1e-7}\ngrid:"),
        ("0.33}", "0.33, aspect_ratio: 0.1}"),
    ):
        assert identity(**{old: new}) != base


def test_blocks_cover_all_realisations_once(tmp_path, monkeypatch):
    monkeypatch.setattr("gfmd_numba.campaign.cases._BLOCK_SAMPLES", 500)
    planned = plan(campaign(tmp_path))
    for case in planned.cases:
        covered = [r for block in blocks(case.problem, 6) for r in range(block.first, block.stop)]
        assert covered == list(range(6))
    assert len(list(planned.blocks)) > len(planned.cases)


def test_levels_and_limits_may_have_realisations_of_their_own_and_none(finished, tmp_path):
    text = SMALL.replace("realisations: 6", "realisations: {reference: 6, eps_c: [3, 0, 0], eps_f: 2}")
    result = gfmd_numba.run(campaign(tmp_path, text), tmp_path / "out")
    assert result["limit"].values.tolist() == 2 * ["reference", "eps_c", "eps_f", "eps_f"]
    counts = np.array(2 * [6, 3, 2, 2])
    np.testing.assert_array_equal(result["realisations"], counts)
    np.testing.assert_array_equal((result["status"] == 0).sum("realisation"), counts)
    np.testing.assert_array_equal((result["status"] == Ending.not_asked).sum("realisation"), 6 - counts)
    asked = result["kappa"].notnull().values
    all_of_them = finished["kappa"].values[np.isin(finished["case_id"], result["case_id"])]
    np.testing.assert_array_equal(result["kappa"].values[asked], all_of_them[asked])
