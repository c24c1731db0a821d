"""Mistakes put into the fit of the limit are seen by its tests."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from support.code_mutants import MUTANTS, PACKAGE

ROOT = Path(__file__).parents[2]
SURVIVORS = {  # file and what stands instead, which no test of its file sees
    ("allocation.py", "count * np.linalg.inv"),  # designs are chosen with more confidence than that costs
    ("allocation.py", "price[np.setdiff1d(number, fitted)] = 0.1"),  # what tells nothing is not bought at any price
}
SEEN = 0.9  # share of the mutants
SLOW = "residual_changes or rewritten or accuracy"  # tests that solve contacts


def test_every_mutant_changes_one_place():
    for file, there, instead, tests in MUTANTS:
        assert (ROOT / PACKAGE / file).read_text(encoding="utf-8").count(there) == 1, there
        assert there != instead
        assert (ROOT / "tests" / "analysis" / f"{tests}.py").exists()


@pytest.mark.long
def test_mutants_are_killed(tmp_path):
    """In a copy of the package; whatever a mutant ends with, but for a pass, kills it."""
    shutil.copytree(ROOT / "gfmd_numba", tmp_path / "gfmd_numba", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "tests", tmp_path / "tests", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "benchmarks").symlink_to(ROOT / "benchmarks")
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
        options = ["-B", "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-k", f"not ({SLOW})"]
        done = subprocess.run(
            [sys.executable, *options, f"tests/analysis/{tests}.py"],
            cwd=folder,
            env=os.environ | {"PYTHONPATH": str(folder)},
            capture_output=True,
            text=True,
            timeout=600,
        )
    finally:
        path.write_text(text, encoding="utf-8")
    return instead if done.returncode == 0 else ""
