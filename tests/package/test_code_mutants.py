"""Mistakes put into the fit of the limit are seen by its tests."""

import os
from multiprocessing.pool import ThreadPool
from pathlib import Path

import pytest

from support.code_mutants import MUTANTS, PACKAGE
from support.mutated_package import lives

ROOT = Path(__file__).parents[2]
SURVIVORS = {  # file and what stands instead, which no test of its file sees
    ("ensembles.py", "count * np.linalg.inv"),  # designs are chosen with more confidence than that costs
    ("allocation.py", "price[np.setdiff1d(number, fitted)] = 0.1"),  # what tells nothing is not bought at any price
}
SEEN = 0.9  # share of the mutants
SLOW = "residual_changes"  # tests that solve contacts


def test_every_mutant_changes_one_place():
    for file, there, instead, tests in MUTANTS:
        assert (ROOT / PACKAGE / file).read_text(encoding="utf-8").count(there) == 1, there
        assert there != instead
        assert (ROOT / "tests" / "analysis" / f"{tests}.py").exists()


@pytest.mark.long
def test_mutants_are_killed(tmp_path):
    """In copies of the package; whatever a mutant ends with, but for a pass, kills it."""

    def survives(number, file, there, instead, tests):
        tested = ROOT / "tests" / "analysis" / f"{tests}.py"
        return lives(tmp_path / str(number), f"{PACKAGE}/{file}", there, instead, [tested, "-k", f"not {SLOW}"])

    assert survives("none", "laws.py", "", "", "test_laws")  # what is no mistake passes
    with ThreadPool(os.cpu_count()) as pool:
        alive = pool.starmap(survives, [(number, *mutant) for number, mutant in enumerate(MUTANTS)], chunksize=1)
    survived = {(file, instead) for (file, _, instead, _), lived in zip(MUTANTS, alive, strict=True) if lived}
    assert len(survived) <= (1 - SEEN) * len(MUTANTS), survived
    assert survived <= SURVIVORS, survived - SURVIVORS
