"""Friction whose limit depends on the slip rate of a node, or is a function of the user.

The coefficient at rest rises as that of velocity strengthening, a ln(1 + v / v0) (Bar-Sinai et al., Lubricants 7:91,
2019): far above v0 it is the logarithm of rate and state laws, far below v0 constant, so that nodes may stick. Or it is
linear between the values of a table. The slip rate is the slip of a step over its duration.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.text.input_error import InputError

_SHORT = 1e-6  # relative difference of pressures and slip rates between which the slope of a function is taken


class FrictionLimit(NamedTuple):
    """Friction limit of nodes `[node]`, and its slopes by the pressure and by the slip."""

    limit: Reals
    by_pressure: Reals
    by_slip: Reals


@dataclass(frozen=True)
class UserFunction:
    """Traction in Pa by gap in m, pressure in Pa and slip rate in m/s, in units of `stress` and `speed`."""

    function: Callable[[Reals, Reals, Reals], Reals]
    stress: float
    speed: float

    def __call__(self, pressure: Reals, rate: Reals) -> Reals:
        """Traction `[node]` of touching nodes, whose gap is 0; raises InputError for one that is none."""
        given = self.function(np.zeros_like(pressure), pressure * self.stress, rate * self.speed)
        found = np.asarray(given)
        is_real = found.dtype.kind in "iuf" and found.shape in ((), pressure.shape)
        if not is_real or not (np.isfinite(found).all() and (found >= 0.0).all()):
            allowed = "a function that returns a finite traction of at least 0 Pa for each pressure and slip rate"
            raise InputError(f"scene.interface.friction.function: gfmd allows {allowed}")
        return np.broadcast_to(found, pressure.shape) / self.stress


@dataclass(frozen=True)
class SlipRateFriction:
    """Friction with the limit min(c(v) p, shear_strength + shear_rise p) at the pressure p and the slip rate v.

    The coefficient c is `friction` at rest. It follows the table of `rates` and `coefficients`, which begins at rest,
    or without a table c = friction + strengthening ln(1 + v / reference). A function of the user may stand for the
    second limit. A step takes `duration`. Stresses in g E*, rates in g L_x per unit of time, which is the longest
    relaxation time, or 1 s without one.
    """

    friction: float
    strengthening: float = 0.0
    reference: float = 1.0
    rates: tuple[float, ...] = ()
    coefficients: tuple[float, ...] = ()
    shear_strength: float | UserFunction = np.inf
    shear_rise: float = 0.0
    duration: float = 0.0

    def lasting(self, duration: float) -> Self:
        """The same in a step of a duration."""
        return replace(self, duration=duration)

    def friction_limit(self, pressure: Reals, slip: Reals) -> Reals:
        """Largest tangential traction `[node]` by pressure and slip; 0 where the pressure is not positive."""
        return self.limit_and_slopes(pressure, slip).limit

    def linearised(self, pressure: Reals, slip: Reals) -> tuple[Reals, Reals, Reals]:
        """Constant part, part per pressure and part per further slip of the limit `[node]` near pressure and slip.

        A limit that falls with the slip counts as constant in it, which keeps the problem of a guess positive.
        """
        limit, by_pressure, by_slip = self.limit_and_slopes(pressure, slip)
        return limit - by_pressure * np.maximum(pressure, 0.0), by_pressure, np.maximum(by_slip, 0.0)

    def limit_and_slopes(self, pressure: Reals, slip: Reals) -> FrictionLimit:
        """Friction limit `[node]` by pressure and slip, and its slopes."""
        pressure, rate = np.maximum(pressure, 0.0), slip / self.duration
        coefficient, by_rate = self._coefficient(rate)
        strength, rise, strength_by_pressure, strength_by_rate = self._strength(pressure, rate)
        limit = kernels.friction_limit(pressure, coefficient, strength, rise)
        limited = coefficient * pressure > limit
        by_rate = np.where(limited, strength_by_rate, by_rate * pressure)
        return FrictionLimit(limit, np.where(limited, strength_by_pressure, coefficient), by_rate / self.duration)

    def _coefficient(self, rate: Reals) -> tuple[Reals, Reals]:
        """Coefficient at a slip rate, and its slope."""
        if self.rates:
            known = np.array((self.rates, self.coefficients))
            slopes = np.append(np.diff(known[1]) / np.diff(known[0]), 0.0)
            return np.interp(rate, *known), slopes[np.searchsorted(known[0], rate, side="right") - 1]
        rises = self.strengthening * np.log1p(rate / self.reference)
        return self.friction + rises, self.strengthening / (self.reference + rate)

    def _strength(self, pressure: Reals, rate: Reals) -> tuple[Reals | float, float, Reals | float, Reals | float]:
        """Shear strength, the rise it has besides, and its slopes by pressure and slip rate, with the rise."""
        if not isinstance(self.shear_strength, UserFunction):
            return self.shear_strength, self.shear_rise, self.shear_rise, 0.0
        found, slopes = self.shear_strength(pressure, rate), []
        for i, values in enumerate((pressure, rate)):
            least = _SHORT * float(values.max(initial=0.0)) or _SHORT
            short = np.maximum(_SHORT * values, least)
            moved = [pressure, rate]
            moved[i] = values + short
            slopes.append((self.shear_strength(*moved) - found) / short)
        return found, 0.0, slopes[0], slopes[1]
