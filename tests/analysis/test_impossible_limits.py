"""Limits of what cannot be negative, or above 1, and levels that are too far from their limit to tell it."""

import numpy as np
import pytest
import scipy.stats

from gfmd_numba import fit_tfc
from gfmd_numba.contact.observables import LIMITED
from gfmd_numba.theory.exponent_ranges import OF_ONE_SIGN, SHARES, possible_values
from support.synthetic_campaigns import ALPHA, CROSS, REFERENCE, assert_refused, campaign, noisy

RANGES = {"eps_c": (2, 3), "eps_f": (0.2, 2), "eps_t": (1, 2)}
OF_BOTH_SIGNS = {
    *("approach", "mean_tangential_traction", "mean_tangential_traction_y", "energy_lost", "hysteresis"),
    *("hysteretic_friction", "pull_off_pressure"),
}


def far(of_eps_f, of_eps_t, alpha, seed=0):
    """A campaign whose limit of kappa is 2 and whose corrections at the reference are larger."""
    own = {"eps_c": 2.2, "eps_f": alpha, "eps_t": 1.2}
    sizes = {"eps_c": 0.1, "eps_f": of_eps_f, "eps_t": of_eps_t}
    coefficients = {name: size / REFERENCE[name] ** own[name] for name, size in sizes.items()}
    made = campaign(coefficients=coefficients, alpha=own, realisations=30, cross=CROSS)
    return noisy(made, np.random.default_rng(seed), spread=0.6)


def test_it_is_known_of_all_that_has_a_limit_whether_it_has_one_sign():
    assert LIMITED.keys() - OF_BOTH_SIGNS == {*OF_ONE_SIGN, *SHARES}
    assert possible_values("kappa") == (0.0, np.inf)
    assert possible_values("kappa", -1.0) == (-np.inf, 0.0)  # under tension
    assert possible_values("stick_fraction") == (0.0, 1.0)
    assert possible_values("energy_lost") == (-np.inf, np.inf)


@pytest.mark.long
@pytest.mark.parametrize(("of_eps_f", "of_eps_t", "alpha"), [(2.0, 1.0, 0.6), (10.0, 4.0, 0.3)])
def test_the_interval_has_the_limit_and_nothing_impossible_however_far_levels_are(of_eps_f, of_eps_t, alpha):
    fit = fit_tfc(far(of_eps_f, of_eps_t, alpha), fixed=RANGES).isel(group=0)
    assert 0.0 <= fit["kappa_tfc_low"] <= 2.0 <= fit["kappa_tfc_high"]
    assert fit["kappa_tfc"] > 0.0
    assert ("where its law need not hold" in str(fit["message"].item())) == (of_eps_f > 2.0)


def below_zero(variable="kappa"):
    dataset = campaign(coefficients={"eps_c": 0.4, "eps_f": 300.0, "eps_t": 0.3}, realisations=15, cross=CROSS)
    dataset["kappa"] = dataset["kappa"] - 2.2 + 0.01 * np.random.default_rng(1).standard_normal(dataset["kappa"].shape)
    assert (dataset["kappa"] > 0.0).all()
    return dataset.rename(kappa=variable)


@pytest.mark.usefixtures("laws_that_hold")
def test_a_limit_that_its_variable_cannot_have_is_refused():
    assert_refused(fit_tfc(below_zero(), fixed=ALPHA), "kappa_tfc would be -0.2", "kappa is never below 0", "of eps_f")
    lost = fit_tfc(below_zero("energy_lost"), "energy_lost", fixed=ALPHA)
    assert lost["energy_lost_tfc"] == pytest.approx(-0.2, abs=0.1)  # which may have both signs
    assert lost["energy_lost_tfc_low"] < -0.1


@pytest.mark.usefixtures("laws_that_hold")
def test_a_share_that_may_be_1_is_at_most_1():
    """It has the moments of a normal distribution that is cut there."""
    dataset = campaign(coefficients=dict.fromkeys(REFERENCE, 0.0), realisations=100).rename(kappa="stick_fraction")
    noise = np.random.default_rng(2).normal(scale=0.02, size=(1, 100))
    dataset["stick_fraction"] = dataset["stick_fraction"] - 0.9998 + (noise - noise.mean())
    fit = fit_tfc(dataset, "stick_fraction", fixed=ALPHA).isel(group=0)
    assert fit["stick_fraction_tfc_high"] == 1.0
    whole = fit_tfc(dataset.assign(kappa_r=dataset["stick_fraction"]), "kappa_r", fixed=ALPHA).isel(group=0)
    value, error = float(whole["kappa_r_tfc"]), float(whole["kappa_r_tfc_error"])
    assert value > 1.0
    cut = scipy.stats.truncnorm(-np.inf, (1.0 - value) / error, value, error)
    assert float(fit["stick_fraction_tfc"]) == pytest.approx(cut.mean())
    assert float(fit["stick_fraction_tfc_error"]) == pytest.approx(cut.std())


@pytest.mark.parametrize(
    ("stretches", "closed", "limits", "refused"),
    [
        (2.5, 0.01, {}, True),
        (3.5, 0.01, {}, False),
        (2.5, 0.9, {}, False),  # contacts have merged
        (2.5, 0.01, {"eps_t": [1 / 2]}, False),  # which is not extrapolated
    ],
)
def test_contacts_of_the_highest_hill_alone_have_no_limit_in_eps_t(stretches, closed, limits, refused):
    levels = {
        "eps_c": [1 / 2, 1 / 4, 1 / 8],
        "eps_f": [1 / 256, 1 / 512, 1 / 1024, 1 / 2048],
        "eps_t": [1, 1 / 2, 1 / 4],
    }
    dataset = campaign(levels=levels | limits)
    dataset = dataset.assign(
        n_segments=dataset["kappa"] * 0.0 + stretches, contact_area_fraction_counted=dataset["kappa"] * 0.0 + closed
    )
    varied = {limit: alpha for limit, alpha in ALPHA.items() if limit not in limits}
    fit = fit_tfc(dataset, fixed=varied)
    if refused:
        said = "only the highest hill of a period touches at eps_t = 1/4: contacts have 2.5 stretches on average"
        assert_refused(fit, said, "take a finer eps_t")
    else:
        assert (fit["fit_status"] == "ok").all()
