"""Every example of the gallery runs as it stands and draws the picture that is shipped next to it."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

GALLERY = Path(__file__).parents[2] / "docs/gallery"
EXAMPLES = sorted(GALLERY.glob("*.py"))


def test_there_are_sixteen_examples_each_with_a_picture_and_a_docstring():
    assert len(EXAMPLES) == 16
    assert sorted(path.stem for path in GALLERY.glob("*.png")) == [path.stem for path in EXAMPLES]
    assert all(path.read_text().startswith('"""') for path in EXAMPLES)


def limit_is_that_of_finer_levels(example):
    """At H = 0.8 a campaign of many more surfaces, with finer levels, finds 1.957 +- 0.023."""
    kappa, error = (example["fit"][name].sel(group=1).item() for name in ("kappa_tfc", "kappa_tfc_error"))
    assert abs(kappa - 1.957) < 2.0 * np.hypot(error, 0.023)


def share_that_differs(one, other):
    """Share of the pixels that differ by more than other versions of FreeType draw the edges of letters."""
    return (abs(one - other).max(axis=-1) > 0.25).mean()


def test_a_picture_without_its_lines_is_another():
    shipped = imread(GALLERY / "load_curve.png")[..., :3]
    line = abs(shipped - to_rgb("#0072B2")).max(axis=-1) < 0.05
    assert share_that_differs(shipped, np.where(line[..., np.newaxis], 1.0, shipped)) > 0.002


CLAIMS = {"campaign": limit_is_that_of_finer_levels}


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:.*this body is glassy")  # of rubber at high speeds, which shows just that
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_draws_its_picture(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    example = runpy.run_path(str(path), run_name="__main__")
    CLAIMS.get(path.stem, dict)(example)
    drawn, shipped = (imread(folder / path.with_suffix(".png").name)[..., :3] for folder in (tmp_path, GALLERY))
    assert drawn.shape == shipped.shape
    assert share_that_differs(drawn, shipped) < 0.002
