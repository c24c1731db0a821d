"""How a command that takes its time shows that it is at work."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from threading import Timer
from typing import TYPE_CHECKING

import click

from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    from gfmd_numba.campaign.queue_state import QueueState

_PATIENCE = 1.0  # s
_WRITING = ", writing the results"


@contextmanager
def waiting(what: str) -> Iterator[None]:
    """Say what a command does once it has taken a second: next to a spinner on a terminal, as a line otherwise."""
    shown = []

    def show() -> None:
        if not sys.stderr.isatty():
            with suppress(OSError, ValueError):  # nobody reads it
                click.echo(f"busy     {what}", err=True)
            return
        from rich.console import Console
        from rich.live import Live
        from rich.spinner import Spinner

        console = Console(stderr=True)
        live = Live(Spinner("dots", what), console=console, transient=True, redirect_stdout=False)
        live.start()
        shown.append(live)

    timer = Timer(_PATIENCE, show)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        for live in shown:
            live.stop()


@contextmanager
def counting(what: str, total: int) -> Iterator[Callable[[], None]]:
    """Count what a command has done once it has taken a second: a bar on a terminal, a line for every tenth otherwise.

    Call what it gives after each one that is done.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    bar = Progress(*columns, console=Console(stderr=True), transient=True, redirect_stdout=False)
    task = bar.add_task(what, total=total)
    begun, told = time.monotonic(), 0

    def tell() -> None:
        nonlocal told
        told = int(bar.tasks[task].completed)
        with suppress(OSError, ValueError):  # nobody reads it
            click.echo(f"busy     {what}, {told} of {total} done", err=True)

    def advance() -> None:
        bar.advance(task)
        late = time.monotonic() - begun >= _PATIENCE and not sys.stderr.isatty()
        if late and int(bar.tasks[task].completed) >= told + max(1, total // 10):
            tell()

    timer = Timer(_PATIENCE, bar.start if sys.stderr.isatty() else tell)
    timer.daemon = True
    timer.start()
    try:
        yield advance
    finally:
        timer.cancel()
        timer.join()
        bar.stop()


@contextmanager
def progress_bar(
    caption: Callable[[], str] = lambda: "blocks",
) -> Iterator[Callable[[int, int], Callable[[int], None]]]:
    """Progress bar with a caption on a terminal, a line for every tenth of the blocks otherwise."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    console, hidden = Console(stderr=True), not sys.stderr.isatty()
    with Progress(*columns, console=console, disable=hidden, redirect_stdout=False) as bars:

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
    with suppress(OSError, ValueError):  # nobody reads it
        click.echo(f"jobs     {state.waiting} waiting{why}, {state.running} running", err=True)


def _state(what: str, finished: int, total: int) -> str:
    return what if finished < total else f"{what}{_WRITING}"
