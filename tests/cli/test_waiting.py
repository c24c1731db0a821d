"""What a terminal shows while a command is at work."""

import os
import subprocess
import sys

import pytest

pty = pytest.importorskip("pty", reason="a terminal of POSIX")

BEGIN = "from gfmd_numba.cli import terminal; terminal._PATIENCE = 0.0"
SPINNER = f"""{BEGIN}
with terminal.waiting("fitting"):
    input()
    print("results  small.nc")
"""
BAR = f"""{BEGIN}
with terminal.progress_bar() as watch:
    watch(4, 1)(3)
    input()
    print("results  small.nc")
"""


@pytest.mark.parametrize(("script", "shown"), [(SPINNER, "fitting"), (BAR, "4/4")])
def test_a_terminal_says_what_is_waited_for_and_a_pipe_has_the_results(script, shown):
    terminal, screen = pty.openpty()
    command = [sys.executable, "-c", script]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=screen) as process:
        os.close(screen)
        said = b""
        while shown.encode() not in said:  # ends with an OSError if the process ends before
            said += os.read(terminal, 1000)
        assert process.communicate(b"\n") == (b"results  small.nc\n", None)
    os.close(terminal)
    assert process.returncode == 0
