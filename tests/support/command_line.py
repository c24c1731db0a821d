"""The command in this process and Python in another, and what they say."""

import subprocess
import sys

from click.testing import CliRunner

from gfmd_numba.cli import main


def gfmd(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments], catch_exceptions=False, prog_name="gfmd")


def refused(*arguments):
    """The one line that a command says before it exits with 2, without a traceback."""
    done = gfmd(*arguments)
    assert done.exit_code == 2, done.output
    assert "Traceback" not in done.stderr
    return done.stderr.strip().splitlines()[-1]


def python(script, *arguments):
    done = subprocess.run([sys.executable, "-c", script, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def unfolded(text):
    return " ".join(text.split())
