"""Campaign files that ask for a fit that makes no sense."""

import pytest

from gfmd_numba.campaign.file import load_campaign
from support.faulty_files import CAMPAIGN, assert_complaint

EXPONENT = "a finite number above 0, or the range it lies in, [low, high]"


FITS = {
    "unknown variable of the fit": (
        ("numerics: {solver: auto}", "fit: {variable: kapa}"),
        "bad.yaml:12:17: fit.variable: you gave 'kapa'; gfmd allows one of 'kappa', 'kappa_counted', 'kappa_r', "
        "'contact_area_fraction', 'contact_area_fraction_counted', ",
    ),
    "unknown sharing of exponents": (
        ("numerics: {solver: auto}", "fit: {exponents: both}"),
        "bad.yaml:12:18: fit.exponents: you gave 'both'; gfmd allows one of 'shared', 'free'",
    ),
    "exponent of a limit without levels": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_f: 1}}"),
        "bad.yaml:12:22: fit.fixed.eps_f: you gave 1; gfmd allows nothing for eps_f, which has no levels under",
    ),
    "unknown key of the fit": (
        ("numerics: {solver: auto}", "fit: {fix: {eps_t: 1}}"),
        "bad.yaml:12:7: fit.fix: you gave an unknown key; gfmd allows one of 'variable', 'step', 'exponents', 'fixed'",
    ),
    "exponent of no limit": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_x: 1}}"),
        "bad.yaml:12:15: fit.fixed.eps_x: you gave an unknown key; gfmd allows one of 'eps_c', 'eps_f', 'eps_t'",
    ),
    "exponents without limits": (
        ("numerics: {solver: auto}", "fit: {fixed: 1}"),
        "bad.yaml:12:14: fit.fixed: you gave 1; gfmd allows a mapping of 'eps_c', 'eps_f', 'eps_t'",
    ),
    "exponent of 0": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: 0}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave 0; gfmd allows {EXPONENT}",
    ),
    "infinite exponent": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: .inf}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave inf; gfmd allows {EXPONENT}",
    ),
    "exponent of nan": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: .nan}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave nan; gfmd allows {EXPONENT}",
    ),
    "exponent that is no number": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: one}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave 'one'; gfmd allows {EXPONENT}",
    ),
    "quoted exponent": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: '1'}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave '1'; gfmd allows {EXPONENT}; did you mean 1 without quotes?",
    ),
    "boolean exponent": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: true}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave true; gfmd allows {EXPONENT}",
    ),
    "range of exponents upside down": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: [1, 1/2]}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave [1, 0.5]; gfmd allows {EXPONENT}",
    ),
    "range of exponents from 0": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: [0, 1]}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave [0, 1]; gfmd allows {EXPONENT}",
    ),
    "endless range of exponents": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: [1, .inf]}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave [1, inf]; gfmd allows {EXPONENT}",
    ),
    "range of exponents with three ends": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: [0.5, 0.7, 1]}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave [0.5, 0.7, 1]; gfmd allows {EXPONENT}",
    ),
    "empty range of exponents": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: []}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave []; gfmd allows {EXPONENT}",
    ),
    "range of exponents in words": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: [low, high]}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: you gave ['low', 'high']; gfmd allows {EXPONENT}",
    ),
}


@pytest.mark.parametrize("name", FITS)
def test_a_bad_fit_is_refused_where_it_is_wrong(tmp_path, name):
    assert_complaint(tmp_path, load_campaign, CAMPAIGN, *FITS[name])
