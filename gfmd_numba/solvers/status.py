"""How a run ended: the one function that makes a result `ok`, and the one that withdraws it.

`certified` makes runs of a solver `ok`, by the residual that `certificate.py` defines: `equilibrium.py`,
`boundary_value_problem.py` and `distributed_newton.py` call it. In `equilibrium.py`, a run whose tractions grow without
bound is `unstable`, or has `no_equilibrium` if the body is incompressible. Later, `withdrawn` replaces `ok` where

    file                        status            because
    contact/solution.py         no_equilibrium    the body touches beyond any window without a period
    contact/two_step.py         too_steep         rounds of rough bodies do not settle, or the next order is too large
    contact/boundary_values.py  too_steep         rounds of a rough body under prescribed values do not settle
    contact/plastic_flow.py     flows_on          the plastic strain does not reach its residual (`RESIDUAL_RATIO`)
    contact/evaluation.py       nonfinite         a field or a measure is not finite

A path ends at its first step that is not `ok`, and has the status of this step (`contact/load_path.py`).
"""

from collections.abc import Mapping
from enum import IntEnum
from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Flags, Indices, Reals


class Status(IntEnum):
    """How a run ended; only `ok` results are used."""

    ok = 0
    steps_used_up = 1
    stagnated = 2
    too_steep = 3
    no_equilibrium = 4
    unstable = 5
    nonfinite = 6
    flows_on = 11


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
        "There is no equilibrium: an incompressible slab keeps its volume and has no room for so deep a punch, or the "
        "body around a window without a period bulges without end. Lower the displacement, or the load."
    ),
    Status.unstable: "Tractions grew without bound: lower numerics.time_step.",
    Status.nonfinite: (
        "A traction was no finite number: look for heights, loads or stiffnesses beyond the range of numbers."
    ),
    Status.flows_on: (
        "The plastic flow inside the body did not come to rest within the iterations of an increment. The body nearly "
        "yields at all depths, or strains are large: press less, give the plasticity a hardening or more increments, "
        "or raise numerics.residual."
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


def certified(residual: Reals | float, asked: float, otherwise: Reals | int) -> npt.NDArray[np.int8]:
    """Return `ok` where a residual is at most the one asked for, `nonfinite` where it is nan, else `otherwise`."""
    found = np.where(np.isnan(residual), Status.nonfinite, otherwise)
    return np.where(residual <= asked, Status.ok, found).astype(np.int8)


def withdrawn(status: npt.NDArray[np.int8] | int, failed: Flags | bool, becomes: Status) -> npt.NDArray[np.int8]:
    """Return statuses in which those that are `ok` where a check has `failed` become another; others stay."""
    return np.where(failed & (np.asarray(status) == Status.ok), becomes, status).astype(np.int8)


_SMALL = 1e-3  # residual above which, in double precision, a run has not yet begun to converge
_BETTER = 0.9  # of the least residual so far: what is above is no progress
_RISEN = 100.0  # times the least residual: what is above has left it, as a contact that jumps, and begins anew
_LOOKS = 50  # without progress at least
_SHARE = 2.0  # looks without progress over those that it took to get there


class Stagnation:
    """Watch the residuals of some rows, and tell which of them have stopped falling.

    The residual of a row has stopped falling if its least value was reached in the first third of the run, has not
    fallen by a tenth since, and the residual has stayed near it. A run that converges as slowly as t^-0.1 still falls
    by more.
    """

    def __init__(self, rows: int) -> None:
        self._least, self._reached, self._looks = np.full(rows, np.inf), np.zeros(rows, dtype=np.int64), 0

    def look(self, residual: Reals, active: Indices) -> Flags:
        """Return which of the active rows have stopped, by their residuals `[active]`; to be called once a look."""
        self._looks += 1
        least = self._least[active]
        with np.errstate(invalid="ignore"):
            moved = (residual < _BETTER * least) | (residual > _RISEN * least)
        self._least[active[moved]], self._reached[active[moved]] = residual[moved], self._looks
        reached = self._reached[active]
        stays = self._looks - reached >= np.maximum(_LOOKS, _SHARE * reached)
        return np.asarray(stays & (self._least[active] <= _SMALL))
