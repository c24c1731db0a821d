"""The paper cites what its bibliography holds, says what the pages say, and builds where there is pandoc."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAPER = (ROOT / "paper/paper.md").read_text(encoding="utf-8")


def test_every_reference_is_cited_and_every_citation_has_one():
    entries = re.findall(r"^@\w+\{(\w+),", (ROOT / "paper/paper.bib").read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(set(re.findall(r"@(\w+\d{4}|contactmechanics)\b", PAPER))) == sorted(entries)


def test_the_paper_has_the_sections_of_its_journal_and_the_figures_of_the_pages():
    sections = re.findall(r"^# (.+)$", PAPER, re.MULTILINE)
    assert sections == ["Summary", "Statement of need", "State of the field", "Limitations", "References"]
    words, readme = (" ".join(text.split()) for text in (PAPER, (ROOT / "README.md").read_text(encoding="utf-8")))
    total, held = re.search(r"Of (\d+) intervals of 90 % confidence, \[(\d+) held\]", readme).groups()
    _, *slower = re.findall(r"[\d.]+ to \d+ times as long", readme)  # the first is over all codes
    assert len(slower) == 3
    for figure in (f"In {total} campaigns", f"{held} of the 90 % intervals", *slower):
        assert figure in words


@pytest.mark.skipif(shutil.which("pandoc") is None, reason="no pandoc (apt-get install pandoc)")
def test_the_paper_builds(tmp_path):
    command = ["pandoc", "paper.md", "--citeproc", "--standalone", "-o", str(tmp_path / "paper.html")]
    done = subprocess.run(command, cwd=ROOT / "paper", capture_output=True, text=True, check=True)
    assert "not found" not in done.stderr
    assert (tmp_path / "paper.html").read_text(encoding="utf-8").count("csl-entry") > 10
