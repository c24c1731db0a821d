"""How a slow command shows that it is at work."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from threading import Timer
from typing import TYPE_CHECKING, Any

import click

from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    from rich.progress import Progress

    from gfmd_numba.campaign.job_queue import QueueState

_PATIENCE = 1.0  # s
_WRITING = ", writing the results"


@contextmanager
def waiting(what: str, total: int | None = None) -> Iterator[Callable[[], None]]:
    """Say what a command does once it has taken a second: a spinner or a bar on a terminal, a line otherwise.

    With a `total`, call the function that it yields after each one that is done. Without a terminal, a line is printed
    for every tenth.
    """
    shown: list[Progress] = []
    begun, done, told = time.monotonic(), 0, 0

    def show() -> None:
        nonlocal told
        told = done
        if sys.stderr.isatty():
            bars = _bars(total, transient=True)
            bars.add_task(what, total=total, completed=done)
            bars.start()
            shown.append(bars)
        else:
            _echo(f"busy     {what}" + ("" if total is None else f", {done} of {total} done"))

    def advance() -> None:
        nonlocal done
        done += 1
        for bars in shown:
            bars.update(bars.task_ids[0], completed=done)
        late = time.monotonic() - begun >= _PATIENCE and not sys.stderr.isatty()
        if total is not None and late and done >= told + max(1, total // 10):
            show()

    timer = Timer(_PATIENCE, show)
    timer.daemon = True
    timer.start()
    try:
        yield advance
    finally:
        timer.cancel()
        timer.join()
        for bars in shown:
            bars.stop()


@contextmanager
def progress_bar(
    caption: Callable[[], str] = lambda: "blocks",
) -> Iterator[Callable[[int, int], Callable[[int], None]]]:
    """Show a progress bar with a caption on a terminal, or a line for every tenth of the blocks otherwise."""
    with _bars(0, disable=not sys.stderr.isatty()) as bars:

        def watch(total: int, done: int) -> Callable[[int], None]:
            what, shown = caption(), done
            bar = bars.add_task(_state(what, done, total), total=total, completed=done)

            def advance(blocks: int) -> None:
                nonlocal shown
                bars.advance(bar, blocks)
                finished = int(bars.tasks[bar].completed)
                bars.update(bar, description=_state(what, finished, total))
                if bars.disable and (finished == total or finished >= shown + max(1, total // 10)):
                    click.echo(f"blocks   {finished} of {total}", err=True)
                    shown = finished

            return advance

        yield watch
        for task in bars.tasks:
            bars.update(task.id, description=task.description.removesuffix(_WRITING))


def show_queue(state: QueueState) -> None:
    """Print how many jobs of a run wait in a queue, and how many run."""
    why = f" ({printable(state.reason)})" if state.reason else ""
    _echo(f"jobs     {state.waiting} waiting{why}, {state.running} running")


def _bars(total: int | None, **options: Any) -> Progress:
    """Return a progress bar on standard error, or a spinner if there is no total."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        SpinnerColumn,
        TextColumn,
        TimeRemainingColumn,
    )

    what = TextColumn("{task.description}")
    counted = (what, BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    columns = (SpinnerColumn(), what) if total is None else counted
    return Progress(*columns, console=Console(stderr=True), redirect_stdout=False, **options)


def _echo(line: str) -> None:
    with suppress(OSError, ValueError):  # nobody reads it
        click.echo(line, err=True)


def _state(what: str, finished: int, total: int) -> str:
    return what if finished < total else f"{what}{_WRITING}"
