"""Mistakes put into the fit of the limit are seen by its tests."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from support.code_mutants import MUTANTS, PACKAGE

ROOT = Path(__file__).parents[2]
SURVIVORS: set[tuple[str, str]] = set()  # file and what stands instead, which no test of its file sees
SEEN = 0.9  # share of the mutants


def test_every_mutant_changes_one_place():
    for file, there, instead, tests in MUTANTS:
        assert (ROOT / PACKAGE / file).read_text(encoding="utf-8").count(there) == 1, there
        assert there != instead
        assert (ROOT / "tests" / "analysis" / f"{tests}.py").exists()


@pytest.mark.long
def test_mutants_are_killed(tmp_path):
    """In a copy of the package; whatever a mutant ends with, but for a pass, kills it."""
    shutil.copytree(ROOT / "gfmd_numba", tmp_path / "gfmd_numba", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("tests", "benchmarks"):
        (tmp_path / name).symlink_to(ROOT / name)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    survived = {(file, instead) for file, *rest in MUTANTS if (instead := lives(tmp_path, file, *rest))}
    assert len(survived) <= (1 - SEEN) * len(MUTANTS), survived
    assert survived <= SURVIVORS, survived - SURVIVORS


def lives(folder, file, there, instead, tests):
    """What a mutant has instead if it passes its tests, and nothing if it does not."""
    path = folder / PACKAGE / file
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace(there, instead), encoding="utf-8")
    try:
        command = [
            sys.executable,
            "-B",
            "-m",
            "pytest",
            "-x",
            "-q",
            "-p",
            "no:cacheprovider",
            f"tests/analysis/{tests}.py",
        ]
        done = subprocess.run(
            command,
            cwd=folder,
            env=os.environ | {"PYTHONPATH": str(folder)},
            capture_output=True,
            text=True,
            timeout=600,
        )
    finally:
        path.write_text(text, encoding="utf-8")
    return instead if done.returncode == 0 else ""
