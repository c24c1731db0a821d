"""What acts between the surfaces of a dimensionless problem."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import isinf
from pkgutil import resolve_name
from typing import Any, Self

import numpy as np

from gfmd_numba import kernels, scene
from gfmd_numba.arrays import Reals
from gfmd_numba.interface.normal_law import NormalLaw
from gfmd_numba.interface.patterned import PatternedLaw
from gfmd_numba.interface.table import LAWS
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw


@dataclass(frozen=True)
class Interactions:
    """What keeps the surfaces apart or together; an absent effect is None.

    `friction` is Coulomb's coefficient, infinite for touching nodes that stick, None for a frictionless interface.
    `hardness` bounds the pressure of the hard wall, `shear_limit` what friction holds, in g E*, which rises by
    `shear_rise` times the pressure. `laws` are the names of
    all that acts, as in the scene file.
    """

    hard_wall: bool
    normal_law: NormalLaw | None = None
    friction: float | None = None
    cohesive: XuNeedlemanLaw | None = None
    hardness: float | None = None
    shear_limit: float | None = None
    shear_rise: float = 0.0

    @classmethod
    def scaled(cls, asked: scene.Interface, length: float, energy: float) -> Self:
        """Interactions of a scene, their lengths and their energies per area over these."""
        computed: dict[str, Any] = {
            law.ability: resolve_name(law.implementation).scaled(law, length, energy)
            for law in asked.laws.values()
            if law.implementation is not None
        }
        rubs = asked.friction
        friction, limit, rise = (
            (None, None, 0.0) if rubs is None else (rubs.coefficient, rubs.limit, rubs.pressure_coefficient)
        )
        return cls(
            asked.hard_wall is not None,
            computed.get("normal law"),
            friction,
            computed.get("cohesive law"),
            None if asked.hardness is None else asked.hardness / (energy / length),
            None if limit is None else limit / (energy / length),
            rise,
        )

    def patterned(self, pattern: Reals, padded: tuple[int, ...]) -> Self:
        """Interactions whose law of the gap has a pattern `[(y,) x]`, on the grid `padded` around it."""
        assert self.normal_law is not None  # as the records say
        return replace(self, normal_law=PatternedLaw.of(self.normal_law, pattern, padded))

    @cached_property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws that act, as in the scene file."""
        acting = {self._path(law) for law in (self.normal_law, self.cohesive) if law is not None}
        flags = {"hard_wall": self.hard_wall, "friction": self.friction is not None}
        return tuple(name for name, law in LAWS.items() if flags.get(name) or law.implementation in acting)

    @cached_property
    def abilities(self) -> tuple[str, ...]:
        """What the laws ask of a solver."""
        more = {"hardness": self.hardness is not None, "sticking": self.friction is not None and isinf(self.friction)}
        return tuple(LAWS[name].ability for name in self.laws) + tuple(name for name, is_so in more.items() if is_so)

    @property
    def conditions(self) -> kernels.Conditions:
        """What holds at a node that touches."""
        hardness, limit = (np.inf if each is None else each for each in (self.hardness, self.shear_limit))
        return kernels.Conditions(hardness, self.friction or 0.0, limit, self.shear_rise)

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
