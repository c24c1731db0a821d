"""How a run ended."""

from collections.abc import Mapping
from enum import IntEnum
from typing import Any

import numpy as np


class Status(IntEnum):
    """How a run ended; only `ok` results are used."""

    ok = 0
    not_converged = 1
    unstable = 2
    nonfinite = 3


SENTENCES: dict[IntEnum, str] = {
    Status.ok: "The contact conditions hold to the residual that was asked for.",
    Status.not_converged: (
        "The residual that was asked for was not reached. If it took fewer than max_iterations iterations, the "
        "residual has stopped falling, mostly because rounding hides the pressure: ask for a numerics.residual above "
        "the one that was found. Otherwise raise numerics.max_iterations or numerics.residual, or choose another "
        "numerics.solver. Where an elastic body is rough and steep, lower numerics.topography_order."
    ),
    Status.unstable: (
        "Tractions grew without bound: lower numerics.time_step, or press an incompressible slab no deeper than its "
        "volume allows."
    ),
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
