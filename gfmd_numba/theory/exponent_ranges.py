"""What is known of the laws of discretisation corrections before there are data."""

from collections.abc import Mapping
from math import inf, isnan, nan

_STEEPEST = 0.6  # exponent with which the part of a wave that contacts miss falls with its index, or more
_SLACK = 0.75

AREAS_OVER_LOAD = ("kappa", "kappa_counted", "kappa_edges")  # a_r g E* / p
AT_ONE_LOAD = ("contact_area_fraction", "contact_area_fraction_counted")  # in proportion to them at one p / (g E*)
SHARES = (*AT_ONE_LOAD, "plastic_area_fraction", "stick_fraction")  # which are at most 1
OF_ONE_SIGN = (  # that of the load, or none: what is always above 0 in contacts that are pressed
    *(*AREAS_OVER_LOAD, "kappa_r", "rms_gradient_contact", "contact_radius", "elastic_energy", "mean_gap"),
    *("mean_plastic_depth", "mean_worn_depth"),
)
_COUNTED, _PLASTIC, _OF_GRADIENT, _OF_HEIGHTS = (0.75, 1.5), (0.5, 1.5), (1.25, 2.75), (1.5, 4.0)
_IN_EPS_C = {  # of profiles; what is not named has that of corrected contact lengths
    "kappa_counted": _COUNTED,
    "contact_area_fraction_counted": _COUNTED,
    "kappa_edges": (1.0, 3.0),
    "plastic_area_fraction": _PLASTIC,
    "kappa_r": _OF_GRADIENT,
    "rms_gradient_contact": _OF_GRADIENT,
    "mean_gap": _OF_HEIGHTS,
    "elastic_energy": _OF_HEIGHTS,
    "mean_plastic_depth": _OF_HEIGHTS,
}
_CORRECTED = {1: (2.0, 3.0), 2: (1.0, 2.0)}  # by the dimension of the surfaces
_AT_LEAST = {1: (inf, -inf), 2: _CORRECTED[2]}  # of any variable: only those of kappa were measured on maps
_AREAS = (*AREAS_OVER_LOAD, *AT_ONE_LOAD, "kappa_r")
_IN_EPS_T, _AS_OF_EDGES = {1: (1.0, 2.0), 2: (1.5, 3.0)}, {1: (0.5, 1.5), 2: (0.5, 3.0)}


def has_slope_law(variable: str, hurst: float, load: float = nan) -> bool:
    """Whether the share of g^2 that contacts do not see gives the law of a variable in eps_f, without an exponent.

    The `load` is the reduced pressure p / (g E*) of all levels, nan if it is not the same or not known.
    """
    known = variable in AREAS_OVER_LOAD or (variable in AT_ONE_LOAD and load > 0.0)
    return known and 0.0 <= hurst <= 1.0


def possible_values(variable: str, sign: float = 1.0) -> tuple[float, float]:
    """Return the least and the largest value that a variable can have whose results all have a sign, 1 or -1."""
    if variable not in SHARES and variable not in OF_ONE_SIGN:
        return -inf, inf
    most = 1.0 if variable in SHARES else inf
    return (0.0, most) if sign > 0.0 else (-most, 0.0)


def exponent_ranges(variable: str, dimension: int, hurst: float = nan) -> Mapping[str, tuple[float, float]]:
    """Return the range of each exponent of a variable, by the dimension of the surfaces and the Hurst exponent.

    We measured the exponents of profiles with H = 0.3 and 0.8 and p* = 0.01 and 0.1 on 100 surfaces, from 1/eps_c = 1
    to 16, 1/eps_f = 16 to 4096 and 1/eps_t = 1 to 8. In eps_c: corrected contact lengths have 2 to 3 (also measured at
    H = 0 to 0.5, p* = 0.001 to 0.05, half-spaces and a slab), corrected areas of maps less. Counted nodes have 1.0 to
    1.3, nodes at the hardness 0.9 to 1.1 (0.6 to 0.95 at the coarsest), the gradient over the contact, and with it
    kappa_r, 1.1 to 2.6, and means over all nodes, whose corrections are below 1 %, 1.7 to 4. In eps_f: the part of g^2
    beyond a wave falls with its index to the power 2 - 2 H, and corrections with that or with the part of a wave that
    contacts miss, whichever falls more slowly. Corrections of means of heights at a fixed rms height grow with H
    instead: 0.13 to 0.4 at H = 0.3, and 0.7 to 1.3 at 0.8. In eps_t: 1.2 to 2.2 for kappa (H = 0.3 to 1, half-spaces
    and a slab, 1/eps_t = 2 to 8), 2.2 and more on maps, and of other means about 1, as of edges. Only the exponents of
    kappa were measured on maps, so that other variables have wider ranges there. A Hurst exponent that is nan is not
    known.
    """
    low, high = _IN_EPS_C.get(variable, _CORRECTED[dimension])
    low, high = min(low, _AT_LEAST[dimension][0]), max(high, _AT_LEAST[dimension][1])
    if _IN_EPS_C.get(variable) == _OF_HEIGHTS:
        slowest = 0.1 if isnan(hurst) else round(max(0.1, 0.5 * hurst), 2)
    else:
        slowest = 0.2 if isnan(hurst) else round(max(0.1, _SLACK * min(2.0 - 2.0 * hurst, _STEEPEST)), 2)
    return {
        "eps_c": (low, high),
        "eps_f": (slowest, 2.0),
        "eps_t": _IN_EPS_T[dimension] if variable in _AREAS else _AS_OF_EDGES[dimension],
    }
