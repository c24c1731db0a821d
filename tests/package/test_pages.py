"""Pages that people read: no wide table, no long line, and the README comes to the point in two screens."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NARROW = (
    *(
        "accuracy",
        "architecture",
        "bodies",
        "campaigns",
        "clusters",
        "combinations",
        "errata",
        "friction",
        "hard-cases",
    ),
    *("hardness", "licences", "limit", "maps", "peers", "results", "statistics", "surfaces", "two-step"),
)


@pytest.mark.parametrize("page", ["README.md", *(f"docs/{name}.md" for name in NARROW)])
def test_no_table_is_wider_than_80_columns(page):
    lines = (ROOT / page).read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if line.lstrip().startswith("|") and len(line) > 80] == []


@pytest.mark.parametrize("page", ["README.md", "CHANGELOG.md", *(f"docs/{name}.md" for name in NARROW)])
def test_no_line_of_prose_is_longer_than_120_characters(page):
    text = re.sub(r"^ *```.*?^ *```$", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    assert [line for line in text.splitlines() if len(line) > 120 and not line.startswith("    ")] == []


def test_the_readme_comes_to_more_after_two_screens():
    before, found, _ = (ROOT / "README.md").read_text(encoding="utf-8").partition("\n## More\n")
    assert found
    assert before.count("\n") <= 100
