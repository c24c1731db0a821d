"""The law of the fractal limit from theory, against integrals and their limits, and which laws a fit chooses from."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad, trapezoid

from gfmd_numba.analysis.laws import Parameter, choices, power, unseen_slope

PARAMETERS = [(1.0, 0.5), (3.0, 1.0), (30.0, 3.0), (200.0, 1 / 3)]  # k_c and m


def excess(hurst, eps, cut, tail):
    return unseen_slope(hurst).value(np.atleast_1d(eps), np.array([[cut, tail]]))[0]


@pytest.mark.parametrize(("cut", "tail"), PARAMETERS)
@pytest.mark.parametrize("hurst", [0.1, 0.5, 0.8, 0.95, 1.0])
def test_the_share_that_is_not_seen_is_that_of_the_spectrum(hurst, cut, tail):
    for eps in (1 / 2, 1 / 64, 1 / 4096, 1e-6):
        # of k^(1 - 2 H) dk over q = log k; what is seen is (k / k_c)^m / (1 + (k / k_c)^m)
        seen, total = (
            quad(integrand, 0, -np.log(eps), limit=400, epsrel=1e-11)[0]
            for integrand in (
                lambda q: np.exp((2 - 2 * hurst) * q) / (1 + (cut * np.exp(-q)) ** tail),
                lambda q: np.exp((2 - 2 * hurst) * q),
            )
        )
        assert excess(hurst, eps, cut, tail)[0] == pytest.approx((seen / total) ** -0.5 - 1, rel=1e-8)


@pytest.mark.parametrize(("cut", "tail"), PARAMETERS)
def test_at_hurst_1_the_integral_is_elementary(cut, tail):
    eps = np.geomspace(1 / 4, 1e-8, 9)
    octaves = -np.log(eps)
    unseen = octaves - (np.log1p((1 / (eps * cut)) ** tail) - np.log1p(cut**-tail)) / tail
    np.testing.assert_allclose(excess(1.0, eps, cut, tail), (1 - unseen / octaves) ** -0.5 - 1, rtol=1e-8)


def test_next_to_nothing_unseen_is_in_proportion_to_the_cut():
    """Nearly full contacts see all waves: the excess is far below the spacing of numbers around 1."""
    eps = np.array([1 / 2, 1 / 64, 1e-6])
    np.testing.assert_allclose(excess(0.8, eps, 1e-18, 1.0), 1e-3 * excess(0.8, eps, 1e-15, 1.0), rtol=1e-12)


def test_at_hurst_1_the_correction_falls_as_one_over_a_logarithm():
    cut, tail = 3.0, 2.0
    eps = np.array([1e-20, 1e-40])
    expected = np.log1p(cut**tail) / tail / -np.log(eps) / 2
    np.testing.assert_allclose(excess(1.0, eps, cut, tail), expected, rtol=0.05)
    assert abs(excess(1.0, eps, cut, tail) / expected - 1)[1] < 0.6 * abs(excess(1.0, eps, cut, tail) / expected - 1)[0]


@pytest.mark.parametrize(("hurst", "tail"), [(0.8, 2.0), (0.5, 0.35), (0.5, 0.5), (0.5, 3.0), (0.2, 1.0), (0.2, 2.5)])
def test_below_hurst_1_the_correction_falls_as_the_slower_of_two_powers(hurst, tail):
    expected = min(tail, 2 - 2 * hurst)
    eps = 10 ** (-np.array([6.0, 7.0]) / expected)
    found = np.diff(np.log(excess(hurst, eps, 2.0, tail)))[0] / np.diff(np.log(eps))[0]
    assert found == pytest.approx(expected, rel=0.05)


def test_a_power_is_that_of_thesis_4_3():
    law = power("eps_c", {"eps_c": (0.5, 2.0)})
    found = law.value(np.array([0.5, 0.1]), np.array([[2.0], [0.5]]))
    np.testing.assert_allclose(found, [[0.25, 0.01], [0.5**0.5, 0.1**0.5]])
    assert law.parameters[0].ends == (0.5, 2.0)
    assert not law.parameters[0].logarithmic
    free = power("eps_c", {}).parameters[0]
    assert (free.low, free.high, free.is_free, free.logarithmic) == (0.1, 5.0, True, True)


def test_without_a_usual_value_all_of_a_range_are_as_likely():
    """Or their logarithms; the variance is that of a uniform distribution."""
    even, octaves = Parameter("eps_c", 1.0, 4.0), Parameter("eps_c", 1.0, 4.0, logarithmic=True)
    assert (even.middle, even.variance) == pytest.approx((2.5, 0.75))
    assert (octaves.middle, octaves.variance) == pytest.approx((2.0, np.log(4.0) ** 2 / 12.0))
    assert even.log_density(np.array([1.0, 3.0])) == pytest.approx([-np.log(3.0)] * 2)
    assert Parameter("eps_c", 2.0, 2.0).log_density(np.array([2.0])) == [0.0]


LIMITS = ("eps_c", "eps_f", "eps_t")


def group(hurst, load, variable="kappa", has_measured_slope_law=False):
    return SimpleNamespace(
        variable=variable,
        dimension=1,
        parameters={"hurst": hurst},
        load=load,
        has_measured_slope_law=has_measured_slope_law,
        has_thin_layers=False,
    )


@pytest.mark.parametrize(
    ("variable", "hursts", "given", "from_theory"),
    [
        ("kappa", [0.8], {}, [True]),
        ("kappa_counted", [0.8, 0.8], {"eps_c": (1.0, 1.0)}, [True]),
        ("kappa", [0.8], {"eps_f": (0.3, 1.5)}, [False, True]),
        ("kappa", [0.8], {"eps_f": (0.5, 0.5)}, [False]),
        ("kappa", [1.0], {}, [True]),
        ("kappa", [0.91], {}, [True]),
        ("kappa", [0.91], {"eps_f": (0.3, 1.5)}, [True]),
        ("kappa", [0.9], {"eps_f": (0.3, 1.5)}, [False, True]),
        ("kappa_edges", [0.3], {}, [True]),
        ("kappa", [1.0], {"eps_f": (0.5, 0.5)}, [False]),
        ("kappa", [0.8, 0.3], {}, [False]),
        ("kappa", [np.nan], {}, [False]),
        ("kappa_r", [0.8], {}, [False]),
        ("mean_gap", [1.0], {}, [False]),
    ],
)
def test_the_law_from_theory_is_one_for_kappa_where_no_exponent_is_imposed(variable, hursts, given, from_theory):
    groups = [group(hurst, np.nan, variable) for hurst in hursts]
    found = choices(LIMITS, groups, given)
    assert [laws["eps_f"].scales_limit for laws in found] == from_theory
    assert not any(laws[limit].scales_limit for laws in found for limit in ("eps_c", "eps_t"))
    assert [laws["eps_f"].scales_limit for laws in choices(LIMITS[::2], groups, {}) if "eps_f" in laws] == []


@pytest.mark.parametrize(("loads", "from_theory"), [([0.05], True), ([0.05, 0.1], True), ([np.nan, 0.05], False)])
def test_the_law_from_theory_is_one_for_areas_whose_loads_are_known(loads, from_theory):
    (laws,) = choices(LIMITS, [group(0.8, load, "contact_area_fraction") for load in loads], {})
    assert laws["eps_f"].scales_limit == from_theory


def test_a_parameter_with_a_usual_value_has_logarithms_of_a_normal_distribution():
    parameter = Parameter("eps_f", 0.01, 100.0, logarithmic=True, usual=(0.8, 1.5))
    logarithms = np.linspace(*parameter.ends, 100_001)
    density = np.exp(parameter.log_density(logarithms))
    assert trapezoid(density, logarithms) == pytest.approx(1.0)
    mean = trapezoid(density * logarithms, logarithms)
    assert mean == pytest.approx(np.log(parameter.middle), abs=1e-9) == np.log(0.8)
    assert trapezoid(density * (logarithms - mean) ** 2, logarithms) == pytest.approx(parameter.variance)
    assert parameter.positions(parameter.values(logarithms)) == pytest.approx(logarithms)


@pytest.mark.parametrize("median", [1.0, 1.9, 3.0])
def test_what_is_likely_adds_up_to_one_over_a_range_that_cuts_a_distribution_off(median):
    parameter = Parameter("eps_f", 1.0, 2.0, logarithmic=True, usual=(median, 1.5))
    nodes, weights = np.polynomial.legendre.leggauss(20)
    low, high = parameter.ends
    density = np.exp(parameter.log_density(low + (high - low) * (1.0 + nodes) / 2.0))
    assert density @ weights * (high - low) / 2.0 == pytest.approx(1.0)


def test_contacts_see_shorter_waves_the_larger_the_load_is():
    """The medians of the index from which half the slope is seen, as fits at 1/eps_t = 8 found it (x 1.05 to 1.2)."""
    measured = {(0.3, 0.007): 2.4, (0.5, 0.007): 3.7, (0.8, 0.007): 8.9, (1.0, 0.007): 19.2, (0.8, 0.05): 1.8}
    measured |= {(0.8, 0.001): 30.4, (0.5, 0.001): 17.7, (1.0, 0.05): 6.2, (0.8, 0.3): 0.15}
    for (hurst, load), found in measured.items():
        cut, tail = unseen_slope(hurst, load).parameters
        assert abs(np.log(found) - np.log(cut.middle)) < 2.0 * cut.variance**0.5
        assert cut.low < found < cut.high
        assert tail.middle == pytest.approx(np.exp(0.25 - 0.95 * hurst))
    assert unseen_slope(0.8).parameters[0].usual is None  # of contacts whose load is not known


def test_more_is_known_of_contacts_like_those_measured():
    like, other = (unseen_slope(0.8, 0.007, is_measured=each).parameters for each in (True, False))
    assert [each.middle for each in like] == [each.middle for each in other]
    assert all(one.variance < 0.3 * each.variance for one, each in zip(like, other, strict=True))
    for measured, expected in (([True, True], like), ([True, False], other)):
        groups = [group(0.8, 0.007, has_measured_slope_law=each) for each in measured]
        assert choices(LIMITS, groups, {})[0]["eps_f"].parameters == expected


@pytest.mark.parametrize(
    ("loads", "expected"),
    [([0.007, 0.007], True), ([0.007, 0.05], False), ([-0.01], False), ([0.0], False), ([], False)],
)
def test_the_size_of_contacts_is_expected_for_one_load_that_presses(loads, expected):
    groups = [group(0.8, load) for load in loads] or [group(0.8, np.nan)]
    (laws,) = choices(LIMITS, groups, {})
    assert (laws["eps_f"].parameters[0].usual is not None) == expected
