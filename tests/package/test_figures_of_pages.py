"""Figures that stand on more than one page agree with the page whose command prints them."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def page(name):
    return " ".join((ROOT / name).read_text(encoding="utf-8").split())


def test_other_codes_take_as_long_in_the_readme_as_where_they_are_compared():
    source = page("docs/peers.md")
    profiles = [int(times) for times in re.findall(r"\| profile 8192 \|(?:[^|]*\|){3} (\d+) \(", source)]
    maps = re.search(r"on profiles and (\d+ to \d+) times as long on maps", source)[1]
    said = f"{min(profiles)} to {max(profiles)} times as long as gfmd-numba on profiles of 8192 nodes, and {maps} times"
    assert len(profiles) > 1
    assert said in page("README.md")


def test_other_codes_take_as_many_times_as_long_as_the_readme_begins_with():
    rows = re.findall(r"\| (?:profile|map) [^|]*\|(?:[^|]*\|){3}( [^\n]*?) \| [pm\-\"]", page("docs/peers.md"))
    least = [float(low) for row in rows for low in re.findall(r"\(([\d.]+) to", row)]
    assert len(least) > 10
    assert min(least) > 10.0
    assert "Other public codes take [over ten times as long](docs/peers.md)" in page("README.md")


@pytest.mark.parametrize("name", ["README.md", *(f"docs/{path.name}" for path in sorted((ROOT / "docs").glob("*.md")))])
def test_no_third_page_says_how_long_other_codes_take(name):
    if name not in ("docs/peers.md", "docs/free_contacts.md"):  # each for its own contacts
        said = re.findall(r"(?:Tamaas|ContactMechanics)[^.|]*? takes? (\d+)[^.|]*? times", page(name))
        assert len(said) == (name == "README.md")


def prices():
    """Rows of the table in docs/accuracy.md that benchmarks/quickstart_prices.py prints: target, round, time, error."""
    table = page("docs/accuracy.md").partition("### What the quickstart campaign costs")[2].partition("###")[0]
    return re.findall(r"\| ([\d.]+) % \| (\d) \| ([\d.]+ (?:s|min)) \| ([\d.]+) % \|", table)


def test_the_readme_has_the_prices_of_the_quickstart_campaign():
    last, readme = {target: time for target, _, time, _ in prices()}, page("README.md")
    assert list(last) == ["3", "2", "1"]
    assert f"an error of κ of 2 % takes {last['2']} of processor time" in readme
    assert f"1 % takes {last['1']} (" in readme


def test_the_picture_of_rounds_has_the_prices_of_the_quickstart_campaign():
    text = page("docs/campaigns.md").partition("![Error against processor time](until.png)")[2]
    rounds = [(time, error) for target, _, time, error in prices() if target == "1"]
    assert len(rounds) > 1
    for time, error in rounds:
        assert f"{time}" in text[:700]
        assert f"{error} %" in text[:700]
