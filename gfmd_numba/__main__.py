"""`python -m gfmd_numba` is the `gfmd` command."""

from gfmd_numba.cli import main

main(prog_name="gfmd")
