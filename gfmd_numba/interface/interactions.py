"""What acts between the surfaces of a dimensionless problem."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, isinf
from pkgutil import resolve_name
from typing import Any, Self

import numpy as np

from gfmd_numba import kernels, scene
from gfmd_numba.arrays import Reals
from gfmd_numba.interface.normal_law import NormalLaw
from gfmd_numba.interface.patterned import PatternedLaw
from gfmd_numba.interface.slip_rate import SlipRateFriction, UserFunction
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.scene.interface_records import LAWS, Friction


@dataclass(frozen=True)
class Interactions:
    """What keeps the surfaces apart or together; an absent effect is None.

    `friction` is Coulomb's coefficient, infinite for touching nodes that stick, None for a frictionless interface.
    `hardness` (g E*) is the largest pressure of the hard wall. The tangential traction is at most `shear_strength`
    (g E*) plus `shear_rise` times the pressure. If friction depends on the slip rate or is a user's function,
    `slip_rate` gives its limit, and `friction` is the coefficient at rest. `laws` are the names of all that acts, as in
    the scene file.
    """

    hard_wall: bool
    normal_law: NormalLaw | None = None
    friction: float | None = None
    cohesive: XuNeedlemanLaw | None = None
    hardness: float | None = None
    shear_strength: float | None = None
    shear_rise: float = 0.0
    slip_rate: SlipRateFriction | None = None

    @classmethod
    def of(cls, asked: scene.Interface, units: tuple[float, float]) -> Self:
        """Interactions of a record in units of g L_x, g E* and the longest relaxation time.

        `units` are what a pressure of 1 is then in Pa, and a slip rate of 1 in m/s, as a function of the user wants.
        """
        computed: dict[str, Any] = {
            law.ability: resolve_name(law.implementation).of(law)
            for law in asked.laws.values()
            if law.implementation is not None
        }
        rubs = asked.friction
        friction, limit, rise = (
            (None, None, 0.0) if rubs is None else (rubs.coefficient, rubs.limit, rubs.pressure_coefficient or 0.0)
        )
        return cls(
            asked.hard_wall is not None,
            computed.get("normal law"),
            friction,
            computed.get("cohesive law"),
            asked.hardness,
            limit,
            rise,
            None if rubs is None or not rubs.depends_on_rate else _slip_rate(rubs, units),
        )

    def lasting(self, duration: float) -> Self:
        """The same in a step of a duration, which slip rates know."""
        return self if self.slip_rate is None else replace(self, slip_rate=self.slip_rate.lasting(duration))

    def friction_limit(self, pressure: Reals, slip: Reals) -> Reals:
        """Largest tangential traction by the pressure and the slip of a step."""
        limits = self.limits if self.slip_rate is None else self.slip_rate
        return limits.friction_limit(pressure, slip)

    def patterned(self, pattern: Reals, padded: tuple[int, ...]) -> Self:
        """Interactions whose law of the gap has a pattern `[(y,) x]`, on the grid `padded` around it."""
        assert self.normal_law is not None  # as the records say
        return replace(self, normal_law=PatternedLaw.of(self.normal_law, pattern, padded))

    @property
    def everywhere(self) -> Self:
        """The same without a pattern of the law of the gap."""
        law = self.normal_law
        return replace(self, normal_law=law.law) if isinstance(law, PatternedLaw) else self

    @cached_property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws that act, as in the scene file."""
        acting = {self._path(law) for law in (self.normal_law, self.cohesive) if law is not None}
        flags = {"hard_wall": self.hard_wall, "friction": self.friction is not None}
        return tuple(name for name, law in LAWS.items() if flags.get(name) or law.implementation in acting)

    @cached_property
    def abilities(self) -> tuple[str, ...]:
        """What the laws ask of a solver."""
        more = {
            "hardness": self.hardness is not None,
            "sticking": self.friction is not None and isinf(self.friction),
            "slip rate": self.slip_rate is not None,
        }
        return tuple(LAWS[name].ability for name in self.laws) + tuple(name for name, is_so in more.items() if is_so)

    @property
    def limits(self) -> kernels.ContactLimits:
        """Limits of the tractions of a node that touches."""
        hardness, limit = (np.inf if each is None else each for each in (self.hardness, self.shear_strength))
        return kernels.ContactLimits(hardness, self.friction or 0.0, limit, self.shear_rise)

    @property
    def softening(self) -> float:
        """How fast its law softens at most as the gap opens, the largest -d2(energy)/d(gap)2; 0 without one."""
        law = self.normal_law or self.cohesive
        return 0.0 if law is None else law.softening

    @property
    def slip_softening(self) -> float:
        """How fast its law softens at most as the surfaces slip, the largest -d2(energy)/d(slip)2; 0 without one."""
        return 0.0 if self.cohesive is None else self.cohesive.slip_softening

    @property
    def couples(self) -> bool:
        """Whether tangential tractions act, so that both displacements have to be followed."""
        return any(LAWS[name].tangential for name in self.laws)

    @staticmethod
    def _path(law: object) -> str:
        law = law.law if isinstance(law, PatternedLaw) else law
        return f"{type(law).__module__}:{type(law).__qualname__}"


def _slip_rate(rubs: Friction, units: tuple[float, float]) -> SlipRateFriction:
    limit = inf if rubs.limit is None else rubs.limit
    return SlipRateFriction(
        rubs.coefficient,
        rubs.velocity_strengthening or 0.0,
        rubs.reference_velocity or 1.0,
        (0.0, *rubs.slip_rates) if rubs.slip_rates else (),
        (rubs.coefficient, *rubs.coefficients) if rubs.slip_rates else (),
        limit if rubs.function is None else UserFunction(rubs.function, *units),
        rubs.pressure_coefficient or 0.0,
    )
