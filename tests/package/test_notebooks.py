"""The notebooks next to the campaigns need one file each; committed ones are executed, small and name no machine."""

import json
import re
import sys
from itertools import chain
from pathlib import Path

import matplotlib
import pytest
from matplotlib import pyplot as plt

CAMPAIGNS = Path(__file__).parents[2] / "campaigns"

QUICKSTART = (
    (
        "{reference: 60, eps_c: [20, 40, 20], eps_f: [150, 90, 30, 24], eps_t: [210, 80], cross: [300, 60, 60]}",
        "{reference: 8, eps_c: 6, eps_f: [12, 10, 7, 6], eps_t: [10, 7], cross: 8}",
    ),
    ("{eps_c: 1/2, eps_f: 1/1024, eps_t: 1/4}", "{eps_c: 1/2, eps_f: 1/64, eps_t: 1/4}"),
    ("{eps_f: 1/256, eps_t: 1}", "{eps_f: 1/32, eps_t: 1}"),
    ("{eps_c: 1/4, eps_f: 1/256}", "{eps_c: 1/4, eps_f: 1/32}"),
    ("[1/64, 1/256, 1/4096, 1/16384]", "[1/16, 1/32, 1/128, 1/256]"),
    ("{eps_c: [3/2, 5/2], eps_f: [1/5, 2], eps_t: [1/2, 3/2]}", "{eps_c: 2, eps_f: 1, eps_t: 1}"),  # nothing to search
)
CHAPTER_4 = (
    ("realisations: 30", "realisations: 4"),
    ("eps_f: 1/1024, eps_t: 1/2}", "eps_f: 1/32, eps_t: 1/2}"),
    ("[1/512, 1/1024, 1/2048, 1/4096]", "[1/16, 1/32, 1/64, 1/128]"),
)
ROUGH_BODIES = (("1 / 32", "1 / 8"), ("(0.003, 0.01, 0.03, 0.1, 0.2)", "(0.01, 0.1)"))
PATHS = (
    ("realisations = 3", "realisations = 2"),
    ("1 / 32", "1 / 4"),
    ("(0, 1, 6)", "(0, 1, 3)"),
    ("(1, -1, 11)", "(1, -1, 5)"),
    ("-4e-3, 3e-3, 8", "-4e-3, 3e-3, 3"),
    ("[2e-5, 4e-5, 6e-5, 8e-5]", "[5e-6]"),
    ("same.isel(case=3", "same.isel(case=0"),
    ("-7e-3, 21", "-7e-3, 5"),
    ("1.5e-3, 1024", "1.5e-3, 256"),
    ("3.2, 4.0", "1.7, 1.8"),
    ("-0.065, 51", "-0.065, 6"),
)
RUBBER = (("1 / 16", "1 / 8"), ("1e3, 9", "1e3, 3"), ("1e2, 10", "1e2, 4"), ("realisations=2", "realisations=1"))
COARSER = (
    ('"--realisations", "8"', '"--realisations", "2"'),
    ('"eps_f: 1/1024", "eps_f: 1/128"', '"eps_f: 1/64", "eps_f: 1/16"'),
)
# a file, what is shrunk in it and in the notebooks that read it; notebooks of no file need none
NOTEBOOKS = {
    "given-levels.yaml": ((*QUICKSTART, *COARSER), "01-first-campaign", "02-tfc-limit", "04-what-accuracy-costs"),
    "thesis-chapter4.yaml": (CHAPTER_4, "03-thesis-revisited"),
    "two-step-fields.py": (ROUGH_BODIES, "05-two-step-fields"),
    None: ((*PATHS, *RUBBER), "06-friction-and-adhesion", "07-rubber"),
}
NAMES = sorted(name for _, *names in NOTEBOOKS.values() for name in names)


def cells_of(name):
    """Return the code of each cell of a notebook."""
    cells = json.loads((CAMPAIGNS / f"{name}.ipynb").read_text())["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


def test_every_notebook_is_tested():
    assert sorted(path.stem for path in CAMPAIGNS.glob("*.ipynb")) == NAMES


@pytest.mark.long
@pytest.mark.parametrize("file", NOTEBOOKS, ids=str)
def test_notebooks_make_what_they_need_from_one_file_at_most(file, tmp_path, monkeypatch):
    """In one folder, so that a campaign that several of them read is run once; a warning is an error."""
    replacements, *names = NOTEBOOKS[file]
    texts = [*map(cells_of, names)]
    given = "" if file is None else (CAMPAIGNS / file).read_text()
    for old, new in replacements:
        assert any(old in text for text in (given, *chain(*texts)))
        given, texts = given.replace(old, new), [[cell.replace(old, new) for cell in cells] for cells in texts]
    if file is not None:
        (tmp_path / file).write_text(given)
    monkeypatch.chdir(tmp_path)
    for name, cells in zip(names, texts, strict=True):
        made = {"__name__": "__main__"}
        with matplotlib.rc_context({"backend": "agg"}):
            for i, cell in enumerate(cells):
                exec(compile(cell, f"{name}, cell {i}", "exec"), made)
                for number in plt.get_fignums():
                    plt.figure(number).draw_without_rendering()
                plt.close("all")
        assert file is None or file in "".join(cells)


@pytest.mark.parametrize("name", NAMES)
def test_a_committed_notebook_is_executed_small_and_anonymous(name):
    path = CAMPAIGNS / f"{name}.ipynb"
    notebook = json.loads(path.read_text())
    assert notebook["nbformat"] == 4
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    outputs = [output for cell in cells for output in cell["outputs"]]
    assert not [output for output in outputs if output["output_type"] == "error" or output.get("name") == "stderr"]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    assert path.stat().st_size < 300_000
    assert not re.search(r"/(home|root|tmp|Users|usr|work)/|[A-Z]:\\\\", path.read_text())
    imported = re.findall(r"^(?:import|from) (\w+)", "\n".join(cells_of(name)), flags=re.MULTILINE)
    assert set(imported) <= {"gfmd_numba", "matplotlib", "numpy", "xarray", *sys.stdlib_module_names}
