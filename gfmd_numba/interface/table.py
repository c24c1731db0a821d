"""The table of interaction laws: pure data, in the order of the scene file.

What a law acts on, and what it needs, stands with its record, where the rules between the laws of a scene read it too.
"""

from dataclasses import dataclass

from gfmd_numba.scene.interface_records import Cohesive, Exponential, Friction, HardWall


@dataclass(frozen=True)
class Law:
    """A law: its title, the record that describes it in a scene, and the class that computes it.

    `implementation` is "module:class"; None: the law has no function to compute, it is a flag or a number.
    """

    title: str
    record: type[HardWall | Exponential | Cohesive | Friction]
    implementation: str | None = None


LAWS = {
    "hard_wall": Law("hard wall", HardWall),
    "exponential": Law("exponential law", Exponential, "gfmd_numba.interface.exponential:ExponentialLaw"),
    "cohesive": Law("cohesive law", Cohesive, "gfmd_numba.interface.xu_needleman:XuNeedlemanLaw"),
    "friction": Law("friction", Friction),
}
