"""Every example of the gallery runs as it stands, quickly, and draws the picture that is shipped beside it."""

import runpy
import time
from pathlib import Path

import pytest

GALLERY = Path(__file__).parents[2] / "docs/gallery"
EXAMPLES = sorted(GALLERY.glob("*.py"))
SECONDS = 10.0  # processor time of one example; all together take less than 45 s


def test_there_are_eleven_examples_each_with_a_picture_and_a_docstring():
    assert len(EXAMPLES) == 11
    assert sorted(path.stem for path in GALLERY.glob("*.png")) == [path.stem for path in EXAMPLES]
    assert all(path.read_text().startswith('"""') for path in EXAMPLES)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_draws_its_picture(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    begun = time.process_time()
    runpy.run_path(str(path), run_name="__main__")
    assert time.process_time() - begun < SECONDS
    assert (tmp_path / path.with_suffix(".png").name).stat().st_size > 5_000
