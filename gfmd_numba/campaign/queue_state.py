"""How far the jobs of a run are in a queueing system."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

FORMAT = "%A %t %r"  # of squeue: number, compact state, and the reason for it
_AT_WORK, _ENDING = "R", "CG"  # states; a job in any other has not begun


@dataclass(frozen=True)
class QueueState:
    """How many jobs wait, why most of them do in the words of the queueing system, and how many run."""

    waiting: int = 0
    reason: str = ""
    running: int = 0

    @classmethod
    def of(cls, jobs: list[list[str]]) -> Self:
        """Count jobs, each given as the columns of `FORMAT`."""
        reasons = Counter(reason for _, state, reason in jobs if state not in (_AT_WORK, _ENDING))
        most = reasons.most_common(1)
        return cls(reasons.total(), most[0][0] if most else "", sum(state == _AT_WORK for _, state, _ in jobs))


def columns_of(printed: str) -> list[list[str]]:
    """Columns of every job that squeue has printed."""
    return [line.split(maxsplit=2) for line in printed.strip().splitlines()]


QueueTold = Callable[[QueueState], None]
