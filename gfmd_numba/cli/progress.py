"""How a long run shows how far it is."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import click


@contextmanager
def progress_bar() -> Iterator[Callable[[int, int], Callable[[int], None]]]:
    """Progress bar on a terminal, a line for every tenth of the blocks otherwise."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("blocks"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    with Progress(*columns, disable=not sys.stderr.isatty()) as bars:

        def watch(total: int, done: int) -> Callable[[int], None]:
            bar = bars.add_task("blocks", total=total, completed=done)
            shown = done

            def advance(blocks: int) -> None:
                nonlocal shown
                bars.advance(bar, blocks)
                finished = int(bars.tasks[bar].completed)
                if bars.disable and (finished == total or finished >= shown + max(1, total // 10)):
                    click.echo(f"blocks   {finished} of {total}", err=True)
                    shown = finished

            return advance

        yield watch
