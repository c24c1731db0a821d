"""The `gfmd` command; every import of weight happens inside the command that needs it."""

from gfmd_numba.cli import (
    accuracy,
    campaigns,
    contacts,
    curve,
    fits,
    inspection,
    output_directory,
    planning,
    statistics,
)
from gfmd_numba.cli.group import main

__all__ = [
    "accuracy",
    "campaigns",
    "contacts",
    "curve",
    "fits",
    "inspection",
    "main",
    "output_directory",
    "planning",
    "statistics",
]
