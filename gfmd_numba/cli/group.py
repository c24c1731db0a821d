"""The `gfmd` command: how it starts, and how it ends."""

from __future__ import annotations

import atexit
import gc
import io
import os
import re
import signal
import sys
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from difflib import get_close_matches
from errno import ENOSPC
from typing import Any

import click

from gfmd_numba.text.input_error import InputError
from gfmd_numba.text.printable import printable

UNTOLD, BAD_INPUT, SOME_FAILED, INTERRUPTED = 1, 2, 3, 130
_FEWEST_FILES, _MANY_FILES = 256, 4096  # open at a time: two workers take about 100, each more about 20
_MOST_HOMES = 3  # commands that have an option, that a message names
_AS_SENTENCES = (  # what click says of a value, and what gfmd says
    (
        r"(?:File|Path|Directory) '(.*)' does not exist\.",
        r"you gave \1, which does not exist; gfmd needs a path that does",
    ),
    (r"(?:File|Path) '(.*)' is a directory\.", r"you gave \1, which is a directory; gfmd needs a file"),
    (r"Directory '(.*)' is a file\.", r"you gave \1, which is a file; gfmd needs a directory"),
    (r"(?:File|Path|Directory) '(.*)' is not (read|writ)able\.", r"you may not \2e \1; gfmd needs a path that you may"),
    (r"('.*') is not one of (.*)\.", r"you gave \1; gfmd allows one of \2"),
    (r"('.*') is not a valid (?:integer|float|integer range|float range)\.", r"you gave \1; gfmd allows a number"),
    (r"(\S+) is not in the range (.*)\.", r"you gave \1; gfmd allows \2"),
)


# Imports make up to 300,000 objects that stay until the end. With its usual thresholds Python would look through them
# for garbage again and again while they load, and once more at the end, which takes a second each.
_OBJECTS_BETWEEN_SEARCHES = (20_000, 20, 100)


class _Gfmd(click.Group):
    """The group of commands. It turns what the user can mend into one message and an exit code."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command line, whatever standard streams are open."""
        gc.set_threshold(*_OBJECTS_BETWEEN_SEARCHES)
        atexit.unregister(gc.freeze)  # once is enough
        atexit.register(gc.freeze)
        open_streams()
        return super().main(*args, **kwargs)

    def make_context(self, *args: Any, **kwargs: Any) -> click.Context:
        """Read the options before the name of a command."""
        try:
            return super().make_context(*args, **kwargs)
        except click.exceptions.NoArgsIsHelpError:  # its message is the help
            raise
        except click.UsageError as error:
            raise refused(error) from None

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; bad input exits with 2, an interrupt with 130, a full standard output with 1."""
        try:
            with warnings.catch_warnings():
                # a sentence, without the line of the program that gave it
                warnings.showwarning = lambda message, *_, **__: _tell(printable(message))
                _allow_files()
                with _terminated_as_interrupted():
                    return super().invoke(ctx)
        except BrokenPipeError:  # the reader of a pipe has seen enough: click ends quietly
            raise
        except click.UsageError as error:
            raise refused(error) from None
        except InputError as error:
            _tell(str(error))
            ctx.exit(BAD_INPUT)
        except OSError as error:
            if error.errno == ENOSPC and error.filename is None:  # errors of files name them
                os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what is still to be written is discarded
                _tell(f"standard output cannot be written ({error.strerror}); files that were written are kept")
                ctx.exit(UNTOLD)
            _tell(printable(error))
            ctx.exit(BAD_INPUT)
        except KeyboardInterrupt as interrupt:  # with what a run has to say
            _tell("; ".join(("interrupted", *map(str, interrupt.args))))
            ctx.exit(INTERRUPTED)


def _tell(sentence: str) -> None:
    with suppress(OSError):  # nobody can be told: the exit code still says it
        click.echo(f"gfmd: {sentence}", err=True)


@contextmanager
def _terminated_as_interrupted() -> Iterator[None]:
    """Let SIGTERM do what Ctrl-C does, which closes workers; elsewhere than in the main thread nothing changes."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _allow_files() -> None:
    """Raise the limit of open files to what workers need; raises InputError if it may not be raised so far."""
    try:
        import resource
    except ImportError:  # a system without such limits
        return

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    most = _MANY_FILES if hard == resource.RLIM_INFINITY else min(hard, _MANY_FILES)
    if soft != resource.RLIM_INFINITY and soft < most:
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
        soft = most
    if soft != resource.RLIM_INFINITY and soft < _FEWEST_FILES:
        raise InputError.of("ulimit -n", f"{soft} open files", f"at least {_FEWEST_FILES}")


@click.group(cls=_Gfmd, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="gfmd-numba")
def main() -> None:
    """Compute how rough elastic bodies touch.

    You describe a contact, a rough surface or a whole campaign in a YAML file. gfmd computes contact area, pressure,
    gap and stiffness, and extrapolates kappa, the ratio of area to load, with its error.
    """


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
        meant = _meant(error.option_name) if isinstance(error, click.NoSuchOption) else ""
        said = said.partition(" Did you mean")[0].rstrip(".")
        said = f"{said[0].lower()}{said[1:]}; {meant}`{command} --help` says what it takes"
    return RefusedCommandError(printable(said), error.ctx)


def _meant(given: str) -> str:
    """Return which commands have the option that is most like one that was given, if any is."""
    homes: dict[str, list[str]] = {}
    for name, command in main.commands.items():
        for option in (option for parameter in command.params for option in parameter.opts):
            homes.setdefault(option, []).append(f"`gfmd {name}`")
    near = get_close_matches(given, homes, 1)
    return f"{near[0]} is an option of {' and '.join(homes[near[0]][:_MOST_HOMES])}; " if near else ""


class RefusedCommandError(click.UsageError):
    """A command line that is refused, which is shown as one sentence."""

    def show(self, file: object = None) -> None:
        """Print the sentence to standard error."""
        click.echo(f"gfmd: {self.message}", err=True)


def open_streams() -> None:
    """Let closed standard streams lead nowhere, or the next file opened would take their place and their text."""
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # it takes the lowest number that is free: this one
    sys.stdout, sys.stderr = (stream or open(os.devnull, "w") for stream in (sys.stdout, sys.stderr))  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
