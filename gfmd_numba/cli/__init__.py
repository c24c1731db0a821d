"""The `gfmd` command; every import of weight happens inside the command that needs it."""

from gfmd_numba.cli import (  # noqa: F401 - these are its commands
    accuracy,
    campaigns,
    contacts,
    fits,
    inspection,
    output_directory,
    planning,
    report,
    solved_contact,
)
from gfmd_numba.cli.group import main

__all__ = ["main"]
