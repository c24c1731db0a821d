"""Sentences on the terminal: a label, and text folded to 80 columns next to it."""

from __future__ import annotations

import re
from textwrap import wrap

import click

from gfmd_numba.text.printable import printable

COLUMNS = 80
_SPACE = "\0"  # within a command, where no line may end: printable text has none


def say(label: str, text: str, *, width: int = 9, err: bool = False) -> None:
    """Print a text next to its label, made harmless; only what cannot be folded, a path or command, goes beyond."""
    whole = re.sub(r"`[^`]*`", lambda command: command[0].replace(" ", _SPACE), printable(text))
    folded = wrap(whole, COLUMNS - width, break_long_words=False, break_on_hyphens=False)
    lines = [line.replace(_SPACE, " ") for line in folded] or [""]
    click.echo(f"{label:<{width}}{lines[0]}".rstrip(), err=err)
    for line in lines[1:]:
        click.echo(f"{'':{width}}{line}", err=err)


def say_command(command: str, *, width: int) -> None:
    """Print a command of the shell, folded so that it can be copied."""
    words = re.findall(r"""(?:\$'(?:\\.|[^'\\])*'|'[^']*'|"[^"]*"|\S)+""", printable(command))
    whole = " ".join(each.replace(" ", _SPACE) for each in words)
    lines = wrap(whole, COLUMNS - width - 2, break_long_words=False, break_on_hyphens=False)
    click.echo(" \\\n".join(" " * width + line.replace(_SPACE, " ") for line in lines))
