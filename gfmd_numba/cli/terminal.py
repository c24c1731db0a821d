"""Text and tables on the terminal, within 80 columns, and how a slow command shows that it is at work."""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from textwrap import wrap
from threading import Timer
from typing import TYPE_CHECKING, NamedTuple

import click

from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    import xarray as xr
    from rich.progress import Progress

    from gfmd_numba.campaign.job_queue import QueueState

COLUMNS = 80
_SPACE = "\0"  # within a command, where no line may end: printable text has none
_GAP = "  "
_WIDEST_HEADING = 10
_PATIENCE = 1.0  # s


def say(label: str, text: str, *, width: int = 9, err: bool = False) -> None:
    """Print a text next to its label, made harmless. Only paths and commands, which are not folded, may be longer."""
    whole = re.sub(r"`[^`]*`", lambda command: command[0].replace(" ", _SPACE), printable(text))
    folded = wrap(whole, COLUMNS - width, break_long_words=False, break_on_hyphens=False)
    lines = [line.replace(_SPACE, " ") for line in folded] or [""]
    click.echo(f"{label:<{width}}{lines[0]}".rstrip(), err=err)
    for line in lines[1:]:
        click.echo(f"{'':{width}}{line}", err=err)


class Table(NamedTuple):
    """Parameters and values of cases, cells by heading, under a title."""

    title: str
    parameters: Mapping[str, list[str]]
    values: Mapping[str, list[str]]


class Line(NamedTuple):
    """A text next to its label, and how many columns that has on the terminal."""

    label: str
    text: str
    width: int = 9


Told = Iterator[Table | Line]


def tell(told: Told) -> None:
    """Print tables and lines as they come."""
    for each in told:
        if isinstance(each, Table):
            print_table(*each)
        else:
            say(each.label, each.text, width=each.width)


def warn(text: str) -> None:
    """Print a sentence of gfmd to standard error."""
    say("gfmd:", text, width=6, err=True)


def say_doubts(dataset: xr.Dataset) -> None:
    """Print the reasons to doubt a result, as its attribute `validity` gives them."""
    for doubt in dataset.attrs.get("validity", "").splitlines():
        warn(doubt)


def say_command(command: str, *, width: int) -> None:
    """Print a command of the shell, folded so that it can be copied."""
    words = re.findall(r"""(?:\$'(?:\\.|[^'\\])*'|'[^']*'|"[^"]*"|\S)+""", printable(command))
    whole = " ".join(each.replace(" ", _SPACE) for each in words)
    lines = wrap(whole, COLUMNS - width - 2, break_long_words=False, break_on_hyphens=False)
    click.echo(" \\\n".join(" " * width + line.replace(_SPACE, " ") for line in lines))


Column = list[str]


def print_table(title: str, parameters: Mapping[str, list[str]], values: Mapping[str, list[str]]) -> None:
    """Print parameters and values of cases, cells by heading, no line longer than 80 columns.

    Parameters that all cases share stand above the table once. Values for which there is no room go below the others,
    next to the parameters again; where those fill the line themselves, next to the number of the case.
    """
    shared = {heading: cells[0] for heading, cells in parameters.items() if len(set(cells)) == 1}
    keys = [_column(heading, cells) for heading, cells in parameters.items() if heading not in shared]
    columns = [_column(heading, cells) for heading, cells in values.items()]
    if max(_length([*keys, column]) for column in columns) > COLUMNS:
        numbers = [str(i + 1) for i in range(len(next(iter(values.values()))))]
        keys, columns = [_column("case", numbers)], keys + columns
    say("", title, width=0)
    if told := ", ".join(f"{heading} = {cell}" for heading, cell in shared.items() if cell != "-"):
        say("", told, width=0)
    for block in _blocks(keys, columns):
        height = max(map(len, block))
        click.echo()
        for line in zip(*([" " * len(column[0])] * (height - len(column)) + column for column in block), strict=True):
            click.echo(printable(_GAP.join(line).rstrip()))
    click.echo()


def _column(heading: str, cells: list[str]) -> Column:
    """Return the lines of a heading and cells, all of one width and aligned to the right."""
    lines = [*wrap(heading, _WIDEST_HEADING, break_long_words=False), *cells]
    width = max(map(len, lines))
    return [f"{line:>{width}}" for line in lines]


def _blocks(keys: list[Column], columns: list[Column]) -> Iterator[list[Column]]:
    """Yield blocks of columns that fit side by side, each after the keys."""
    block = list(keys)
    for column in columns:
        if len(block) > len(keys) and _length([*block, column]) > COLUMNS:
            yield block
            block = list(keys)
        block.append(column)
    yield block


def _length(block: list[Column]) -> int:
    return sum(len(column[0]) for column in block) + len(_GAP) * (len(block) - 1)


@contextmanager
def waiting(what: str, total: int | None = None) -> Iterator[Callable[[float], None]]:
    """Say what a command does once it has taken a second: a spinner or a bar on a terminal, a line otherwise.

    With a `total`, call the function that it yields with how much more of it is done. Without a terminal, a line is
    printed for every tenth.
    """
    shown: list[Progress] = []
    begun, done, told = time.monotonic(), 0.0, 0.0

    def show() -> None:
        nonlocal told
        told = done
        if sys.stderr.isatty():
            from rich import console, progress

            kinds = ("Bar", "TaskProgress", "MofNComplete", "TimeRemaining") if total else ("Spinner",)
            columns = [getattr(progress, f"{kind}Column")() for kind in kinds]
            on_stderr = console.Console(stderr=True)
            bars = progress.Progress(
                "{task.description}", *columns, console=on_stderr, redirect_stdout=False, transient=True
            )
            bars.update(bars.add_task(what, total=total), completed=done)
            bars.start()
            shown.append(bars)
        else:
            whole = int(done + 1e-9)  # of sums of parts
            _tell("busy", what + ("" if total is None else f", {done / total:.0%} done ({whole} of {total})"))

    def advance(more: float) -> None:
        nonlocal done
        done += more
        for bars in shown:
            bars.update(bars.task_ids[0], completed=done)
        late = time.monotonic() - begun >= _PATIENCE and not sys.stderr.isatty()
        if total is not None and late and done >= told + total / 10:
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
    """Show how many blocks are done, with a caption, as `waiting` does; one bar after another if there are rounds."""
    with ExitStack() as shown:

        def watch(total: int, done: int) -> Callable[[int], None]:
            shown.close()  # the round before
            advance = shown.enter_context(waiting(caption(), total))
            advance(done)
            return advance

        yield watch


def show_queue(state: QueueState) -> None:
    """Print how many jobs of a run wait in a queue, and how many run."""
    why = f" ({state.reason})" if state.reason else ""
    _tell("jobs", f"{state.waiting} waiting{why}, {state.running} running")


def _tell(label: str, text: str) -> None:
    with suppress(OSError, ValueError):  # nobody reads it
        say(label, text, err=True)
