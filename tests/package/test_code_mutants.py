"""Mistakes put into the fit of the limit are seen by its tests."""

import os
from multiprocessing.pool import ThreadPool
from pathlib import Path

import pytest

from support.code_mutants import MUTANTS, PACKAGE
from support.mutated_package import lives

ROOT = Path(__file__).parents[2]
TESTS = ROOT / "tests" / "analysis"


def test_every_mutant_changes_one_place():
    for file, there, instead, test in MUTANTS:
        assert (ROOT / PACKAGE / file).read_text(encoding="utf-8").count(there) == 1, there
        assert there != instead
        tests, _, name = test.partition("::")
        assert f"\ndef {name.partition('[')[0]}(" in (TESTS / tests).read_text(encoding="utf-8")


@pytest.mark.long
def test_mutants_are_killed(tmp_path):
    """In copies of the package; whatever a mutant ends with, but for a pass, kills it."""

    def survives(number, file, there, instead, test):
        return lives(tmp_path / str(number), f"{PACKAGE}/{file}", there, instead, [TESTS / test])

    assert survives("none", "laws.py", "", "", "test_laws.py")  # what is no mistake passes
    with ThreadPool(os.cpu_count()) as pool:
        alive = pool.starmap(survives, [(number, *mutant) for number, mutant in enumerate(MUTANTS)], chunksize=1)
    assert [mutant[:3] for mutant, lived in zip(MUTANTS, alive, strict=True) if lived] == []
