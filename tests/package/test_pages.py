"""Pages that people read: no table is wider than a terminal, and the README comes to the point in two screens."""

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NARROW = (
    *("accuracy", "bodies", "campaigns", "errata", "hard-cases", "licences", "limit", "maps", "results", "statistics"),
    *("surfaces", "two-step"),
)


@pytest.mark.parametrize("page", ["README.md", *(f"docs/{name}.md" for name in NARROW)])
def test_no_table_is_wider_than_80_columns(page):
    lines = (ROOT / page).read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if line.lstrip().startswith("|") and len(line) > 80] == []


def test_the_readme_comes_to_more_after_two_screens():
    before, found, _ = (ROOT / "README.md").read_text(encoding="utf-8").partition("\n## More\n")
    assert found
    assert before.count("\n") <= 100
