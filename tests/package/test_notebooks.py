"""The notebooks next to the campaigns need one file each; committed ones are executed, small and name no machine."""

import re
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

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
ROUGH_BODIES = (("1 / 32", "1 / 8"),)
PATHS = (
    ("realisations = 3", "realisations = 2"),
    ("1 / 32", "1 / 4"),
    ("[2e-5, 4e-5, 6e-5, 8e-5]", "[5e-6, 1e-5]"),
    ("same.isel(case=3", "same.isel(case=1"),
    ("-7e-3, 21", "-7e-3, 8"),
    ("1.5e-3, 1024", "1.5e-3, 256"),
    ("3.2, 4.0", "1.7, 1.8"),
    ("-0.065, 51", "-0.065, 8"),
)
# notebook: the file that it reads, and what is shrunk in it; a notebook of no file is shrunk itself
NOTEBOOKS = {
    "01-first-campaign": ("given-levels.yaml", QUICKSTART),
    "02-tfc-limit": ("given-levels.yaml", QUICKSTART),
    "03-thesis-revisited": ("thesis-chapter4.yaml", CHAPTER_4),
    "04-what-accuracy-costs": ("given-levels.yaml", QUICKSTART),
    "05-two-step-fields": ("two-step-fields.py", ROUGH_BODIES),
    "06-friction-and-adhesion": (None, PATHS),
}


def test_every_notebook_is_tested():
    assert sorted(NOTEBOOKS) == sorted(path.stem for path in CAMPAIGNS.glob("*.ipynb"))


@pytest.mark.long
@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_makes_what_it_needs_from_one_file_at_most(name, tmp_path, monkeypatch):
    file, replacements = NOTEBOOKS[name]
    own = CAMPAIGNS / f"{name}.ipynb"
    source = own if file is None else CAMPAIGNS / file
    text = source.read_text()
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    (tmp_path / source.name).write_text(text)
    notebook = nbformat.read(tmp_path / own.name if file is None else own, as_version=4)
    assert file is None or file in notebook.cells[0].source
    for folder in ("JUPYTER_RUNTIME_DIR", "IPYTHONDIR"):
        monkeypatch.setenv(folder, str(tmp_path / folder))
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    errors = [output for cell in notebook.cells for output in cell.get("outputs", []) if output.get("name") == "stderr"]
    assert not errors


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_committed_notebook_is_executed_small_and_anonymous(name):
    path = CAMPAIGNS / f"{name}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    outputs = [output for cell in cells for output in cell.outputs]
    assert not [output for output in outputs if output.output_type == "error" or output.get("name") == "stderr"]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    assert path.stat().st_size < 300_000
    assert not re.search(r"/(home|root|tmp|Users|usr|work)/|[A-Z]:\\\\", path.read_text())
    imported = re.findall(r"^(?:import|from) (\w+)", "\n".join(cell.source for cell in cells), flags=re.MULTILINE)
    assert set(imported) <= {"gfmd_numba", "matplotlib", "numpy", "xarray", *sys.stdlib_module_names}
