"""What is known of the laws of discretisation corrections before there are data."""

from collections.abc import Mapping
from math import isnan, nan

_STEEPEST = 0.6  # exponent with which the part of a wave that contacts miss falls with its index, or more
_SLACK = 0.75


_OF_THE_SLOPE = ("kappa", "kappa_counted", "kappa_edges")  # areas over p / (g E*)


def has_slope_law(variable: str, hurst: float) -> bool:
    """Whether the share of g^2 that contacts do not see gives the law of a variable in eps_f, without an exponent."""
    return variable in _OF_THE_SLOPE and 0.0 <= hurst <= 1.0


def exponent_ranges(dimension: int, hurst: float = nan) -> Mapping[str, tuple[float, float]]:
    """Return the range of each exponent of kappa and areas, by the dimension of the surfaces and the Hurst exponent.

    In eps_c: of corrected contact lengths 2 to 3, as measured between 1/2 and 1/8 (H = 0 to 0.5, p* = 0.001 to 0.05,
    half-spaces and a slab), of corrected areas less. In eps_f: the part of g^2 beyond a wave falls with its index to
    the power 2 - 2 H, and corrections with that or with the part of a wave that contacts miss, whichever falls more
    slowly. In eps_t: 1, as of edges. A Hurst exponent that is nan is not known.
    """
    slowest = 0.2 if isnan(hurst) else round(max(0.1, _SLACK * min(2.0 - 2.0 * hurst, _STEEPEST)), 2)
    return {
        "eps_c": (2.0, 3.0) if dimension == 1 else (1.0, 2.0),
        "eps_f": (slowest, 2.0),
        "eps_t": (0.5, 1.5),
    }
