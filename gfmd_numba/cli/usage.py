"""What is wrong with a command line, in the words of all other errors: click's own messages as sentences."""

from __future__ import annotations

import re

import click

from gfmd_numba.text.printable import printable

_AS_SENTENCES = (  # what click says of a value, and what gfmd says
    (
        r"(?:File|Path|Directory) '(.*)' does not exist\.",
        r"you gave \1, which does not exist; gfmd needs a path that does",
    ),
    (r"(?:File|Path) '(.*)' is a directory\.", r"you gave \1, which is a directory; gfmd needs a file"),
    (r"(?:File|Path|Directory) '(.*)' is not (read|writ)able\.", r"you may not \2e \1; gfmd needs a path that you may"),
    (r"('.*') is not one of (.*)\.", r"you gave \1; gfmd allows one of \2"),
    (r"('.*') is not a valid (?:integer|float|integer range|float range)\.", r"you gave \1; gfmd allows a number"),
    (r"(\S+) is not in the range (.*)\.", r"you gave \1; gfmd allows \2"),
)


class RefusedCommandError(click.UsageError):
    """A command line that is refused; it is shown as one sentence, as bad input is."""

    def show(self, file: object = None) -> None:
        """Print the sentence to standard error."""
        click.echo(f"gfmd: {self.message}", err=True)


def refused(error: click.UsageError) -> RefusedCommandError:
    """Return what click refuses as one sentence that says where, what was given and what is allowed."""
    command = error.ctx.command_path if error.ctx is not None else "gfmd"
    said = error.format_message() if isinstance(error, click.MissingParameter) else error.message
    if isinstance(error, click.BadParameter) and not isinstance(error, click.MissingParameter):
        hint = error.param_hint or (error.param.get_error_hint(error.ctx) if error.param and error.ctx else command)
        where = hint if isinstance(hint, str) else " or ".join(hint)
        for pattern, sentence in _AS_SENTENCES:
            said = re.sub(f"^{pattern}$", sentence, said, flags=re.DOTALL)
        said = f"{where.replace(chr(39), '')}: {said}"
    elif type(error) is not click.UsageError or not said.startswith("--"):  # of click
        said = f"{said[0].lower()}{said[1:].rstrip('.')}; `{command} --help` says what it takes"
    return RefusedCommandError(printable(said), error.ctx)
