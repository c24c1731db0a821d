"""The `gfmd` command; every import of weight happens inside the command that needs it."""

from gfmd_numba.cli import (  # noqa: F401 - these are its commands
    campaigns,
    contacts,
    fits,
    inspection,
    planning,
    report,
)
from gfmd_numba.cli.group import main

__all__ = ["main"]
