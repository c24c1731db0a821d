"""The page on the architecture names the rooms and files that there are."""

import re
from pathlib import Path

import gfmd_numba

PACKAGE = Path(gfmd_numba.__file__).parent
PAGE = (PACKAGE.parent / "docs" / "architecture.md").read_text()
TO_WRITE = {
    "contact/your_process.py",
    "elasticity/your_body.py",
    "interface/your_law.py",
    "roughness/your_generator.py",
    "roughness/your_spectrum.py",
    "solvers/your_solver.py",
}


def test_every_room_is_in_the_picture():
    picture = PAGE.partition("```text")[2].partition("```")[0]
    rooms = {each.parent.name for each in PACKAGE.glob("*/__init__.py")}
    assert {room for room in rooms if re.search(rf"^.*\b{room}\b +[a-z]", picture, re.MULTILINE)} == rooms


def test_every_file_that_is_named_exists():
    named = set(re.findall(r"`([a-z_]+/[a-z_/]+\.py)`", PAGE)) - TO_WRITE
    missing = {name for name in named if not ((PACKAGE / name).exists() or (PACKAGE.parent / name).exists())}
    assert not missing
