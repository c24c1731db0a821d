"""How threads share the work on large arrays: in pieces that do not depend on how many threads there are."""

import os
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, nullcontext
from functools import lru_cache
from math import prod
from typing import TypeVar

from threadpoolctl import ThreadpoolController

T = TypeVar("T")

_PIECE = 2**14  # entries of an array that one thread takes at a time
_PARTS = 4  # of the work for each thread: whoever is ready takes the next
_FEWEST = 2**17  # nodes that are shared: fewer take less time than to wake a thread and wait for it


class Team:
    """Some threads, the one that asks among them."""

    def __init__(self, size: int) -> None:
        self.size = size
        self._pool = ThreadPoolExecutor(size - 1) if size > 1 else None

    def share(
        self, work: Callable[[int, int, int], object], pieces: int, nodes: int, first: Callable[[], None] | None = None
    ) -> None:
        """Call `work` with the number of a thread, the first of some pieces and their end, until all are done.

        One thread alone works on few `nodes`. Results are the same for any number of threads if each piece is made by
        itself. The thread that asks may do something else `first`. Raises what `work` raises.
        """
        if self._pool is None or pieces < self.size or nodes < _FEWEST:
            if first is not None:
                first()
            work(0, 0, pieces)
            return
        number = min(pieces, _PARTS * self.size)
        ends = [pieces * i // number for i in range(number + 1)]
        left = iter(range(number))

        def some(thread: int) -> None:
            for k in left:
                work(thread, ends[k], ends[k + 1])

        others = [self._pool.submit(some, i) for i in range(1, self.size)]
        if first is not None:
            first()
        some(0)
        for other in others:
            if not other.cancel():  # which has begun
                other.result()

    def in_pieces(self, work: Callable[[slice], T], size: int) -> list[T]:
        """Return what `work` makes of each piece of arrays of a size, in order.

        A sum over these is the same for any number of threads.
        """
        if is_one_piece(size):
            return [work(slice(0, size))]
        ends, found = [*range(0, size, _PIECE), size], dict[int, T]()

        def some(_: int, first: int, last: int) -> None:
            for k in range(first, last):
                found[k] = work(slice(ends[k], ends[k + 1]))

        self.share(some, len(ends) - 1, size)
        return [found[k] for k in range(len(ends) - 1)]

    def by_rows(self, work: Callable[[slice], object], shape: tuple[int, ...]) -> None:
        """Call `work` with some of the rows of an array of a shape after others, for all of these."""
        self.share(lambda _, first, last: work(slice(first, last)), shape[0], prod(shape))

    def close(self) -> None:
        """End the threads."""
        if self._pool is not None:
            self._pool.shutdown()


def is_one_piece(size: int) -> bool:
    """Return whether arrays of a size are one piece."""
    return size <= _PIECE


_ALONE = Team(1)
_present = [_ALONE]


def team() -> Team:
    """Return the threads that share the work now."""
    return _present[-1]


def cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def shared_by(threads: int) -> Iterator[None]:
    """Let so many threads, or as many as there are cores, share the work of this process meanwhile.

    Linear algebra gets one thread. Only the outermost call sees to that.
    """
    is_outermost = team() is _ALONE
    made = Team(min(threads, cores()))
    _present.append(made)
    try:
        with one_thread_of_algebra() if is_outermost else nullcontext():
            yield
    finally:
        _present.remove(made)
        made.close()


@contextmanager
def one_thread_of_algebra() -> Iterator[None]:
    """Let linear algebra have one thread meanwhile: its matrices are small, and threads would wait for one another."""
    with _libraries(len(sys.modules)).limit(limits=1):
        yield


@lru_cache(maxsize=1)
def _libraries(modules: int) -> ThreadpoolController:
    """Find the libraries of linear algebra, which takes as long as a small contact, again where modules were added."""
    return ThreadpoolController()
