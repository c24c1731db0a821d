"""What is assumed of exponents before there are data."""

import pytest

from gfmd_numba.theory.exponent_ranges import exponent_ranges, has_slope_law


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


@pytest.mark.parametrize(("hurst", "slowest"), [(0.1, 0.1), (0.3, 0.15), (0.8, 0.4), (float("nan"), 0.1)])
def test_means_of_heights_converge_faster_the_smoother_a_surface_is(hurst, slowest):
    """With half of H at least; nothing is known of H where surfaces are measured."""
    assert exponent_ranges("mean_gap", 1, hurst)["eps_f"] == (pytest.approx(slowest), 2.0)
    assert exponent_ranges("kappa", 1)["eps_f"] == (0.2, 2.0)


@pytest.mark.parametrize(
    ("variable", "hurst", "load", "known"),
    [
        ("kappa", 0.0, None, True),
        ("kappa_counted", 1.0, None, True),
        ("kappa", 1.1, None, False),
        ("kappa", -0.1, None, False),
        ("kappa_r", 0.8, 0.1, False),
        ("contact_area_fraction", 0.8, 0.1, True),
        ("contact_area_fraction", 0.8, 0.0, False),
        ("contact_area_fraction", 0.8, None, False),
        ("contact_area_fraction", 1.1, 0.1, False),
    ],
)
def test_the_slope_that_is_not_seen_gives_the_law_of_areas_over_one_load(variable, hurst, load, known):
    assert has_slope_law(variable, hurst, *([] if load is None else [load])) is known
