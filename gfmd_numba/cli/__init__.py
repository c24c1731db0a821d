"""The `gfmd` command; every import of weight happens inside the command that needs it."""

from gfmd_numba.cli import campaigns, contacts, fits, inspection, planning, report  # noqa: F401 - its commands
from gfmd_numba.cli.group import main

__all__ = ["main"]
