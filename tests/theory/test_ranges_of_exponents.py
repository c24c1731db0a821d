"""What is assumed of exponents before there are data."""

import pytest

from gfmd_numba.theory.exponent_ranges import exponent_ranges


@pytest.mark.parametrize(("hurst", "slowest"), [(0.3, 0.45), (0.7, 0.45), (0.8, 0.3), (0.9, 0.15), (1.0, 0.1)])
def test_the_slope_beyond_a_wave_falls_with_2_minus_2_h_and_what_contacts_miss_of_it_no_more_than_so_much(
    hurst, slowest
):
    """Three quarters of the smaller exponent, and a tenth at least."""
    assert exponent_ranges("kappa", 1, hurst)["eps_f"] == (pytest.approx(slowest), 2.0)


@pytest.mark.parametrize("variable", ["kappa_counted", "plastic_area_fraction", "kappa_r", "mean_gap", "kappa_edges"])
def test_what_was_measured_on_profiles_alone_has_wider_ranges_on_maps(variable):
    """Those of profiles and those of kappa on maps."""
    found = exponent_ranges(variable, 2)["eps_c"]
    ends = exponent_ranges(variable, 1)["eps_c"], exponent_ranges("kappa", 2)["eps_c"]
    assert found == (min(low for low, _ in ends), max(high for _, high in ends))
    assert exponent_ranges("kappa", 2)["eps_c"] < exponent_ranges("kappa", 1)["eps_c"]
