"""The `gfmd` command, and how it ends."""

from __future__ import annotations

from contextlib import suppress
from typing import Any, TextIO

import click

from gfmd_numba.cli.streams import UntoldError, drop_output, open_streams
from gfmd_numba.cli.usage import refused
from gfmd_numba.text.printable import printable

UNTOLD, BAD_INPUT, SOME_FAILED, INTERRUPTED = 1, 2, 3, 130

_FEWEST_FILES, _MANY_FILES = 256, 4096  # open at a time: two workers take about 100, each more about 20


class _Gfmd(click.Group):
    """Turns what the user can mend into one message and an exit code."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command line, whatever standard streams are open."""
        open_streams()
        return super().main(*args, **kwargs)

    def make_context(self, *args: Any, **kwargs: Any) -> click.Context:
        """Read the options before the name of a command."""
        try:
            return super().make_context(*args, **kwargs)
        except click.UsageError as error:
            raise refused(error) from None

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; bad input exits with 2, an interrupt with 130, a full standard output with 1."""
        import warnings

        from gfmd_numba.text.input_error import InputError

        try:
            with warnings.catch_warnings():
                warnings.showwarning = _show_warning
                _allow_files()
                return super().invoke(ctx)
        except BrokenPipeError:  # the reader of a pipe has seen enough: click ends quietly
            raise
        except click.UsageError as error:
            raise refused(error) from None
        except InputError as error:
            _tell(str(error))
            ctx.exit(BAD_INPUT)
        except OSError as error:
            _tell(printable(error))
            ctx.exit(BAD_INPUT)
        except UntoldError as error:
            drop_output()
            _tell(f"standard output cannot be written ({error}); files that were written are kept")
            ctx.exit(UNTOLD)
        except KeyboardInterrupt:
            _tell("interrupted; finished work is kept, the same command resumes")
            ctx.exit(INTERRUPTED)


def _tell(sentence: str) -> None:
    with suppress(OSError):  # nobody can be told: the exit code still says it
        click.echo(f"gfmd: {sentence}", err=True)


def _allow_files() -> None:
    """Raise the limit of open files to what workers need; raises InputError where it may not be raised so far."""
    try:
        import resource
    except ImportError:  # a system without such limits
        return
    from gfmd_numba.text.input_error import InputError

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    most = _MANY_FILES if hard == resource.RLIM_INFINITY else min(hard, _MANY_FILES)
    if soft != resource.RLIM_INFINITY and soft < most:
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
        soft = most
    if soft != resource.RLIM_INFINITY and soft < _FEWEST_FILES:
        raise InputError(f"ulimit -n: you gave {soft} open files; gfmd allows at least {_FEWEST_FILES}")


def _show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Show a warning as a sentence, without the line of the program that gave it."""
    _tell(printable(message))


@click.group(cls=_Gfmd, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="gfmd-numba")
def main() -> None:
    """Compute how rough elastic bodies touch.

    You describe a contact, a rough surface or a whole campaign in a YAML file. gfmd computes contact area, pressure,
    gap and stiffness, and extrapolates kappa, the ratio of area to load, with its error.
    """
