"""How processes share the rows of a map, with sums that have the same last bits for any number of processes."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Any, Protocol, Self

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals


class Communicator(Protocol):
    """What is asked of MPI, as `mpi4py.MPI.Comm` has it."""

    @property
    def rank(self) -> int:
        """Number of this process."""

    @property
    def size(self) -> int:
        """Number of processes."""

    def allgather(self, sendobj: Any) -> list[Any]:
        """Objects of all processes."""

    def Alltoallv(self, sendbuf: Any, recvbuf: Any) -> None:
        """Send some elements of an array to each process."""


def exchange(
    communicator: Communicator,
    sent: npt.NDArray[Any],
    to_each: Sequence[int],
    received: npt.NDArray[Any],
    from_each: Sequence[int],
) -> None:
    """Send so many elements of a flat array to each process, one after another, and receive so many from each."""
    (first, second) = ([0, *accumulate(counts[:-1])] for counts in (to_each, from_each))
    communicator.Alltoallv([sent, (to_each, first)], [received, (from_each, second)])


@dataclass(frozen=True)
class Slab:
    """The rows of a map `[y, x]` that this process has; `bounds` are the first rows of all, and the number of rows."""

    communicator: Communicator
    bounds: tuple[int, ...]

    @classmethod
    def of(cls, communicator: Communicator, rows: int, unit: int = 1) -> Self:
        """Share rows as evenly as possible, in units of some."""
        size, units = communicator.size, rows // unit
        return cls(communicator, (*(unit * (units * rank // size) for rank in range(size)), rows))

    @property
    def counts(self) -> list[int]:
        """Number of rows of each process."""
        return [last - first for first, last in pairwise(self.bounds)]

    @property
    def rows(self) -> int:
        """Number of rows of this process."""
        return self.counts[self.communicator.rank]

    @property
    def halved(self) -> "Slab":
        """The same of a map of half as many rows, where all bounds are even."""
        return Slab(self.communicator, tuple(bound // 2 for bound in self.bounds))

    def total(self, of_rows: Reals) -> Reals:
        """Sums over all rows of what each process knows of its own `[row, ...]`."""
        return np.asarray(np.concatenate(self.communicator.allgather(of_rows)).sum(axis=0))

    def largest(self, *values: float) -> list[float]:
        """Largest of the values of all processes, each by itself; not-a-number if one of them is."""
        return [float(each) for each in np.max(self.communicator.allgather(values), axis=0)]

    def fill_edges(self, values: npt.NDArray[Any], width: int) -> None:
        """Fill so many rows before and after those of this process from its neighbours, which have at least as many."""
        size, rank = self.communicator.size, self.communicator.rank
        before, after, edge = (rank - 1) % size, (rank + 1) % size, width * values.shape[1]
        counts = [edge * ((each == before) + (each == after)) for each in range(size)]
        edges = [values[width : 2 * width], values[-2 * width : -width]]  # for the process before, and the one after
        sent = np.concatenate(edges if before <= after else edges[::-1]).reshape(-1)
        received = np.empty_like(sent)
        exchange(self.communicator, sent, counts, received, counts)
        one, other = received.reshape(2, width, -1)
        values[:width], values[-width:] = (one, other) if before < after else (other, one)

    def gathered(self, values: Reals) -> Reals | None:
        """Values `[y, x]` of all processes in the first one, None in the others."""
        size, columns, first = self.communicator.size, values.shape[1], self.communicator.rank == 0
        every = np.empty((self.bounds[-1] if first else 0, columns))
        to_each = [values.size, *[0] * (size - 1)]
        from_each = [columns * rows if first else 0 for rows in self.counts]
        exchange(self.communicator, values.reshape(-1), to_each, every.reshape(-1), from_each)
        return every if first else None
