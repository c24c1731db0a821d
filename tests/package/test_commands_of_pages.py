"""Commands that a page prints with the file they take are complete: nobody who types them is asked for an option."""

import re
import shlex
from pathlib import Path

import click
import pytest

from gfmd_numba.cli import main

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
WITH_A_FILE = re.compile(r"gfmd [a-z]+ [^-]")


def printed(page):
    """Commands in backticks, and in lines that are indented; choices in brackets are left out."""
    text = page.read_text(encoding="utf-8")
    found = re.findall(r"`(gfmd\s[^`]+)`", text) + re.findall(r"^    (gfmd [^#>\n]+)", text, re.MULTILINE)
    commands = (" ".join(re.sub(r"\[[^]]*\]", "", command).split()) for command in found)
    return [command for command in commands if WITH_A_FILE.match(command)]


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_every_command_with_a_file_has_what_it_requires(page, monkeypatch):
    for printed_command in printed(page):
        name, *arguments = shlex.split(printed_command)[1:]
        command = main.commands[name]
        for parameter in command.params:
            if isinstance(parameter.type, click.Path):
                monkeypatch.setattr(parameter, "type", click.STRING)  # the files of the page are not here
        command.make_context(name, arguments, **main.context_settings)


def test_pages_print_commands_with_files():
    assert sum(len(printed(page)) for page in PAGES) > 25
