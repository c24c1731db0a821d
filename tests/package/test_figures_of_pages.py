"""Figures that stand on more than one page agree with the page whose command prints them."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def page(name):
    return " ".join((ROOT / name).read_text(encoding="utf-8").split())


def ratios_of_other_codes(kind):
    """Times that other codes take as long, of each contact of a kind: medians over its surfaces, by the code."""
    tables = (ROOT / "docs/peers.md").read_text(encoding="utf-8").split("| contact |")[1:]
    head, *rows = next(each for each in tables if f"| {kind} " in each).splitlines()
    codes = [name.strip() for name in head.split("|")[3:-1]]
    cells = [[cell.strip() for cell in row.split("|")[1:-1]] for row in rows if row.startswith(f"| {kind} ")]
    return {(row[0], *row[1:3]): dict(zip(codes, (float(c.split()[0]) for c in row[4:]), strict=True)) for row in cells}


def test_other_codes_take_as_long_in_the_readme_as_where_they_are_compared():
    profiles = [
        times["Tamaas"] for case, times in ratios_of_other_codes("profile").items() if case[0] == "profile 8192"
    ]
    maps = {name: [times[name] for times in ratios_of_other_codes("map").values()] for name in ("Tamaas", "ASPHER")}
    tamaas, aspher = (f"{min(each):g} to {max(each):g} times as long" for each in maps.values())
    said = (
        f"Tamaas takes {min(profiles):g} to {max(profiles):g} times as long as gfmd-numba on profiles of 8192 nodes, "
    )
    assert len(profiles) > 1
    assert f"{said}and {tamaas} on maps; ASPHER takes {aspher} on maps" in page("README.md")


def test_other_codes_take_as_many_times_as_long_as_the_readme_begins_with():
    every = [
        times
        for kind in ("profile", "map")
        for of_case in ratios_of_other_codes(kind).values()
        for times in of_case.values()
    ]
    assert len(every) > 30
    assert f"Other public codes take [{min(every):g} to {max(every):g} times as long](docs/peers.md)" in page(
        "README.md"
    )


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
