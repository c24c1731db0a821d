"""What all tests share: processes and their threads, pictures that nobody looks at, laws that hold."""

import gc
import io
import os
from pathlib import Path

import psutil
import pytest

_MEMORY = 2 * 2**30  # that a process may come to need

if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # before NumPy is imported: the processes share the cores


def pytest_xdist_auto_num_workers(config):
    """A process for each core, as far as memory goes; this one alone for single files and tests, which start sooner."""
    if any(Path(argument.partition("::")[0]).suffix for argument in config.args):
        return 0
    cores = len(psutil.Process().cpu_affinity()) if hasattr(psutil.Process, "cpu_affinity") else os.cpu_count()
    return max(1, min(cores, psutil.virtual_memory().available // _MEMORY))


def pytest_ignore_collect(collection_path, config):
    """Leave files without long tests out where these alone are asked for: every process would import all of them."""
    if config.option.markexpr == "long" and collection_path.match("test_*.py"):
        return "mark.long" not in collection_path.read_text(encoding="utf-8") or None
    return None


gc.set_threshold(2_000, 10, 100)


def pytest_collection_finish(session):
    """Search none of the objects of thousands of tests for garbage, which takes 0.2 s each time: they stay."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def _written_without_waiting():
    """No test outlives a loss of power, and thousands of them wait for the disk otherwise."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda file: None)
        yield


@pytest.fixture(scope="session", autouse=True)
def _no_pilot():
    """Runs of tests that are not about time measure nothing beforehand."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gfmd_numba.campaign.run._PILOT_SECONDS", 0.0)
        yield


@pytest.fixture(scope="session", autouse=True)
def _read_once():
    """A file of results whose content was read before is a copy of what was found, which is a tenth of the work."""
    from gfmd_numba.campaign import results

    read, known = results.read_dataset, {}

    def read_once(path, *others):
        content = Path(path).read_bytes()
        asked = (content, *others)
        if asked not in known:
            known[asked] = read(path, *others)
            if len(known) > 20:
                del known[next(iter(known))]
        return known[asked].copy(deep=True)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(results, "read_dataset", read_once)
        yield


@pytest.fixture(scope="module")
def undrawn():
    """Write an empty picture for every one: to draw takes longer than to solve, and other tests look at pictures.

    What a command draws beside its results is not even made; `gfmd plot` makes its pictures, but draws none.
    """
    from matplotlib.figure import Figure  # not before the threads are counted

    from gfmd_numba.cli import outputs

    empty = io.BytesIO()
    Figure((0.1, 0.1)).savefig(empty, format="png")

    def write(figure, file, **options):
        (file.write if hasattr(file, "write") else Path(file).write_bytes)(empty.getvalue())

    def unmade(path, drawing, *, err=False):
        outputs.write_picture(path, Figure, err=err)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "savefig", write)
        for commands in ("campaigns", "contacts", "planning"):
            patch.setattr(f"gfmd_numba.cli.{commands}.write_picture", unmade)
        yield


@pytest.fixture(scope="module")
def laws_that_hold():
    """Fits without doubts about the laws of limits, so that surfaces alone decide about their errors and about runs."""
    from support.doubts import without_doubts

    with pytest.MonkeyPatch.context() as patch:
        without_doubts(patch)
        yield
