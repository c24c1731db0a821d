"""The `gfmd` command, and how it ends."""

from __future__ import annotations

from typing import Any, TextIO

import click

from gfmd_numba.scene.printable import printable

BAD_INPUT, SOME_FAILED, INTERRUPTED = 2, 3, 130


class _Gfmd(click.Group):
    """Turns what the user can mend into one message and an exit code."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; bad input exits with 2, an interrupt with 130."""
        import warnings

        from gfmd_numba.scene.document import InputError

        try:
            with warnings.catch_warnings():
                warnings.showwarning = _show_warning
                return super().invoke(ctx)
        except BrokenPipeError:  # the reader of a pipe has seen enough: click ends quietly
            raise
        except click.UsageError as error:
            raise click.UsageError(printable(error.format_message()), error.ctx) from None
        except InputError as error:
            click.echo(f"gfmd: {error}", err=True)
            ctx.exit(BAD_INPUT)
        except OSError as error:
            click.echo(f"gfmd: {printable(error)}", err=True)
            ctx.exit(BAD_INPUT)
        except KeyboardInterrupt:
            click.echo("gfmd: interrupted; finished work is kept, the same command resumes", err=True)
            ctx.exit(INTERRUPTED)


def _show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Show a warning as a sentence, without the line of the program that gave it."""
    click.echo(f"gfmd: {message}", err=True)


@click.group(cls=_Gfmd, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="gfmd-numba")
def main() -> None:
    """Contact of rough elastic bodies: a YAML campaign in, kappa with error bars out."""
