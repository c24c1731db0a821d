"""The commit that results say they were made with."""

import os
import subprocess

import pytest

from gfmd_numba.campaign import provenance


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A repository with the source that asks, where nothing is remembered yet."""
    source = tmp_path / "package" / "campaign" / "provenance.py"
    source.parent.mkdir(parents=True)
    source.write_text("first")
    who = ["-c", "user.name=somebody", "-c", "user.email=somebody@example.org"]
    for words in (["init", "-q"], ["add", "."], [*who, "commit", "-q", "-m", "first"]):
        subprocess.run(["git", "-C", str(tmp_path), *words], check=True)
    monkeypatch.setattr(provenance, "__file__", str(source))
    provenance.git_commit.cache_clear()
    yield tmp_path
    provenance.git_commit.cache_clear()


def test_a_commit_is_told_with_what_differs_from_it(repository):
    head = subprocess.run(["git", "-C", str(repository), "rev-parse", "HEAD"], capture_output=True, text=True)
    assert provenance.git_commit() == head.stdout.strip()
    (repository / "package" / "campaign" / "provenance.py").write_text("second")
    provenance.git_commit.cache_clear()
    assert provenance.git_commit() == head.stdout.strip() + "-modified"


def test_asking_for_the_commit_leaves_the_index_alone(repository):
    """As its lock would stay behind where the disk is full."""
    index = repository / ".git" / "index"
    os.utime(repository / "package" / "campaign" / "provenance.py", (1e9, 1e9))  # which git would write down
    before = index.read_bytes()
    assert not provenance.git_commit().endswith("-modified")
    assert index.read_bytes() == before
