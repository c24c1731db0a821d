"""A number and its error are written alike wherever they stand, to the second digit of the error."""

from math import inf, nan

import pytest

from gfmd_numba.text.numbers import with_error


@pytest.mark.parametrize(
    ("value", "error", "written"),
    [
        (9266.0, 1.4e3, "9300±1400"),
        (2.4093, 0.1123, "2.41±0.11"),
        (2.40934, 0.0996, "2.41±0.10"),
        (-0.0012, 0.00042, "-0.00120±0.00042"),
        (0.3, 1.44, "0.3±1.4"),
        (1.2345e6, 5e4, "(1.234±0.050)e+06"),
        (1e-7, 2.3e-9, "(1.000±0.023)e-07"),
        (0.0, 1.8e-5, "0±1.8e-05"),
        (-3e-7, 1.8e-5, "0±1.8e-05"),
        (0.0, 0.1, "0.00±0.10"),
    ],
)
def test_value_and_error_have_the_same_last_digit(value, error, written):
    assert with_error(value, error) == written


@pytest.mark.parametrize(
    ("value", "error", "written"),
    [(nan, 1.0, "-"), (2.40934, nan, "2.409"), (inf, 1.0, "inf"), (3.0, inf, "3±inf"), (3.0, 0.0, "3±0")],
)
def test_what_is_not_known_is_not_written_as_a_number(value, error, written):
    assert with_error(value, error) == written


def test_few_digits_need_no_power_of_ten():
    assert with_error(123.4, nan, digits=2) == "120"


@pytest.mark.parametrize("power", range(-290, 300, 10))
def test_no_number_is_long_or_lost(power):
    value, error = 2.34567 * 10.0**power, 1.2e-3 * 10.0**power
    written = with_error(value, error)
    assert len(written) < 24
    number, _, rest = written.strip("(").partition("±")
    exponent = rest.partition(")e")[2] or "0"
    assert float(f"{number}e{exponent}") == pytest.approx(value, rel=1e-3)
