"""How a run ended."""

from collections.abc import Mapping
from enum import IntEnum
from typing import Any

import numpy as np


class Status(IntEnum):
    """How a run ended; only `ok` results are used."""

    ok = 0
    steps_used_up = 1
    stagnated = 2
    too_steep = 3
    no_equilibrium = 4
    unstable = 5
    nonfinite = 6


SENTENCES: dict[IntEnum, str] = {
    Status.ok: "The contact conditions hold to the residual that was asked for.",
    Status.steps_used_up: (
        "The solver took all the iterations that it may before the residual that was asked for was reached: raise "
        "numerics.max_iterations or numerics.residual, or choose another numerics.solver."
    ),
    Status.stagnated: (
        "The residual has stopped falling before it reached the one that was asked for, mostly because rounding hides "
        "the pressure: ask for a numerics.residual above the one that was found."
    ),
    Status.too_steep: (
        "The surface of an elastic body is too steep for its order in the slope: the rounds in which it follows the "
        "contact came to no rest, or the next order would add more than half of the largest displacement. Lower "
        "numerics.topography_order, leave out short waves of the surface, or press less."
    ),
    Status.no_equilibrium: (
        "There is no equilibrium: an incompressible slab keeps its volume and has no room for so deep a punch. Lower "
        "the displacement."
    ),
    Status.unstable: "Tractions grew without bound: lower numerics.time_step.",
    Status.nonfinite: (
        "A traction was no finite number: look for heights, loads or stiffnesses beyond the range of numbers."
    ),
}


def flag_attributes(sentences: Mapping[IntEnum, str]) -> dict[str, Any]:
    """CF attributes of a variable of states: their numbers, names and sentences, in the order of the numbers."""
    states = sorted(sentences)
    return {
        "flag_values": np.array([state.value for state in states], dtype=np.int8),
        "flag_meanings": " ".join(state.name for state in states),
        "flag_sentences": "\n".join(f"{state.name}: {sentences[state]}" for state in states),
    }
