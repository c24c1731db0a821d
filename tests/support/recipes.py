"""Recipes of docs/architecture.md, and how a copy of the package follows them."""

import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import gfmd_numba

PACKAGE = Path(gfmd_numba.__file__).parent


@dataclass(frozen=True)
class Recipe:
    """A new file, if any, and what goes into one old file: each text before the anchor that follows it there."""

    new_file: str | None
    text: str
    old_file: str
    insertions: tuple[tuple[str, str], ...]

    def follow(self, package):
        if self.new_file is not None:
            assert not (package / self.new_file).exists()
            (package / self.new_file).write_text(self.text)
        old = (package / self.old_file).read_text()
        for insertion, anchor in self.insertions:
            assert old.count(anchor) == 1, anchor
            old = old.replace(anchor, insertion + anchor)
        (package / self.old_file).write_text(old)


_COMMANDS = """
import json, sys
from click.testing import CliRunner
from gfmd_numba.cli import main
said = []
for line in json.load(sys.stdin):
    done = CliRunner().invoke(main, line.split(), catch_exceptions=False)
    assert done.exit_code == 0, done.output
    said.append(done.stdout)
json.dump(said, sys.stdout)
"""


def command_after(recipes, files, tmp_path):
    """What runs commands of a copy of the package, in which every recipe was followed, next to some files.

    All lines that it is given run in one process. It returns what each of them prints.
    """
    package = copied(tmp_path)
    for recipe in recipes:
        recipe.follow(package)
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    return lambda *lines: run_on_copy(package, _COMMANDS, lines)


def copied(tmp_path):
    """Copy of the package, with its compiled files."""
    return shutil.copytree(PACKAGE, tmp_path / "copy" / "gfmd_numba")


def run_on_copy(package, script, given):
    """Give a script that imports a copy of the package something to read as JSON; return what it prints as JSON."""
    environment = os.environ | {"PYTHONPATH": str(package.parent)}  # its kernels are those of this package
    done = subprocess.run(
        [sys.executable, "-c", script],
        input=json.dumps(given),
        capture_output=True,
        text=True,
        cwd=package.parent.parent,
        env=environment,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
