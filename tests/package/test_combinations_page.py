"""The documentation's page of combinations is what the tables print."""

from pathlib import Path

from click.testing import CliRunner

from gfmd_numba.cli import main
from gfmd_numba.contact.combinations import PHRASES, REFUSALS, combinations_page, has_substitute
from gfmd_numba.solvers.table import ABILITIES

ROOT = Path(__file__).parents[2]


def test_the_committed_page_is_what_the_command_prints():
    printed = CliRunner().invoke(main, ["schema", "combinations"])
    assert printed.exit_code == 0
    committed = (ROOT / "docs/combinations.md").read_text()
    assert printed.output == committed, "run `gfmd schema combinations > docs/combinations.md`"


def test_the_page_holds_every_refusal_and_has_a_phrase_for_every_feature():
    page = " ".join(combinations_page().split()).replace(r"\*", "*")
    assert all(f"Allowed: {row.told()}." in page for row in REFUSALS if has_substitute(row))
    assert all(PHRASES.get(row.refused, row.refused) in page for row in REFUSALS)
    features = {feature for row in REFUSALS for feature in (row.present, row.refused)} | set(ABILITIES)
    assert features - set(PHRASES) == set()
    assert set(PHRASES) - features <= {"hard_wall"}  # which goes with all


def test_the_readme_links_the_page():
    assert "docs/combinations.md" in (ROOT / "README.md").read_text()
