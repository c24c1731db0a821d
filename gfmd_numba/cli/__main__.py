"""`python -m gfmd_numba.cli` is the `gfmd` command."""

from gfmd_numba.cli import main

main()
