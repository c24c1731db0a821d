"""Every example of the gallery runs as it stands and draws the picture that is shipped beside it."""

import runpy
from pathlib import Path

import pytest

GALLERY = Path(__file__).parents[2] / "docs/gallery"
EXAMPLES = sorted(GALLERY.glob("*.py"))


def test_there_are_eleven_examples_each_with_a_picture_and_a_docstring():
    assert len(EXAMPLES) == 11
    assert sorted(path.stem for path in GALLERY.glob("*.png")) == [path.stem for path in EXAMPLES]
    assert all(path.read_text().startswith('"""') for path in EXAMPLES)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_draws_its_picture(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(path), run_name="__main__")
    assert (tmp_path / path.with_suffix(".png").name).stat().st_size > 5_000
