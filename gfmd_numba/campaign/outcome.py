"""How a simulation of a campaign ended: as its solver says, or without one that could."""

from enum import IntEnum

from gfmd_numba.solvers import status
from gfmd_numba.solvers.status import Status


class Outcome(IntEnum):
    """How a simulation ended; only `ok` results are used."""

    ok = Status.ok.value
    steps_used_up = Status.steps_used_up.value
    stagnated = Status.stagnated.value
    too_steep = Status.too_steep.value
    no_equilibrium = Status.no_equilibrium.value
    unstable = Status.unstable.value
    nonfinite = Status.nonfinite.value
    timeout = 7
    crashed = 8
    unfinished = 9
    not_asked = 10


SENTENCES: dict[IntEnum, str] = {
    **{Outcome(ended): sentence for ended, sentence in status.SENTENCES.items()},
    Outcome.timeout: (
        "The block took longer than case_timeout: raise it, and run the block again with `gfmd run --retry-failed`."
    ),
    Outcome.crashed: (
        "The program or its worker broke down: `gfmd status` gives the reason and the command that runs it again."
    ),
    Outcome.unfinished: "The simulation has not run yet: `gfmd run` resumes.",
    Outcome.not_asked: "The case has fewer realisations than others: nothing is missing.",
}
