"""What acts between the surfaces of a dimensionless problem."""

from dataclasses import dataclass
from pkgutil import resolve_name
from typing import Self

from gfmd_numba import scene
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.table import LAWS
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw


@dataclass(frozen=True)
class Interactions:
    """What keeps the surfaces apart or together; an absent effect is None.

    `friction` is Coulomb's coefficient, infinite for touching nodes that stick, None for a frictionless interface.
    """

    hard_wall: bool
    exponential: ExponentialLaw | None = None
    friction: float | None = None
    cohesive: XuNeedlemanLaw | None = None

    @classmethod
    def scaled(cls, asked: scene.Interface, length: float, energy: float) -> Self:
        """Interactions of a scene, their lengths and their energies per area over these."""
        computed = {
            name: resolve_name(implementation).scaled(record, length, energy)
            for name, record in asked.laws.items()
            if (implementation := LAWS[name].implementation) is not None
        }
        friction = None if asked.friction is None else asked.friction.coefficient
        return cls(hard_wall=asked.hard_wall is not None, friction=friction, **computed)

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws that act, as in the scene file."""
        given = {name: getattr(self, name) for name in LAWS}
        return tuple(name for name, law in given.items() if law is not None and law is not False)

    @property
    def softening(self) -> float:
        """How fast its law softens at most as the gap opens, the largest -d2(energy)/d(gap)2; 0 without one."""
        law = self.exponential or self.cohesive
        return 0.0 if law is None else law.softening

    @property
    def couples(self) -> bool:
        """Whether tangential tractions act, so that both displacements have to be followed."""
        return any(LAWS[name].record.tangential for name in self.laws)
