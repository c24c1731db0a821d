"""Every kind of file, altered at random, is read and solved, or refused with a reason, in bounded time and memory."""

import os
import re
import subprocess
import sys
import warnings

import pytest
import yaml

from gfmd_numba.scene import InputError
from support import mutants
from support.forked_trial import can_be_read, tried_in_a_fork  # noqa: F401

MANY, FEW = 12, 30  # of each kind
SECONDS, BYTES = 60, 10 * 2**30  # that one may take


def tried(folder, kind, seed):
    """What is said of a mutant, None if nothing; anything but an InputError is a failure."""
    with warnings.catch_warnings(action="ignore"):
        path = mutants.write_mutant(folder, kind, seed)
        try:
            mutants.use(kind, path)
        except InputError as error:
            return str(error)
    return None


@pytest.mark.long
@pytest.mark.parametrize("kind", mutants.TEXTS)
@pytest.mark.filterwarnings("ignore:steps_used_up:UserWarning")
def test_what_the_mutants_were_made_from_is_good(tmp_path, kind):
    path = mutants.write_mutant(tmp_path, kind, 0)
    for text in mutants.TEXTS[kind]:
        path.write_text(text, encoding="utf-8")
        assert isinstance(yaml.safe_load(text), dict)
        mutants.use(kind, path)


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=pytest.mark.long if kind == "nc" else ()) for kind in mutants.KINDS]
)
def test_a_mutant_is_used_or_refused_with_a_reason(tmp_path, kind):
    few = {"nc": 2 * FEW, "scene": FEW // 2, "csv": FEW // 2}.get(kind, FEW)  # hardly any netCDF file survives
    said = [tried(tmp_path, kind, seed) for seed in range(few)]
    assert None in said  # some are good: more than the reading is tried
    for message in filter(None, said):
        assert all(re.search("you gave .*; gfmd (allows|needs) ", line) for line in message.splitlines())
        assert len(message) < 8500


FOUND = [("scene", 1424)]  # a time step of 5e-324


@pytest.mark.parametrize(("kind", "seed"), FOUND)
def test_a_mutant_that_once_ended_otherwise_is_used_or_refused(tmp_path, kind, seed):
    tried(tmp_path, kind, seed)


@pytest.mark.long
def test_many_mutants_are_used_or_refused_in_bounded_time_and_memory(tmp_path):
    """In a process of their own, which the bounds end; a fork of it reads each netCDF file first."""
    first = int.from_bytes(os.urandom(6), "big")
    script = (
        "import resource, signal, sys; from pathlib import Path; import test_mutants as t\n"
        "from gfmd_numba.roughness import surface_files; surface_files.can_be_read = t.can_be_read\n"
        f"resource.setrlimit(resource.RLIMIT_AS, ({BYTES}, {BYTES}))\n"
        "for kind in t.mutants.KINDS:\n"
        f"    for seed in range({first}, {first + MANY}):\n"
        f"        print(kind, seed, file=sys.stderr); signal.alarm({SECONDS}); t.tried(Path('.'), kind, seed)\n"
    )
    path = os.pathsep.join(sys.path)
    done = subprocess.run(
        [sys.executable, "-c", script],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-3000:]
