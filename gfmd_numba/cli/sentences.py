"""Sentences on the terminal: a label, and text folded to 80 columns beside it."""

from __future__ import annotations

from textwrap import wrap

import click

from gfmd_numba.text.printable import printable

COLUMNS = 80


def say(label: str, text: str, *, width: int = 9, err: bool = False) -> None:
    """Print a text beside its label, made harmless; only a word longer than a line, like a path, goes beyond."""
    lines = wrap(printable(text), COLUMNS - width, break_long_words=False, break_on_hyphens=False) or [""]
    click.echo(f"{label:<{width}}{lines[0]}".rstrip(), err=err)
    for line in lines[1:]:
        click.echo(f"{'':{width}}{line}", err=err)


def say_command(command: str, *, width: int) -> None:
    """Print a command of the shell, folded so that it can be copied."""
    lines = wrap(printable(command), COLUMNS - width - 2, break_long_words=False, break_on_hyphens=False)
    click.echo(" \\\n".join(" " * width + line for line in lines))
