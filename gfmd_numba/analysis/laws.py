"""Laws by which a correction goes to 0 with its discretisation, and the priors of their parameters.

A correction is a coefficient times its law, a function of eps with parameters of its own. Thesis (4.3) takes powers
eps^alpha. The fractal limit of kappa has a law from theory: contacts lie on the crests of the longest waves, whose
slope they do not see, so that kappa = kappa_tfc / sqrt(1 - S). S is the part of g^2 in the waves that contacts do not
see. The spectrum gives S at every eps_f, and at H = 1 too, where no power has the right limit.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy  # its modules load with their first use

from gfmd_numba.analysis.selection import Group
from gfmd_numba.arrays import Reals
from gfmd_numba.theory.exponent_ranges import has_slope_law

BOUNDS = (0.1, 5.0)  # of an exponent of which nothing is known
FREE = (np.nan, np.nan)
STEEPEST = 0.9  # Hurst exponent whose exponent of eps_f, 0.2, can be told from 0
# Wave index, over that of the longest wave, from which half of the slope is seen, and the exponent with which the part
# that is not seen falls beyond. Contacts see the waves that are shorter than themselves, and so the index falls with
# the reduced pressure p*. Both were measured at 1/eps_t = 8 on half-spaces (H = 0.3 to 1, p* = 0.001 to 0.3) and a
# slab, and on maps. Next to their medians stands the factor of a standard deviation, which is smaller for contacts like
# those of the measurements than for all others
_CUTS, _TAILS = (0.02, 200.0), (0.25, 2.5)
_CUT = {1: (0.055, 6.0, 0.55), 2: (0.0077, 5.0, 0.75)}  # by the dimension of the surfaces: constants of k_c's formula
_FACTORS = {True: (1.15, 1.06), False: (1.4, 1.2)}  # of k_c and m, by whether the contacts are like those measured
_FURTHEST = 5.0  # of those standard deviations
POWER, UNSEEN_SLOPE = "power", "unseen slope"  # names of laws
_POINTS = 128  # of the integrals over a spectrum
gauss = cache(np.polynomial.legendre.leggauss)

Given = Mapping[str, tuple[float, float]]  # ends of the range of each exponent that is not free


@dataclass(frozen=True)
class Parameter:
    """A parameter of the law of a limit, and the range it lies in: all its values, or logarithms, are as likely.

    Logarithms of one with a median and a factor that are `usual` have a normal distribution in its range.
    """

    limit: str
    low: float
    high: float
    logarithmic: bool = False
    usual: tuple[float, float] | None = None

    @property
    def is_free(self) -> bool:
        """Whether it is an exponent of which nothing is known."""
        return self.logarithmic and (self.low, self.high) == BOUNDS

    @property
    def ends(self) -> tuple[float, float]:
        """Ends of the range of its values or logarithms."""
        low, high = self.positions(np.array([self.low, self.high])).tolist()
        return low, high

    @property
    def middle(self) -> float:
        """The usual value, or the one in the middle of the range."""
        return self.usual[0] if self.usual is not None else float(self.values(np.array([np.mean(self.ends)]))[0])

    @property
    def variance(self) -> float:
        """Variance before there are data, of its values or logarithms; 0 if it is known."""
        return float(np.log(self.usual[1]) ** 2 if self.usual is not None else np.diff(self.ends)[0] ** 2 / 12.0)

    def values(self, positions: Reals) -> Reals:
        """Return the values at positions between its ends."""
        return np.exp(positions) if self.logarithmic else positions

    def positions(self, values: Reals) -> Reals:
        """Return the positions of values."""
        return np.log(values) if self.logarithmic else values

    def log_density(self, positions: Reals) -> Reals:
        """Return the logarithm of how likely positions are before there are data."""
        low, high = self.ends
        if self.usual is None:
            return np.full(positions.shape, -np.log(high - low) if high > low else 0.0)
        median, factor = np.log(self.usual)
        within = scipy.special.ndtr((high - median) / factor) - scipy.special.ndtr((low - median) / factor)
        scale = np.sqrt(2.0 * np.pi) * factor * within
        return np.asarray(-(((positions - median) / factor) ** 2) / 2.0 - np.log(scale))


@dataclass(frozen=True)
class Law:
    """The law of a limit: `value` maps eps (level) and parameters (node, parameter) to values (node, level).

    The correction of the limit is a coefficient times the value. The value of a law that `scales_limit` is the
    correction over the TFC limit: such a law has no coefficient of its own.
    """

    parameters: tuple[Parameter, ...]
    value: Callable[[Reals, Reals], Reals]
    scales_limit: bool = False

    @property
    def name(self) -> str:
        """How it is called."""
        return UNSEEN_SLOPE if self.scales_limit else POWER


def power(limit: str, given: Given) -> Law:
    """Return eps^alpha of thesis (4.3), alpha exact, in a range or, where nothing is given, free."""
    low, high = given.get(limit, FREE)
    free = np.isnan(low)
    parameter = Parameter(limit, *(BOUNDS if free else (low, high)), logarithmic=free)
    return Law((parameter,), lambda eps, alpha: np.exp(alpha[:, :1] * np.log(eps)))


def unseen_slope(hurst: float, load: float = np.nan, dimension: int = 1, is_measured: bool = False) -> Law:
    """Return the law of the fractal limit of kappa from the share of g^2 that contacts do not see.

    Of a wave of index k the part 1 / (1 + (k / k_c)^m) is not seen; the parameters are k_c, over the index of the
    longest wave of the power law, and m. The spectrum of the slopes is k^(1 - 2 H) from there to 1 / eps_f. The `load`
    is the reduced pressure p / (g E*), nan where it is not known; `is_measured` if k_c and m were measured on contacts
    of this kind.
    """
    nodes, weights = gauss(_POINTS)

    def value(eps: Reals, parameters: Reals) -> Reals:
        once, same = np.unique(parameters @ [1.0, 1.0j], return_inverse=True)  # nodes of other limits repeat them
        half, steepness = np.log(once.real[:, np.newaxis, np.newaxis]), once.imag[:, np.newaxis, np.newaxis]
        octaves = -np.log(eps)
        index = octaves[:, np.newaxis] * (1.0 + nodes) / 2.0  # logarithms of the wave index (level, point)
        slope = weights * np.exp((2.0 - 2.0 * hurst) * (index - octaves[:, np.newaxis]))
        unseen = (slope / (1.0 + np.exp(steepness * (index - half)))).sum(axis=-1) / slope.sum(axis=-1)
        # 1 / sqrt(1 - unseen) - 1, of which in full contact next to nothing is left
        return np.asarray(np.expm1(-0.5 * np.log1p(-unseen[same])))

    factor_of_cuts, factor_of_tails = _FACTORS[is_measured]
    cut = Parameter("eps_f", *_CUTS, logarithmic=True)
    if load > 0.0:
        factor, rate, power_of_load = _CUT[dimension]
        median = factor * np.exp(3.0 * hurst - rate * load) * load**-power_of_load
        furthest = factor_of_cuts**_FURTHEST
        ends = (median / furthest, median * furthest)
        cut = Parameter("eps_f", *ends, logarithmic=True, usual=(median, factor_of_cuts))
    usual_tail = (float(np.exp(0.25 - 0.95 * hurst)), factor_of_tails)
    tail = Parameter("eps_f", *_TAILS, logarithmic=True, usual=usual_tail)
    return Law((cut, tail), value, scales_limit=True)


def choices(limits: Sequence[str], groups: Sequence[Group], given: Given) -> list[dict[str, Law]]:
    """Return the laws of each limit that a fit of groups chooses from.

    The law from theory holds for kappa and one Hurst exponent, where no exponent of eps_f is imposed. Powers stand
    next to it where a range of their exponents is given, but for those near H = 1. Layers that stay thin are stiffer
    or softer for long waves than for short ones, so that nothing is known of k_c before there are data.
    """
    hursts, loads = [group.parameters.get("hurst", np.nan) for group in groups], [group.load for group in groups]
    powers = {limit: power(limit, given) for limit in limits}
    low, high = given.get("eps_f", FREE)
    if (
        "eps_f" not in limits
        or len(set(hursts)) != 1
        or not has_slope_law(groups[0].variable, hursts[0], float(np.min(loads)))
        or low == high
    ):
        return [powers]
    as_on_half_spaces = not any(group.has_thin_layers for group in groups)
    load = loads[0] if len(set(loads)) == 1 and as_on_half_spaces else np.nan  # k_c depends on it
    is_measured = as_on_half_spaces and all(group.has_measured_slope_law for group in groups)
    from_theory = powers | {"eps_f": unseen_slope(hursts[0], load, groups[0].dimension, is_measured)}
    return [powers, from_theory] if "eps_f" in given and hursts[0] <= STEEPEST else [from_theory]


def given_ranges(fixed: Mapping[str, float | Sequence[float]]) -> Given:
    """Return the ends of the range of each fixed exponent."""
    ends = {limit: each if isinstance(each, Sequence) else (each, each) for limit, each in fixed.items()}
    return {limit: (float(low), float(high)) for limit, (low, high) in ends.items()}
