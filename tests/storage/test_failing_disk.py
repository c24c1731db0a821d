"""A disk that fails at any call: what stood there is unharmed, what was said to be finished is, and a run resumes."""

import shutil
from contextlib import suppress

import pytest

import gfmd_numba
from gfmd_numba.campaign import collection, failures
from gfmd_numba.campaign.failures import Failure
from gfmd_numba.campaign.run import Choice, StoppedError, run
from gfmd_numba.campaign.shards import Finished
from gfmd_numba.campaign.status import verify
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.storage.atomic_file import replace
from gfmd_numba.storage.mark import begins_with
from support.campaigns import TINY, campaign
from support.failing_disk import FailingDisk


@pytest.fixture(scope="module", autouse=True)
def _quick():
    """Nothing is compiled beforehand, and git is not asked."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gfmd_numba.campaign.run.compile_kernels", lambda problems: None)
        patch.setattr(collection, "git_commit", str)
        yield


@pytest.fixture(scope="module")
def begun(tmp_path_factory):
    """An output directory with half of the work done, a failed block and results, and the digest of all of them."""
    folder = tmp_path_factory.mktemp("begun")
    path = campaign(folder, TINY + "grid: {hurst: [0.3, 0.8]}\n")
    run(path, folder / "whole", Workers(0))
    digest = gfmd_numba.open_campaign(folder / "whole").attrs["content_sha256"]
    run(path, folder / "out", Workers(0), choice=Choice(limit=1))
    return path, folder / "out", digest


def contents(folder):
    return {file.relative_to(folder): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def test_a_write_that_fails_at_any_call_leaves_the_old_file_or_the_new_one(tmp_path):
    ours, old, new = begins_with(b"gfmd"), b"gfmd old", b"gfmd new" * 1000
    for full in (False, True):
        at, refused = 0, "yes"
        while refused:
            file = tmp_path / f"{full}{at}" / "file"
            file.parent.mkdir()
            file.write_bytes(old)
            with FailingDisk(file.parent, at, full).mounted() as disk, suppress(OSError):
                replace(file, [new], ours)
            refused = disk.refused
            assert file.read_bytes() in ((old, new) if refused.startswith("fsync") or not refused else (old,))
            assert list(file.parent.iterdir()) == [file]
            at += 1
        assert at > 5
        assert file.read_bytes() == new


@pytest.mark.parametrize(
    ("start", "full", "every"),
    [
        pytest.param("nothing", False, 5, marks=pytest.mark.long),
        pytest.param("half", True, 5, marks=pytest.mark.long),
        ("half", True, 61),
    ],
)
def test_a_run_on_a_disk_that_fails_at_any_call_resumes(begun, tmp_path, start, full, every):
    path, half, digest = begun
    at, refused, said = 0, "yes", set()
    while refused:
        out = tmp_path / f"{at}" / "out"
        out.parent.mkdir()
        if start == "half":
            shutil.copytree(half, out)
            block = next(iter(set(Finished(half))))
            failures.record(out, block, Failure("crashed", "boom"))
        sound = {name: content for name, content in contents(out).items() if name.suffix == ".shard"}
        with FailingDisk(out, at, full).mounted() as disk:
            try:
                run(path, out, Workers(0), choice=Choice(retry_failed=True))
            except StoppedError as error:
                said.add(str(error))
        refused = disk.refused
        assert sound.items() <= contents(out).items(), refused
        finished = Finished(out)
        assert all(finished.is_sound(name) for name in finished), refused
        run(path, out, Workers(0), choice=Choice(retry_failed=True))
        assert gfmd_numba.open_campaign(out).attrs["content_sha256"] == digest, refused
        verdict = verify(out)
        assert (verdict.damaged, verdict.missing, verdict.altered) == ([], 0, {}), refused
        at += every
    assert at > (20 if start == "half" else 40)
    assert all("finished work is kept, the same command resumes" in sentence for sentence in said)
    assert all(str(tmp_path) in sentence for sentence in said)  # which file it was
