"""A shell reads a quoted path as the one word that it is."""

import subprocess

import pytest

from gfmd_numba.text.printable import word

NAMES = [
    "plain.yaml",
    "p_a;touch X",
    "two words",
    "it's",
    'say "so"',
    "$(touch X)",
    "`touch X`",
    "-rf",
    "a\nb",
    "tab\there",
    "back\\slash\n",
    "ünï\x1b[31m",
    "*",
    "~",
    "#no",
    "",
]


@pytest.mark.parametrize("name", NAMES)
def test_bash_reads_back_the_very_path(name, tmp_path):
    read = subprocess.run(["bash", "-c", f"printf %s {word(name)}"], capture_output=True, cwd=tmp_path)
    assert read.stdout.decode() == (f"./{name}" if name.startswith("-") else name)
    assert word(name).isprintable()
    assert not list(tmp_path.iterdir())
