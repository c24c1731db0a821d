"""Build the documentation site: python docs/site/build.py FOLDER. Any warning is an error."""

from __future__ import annotations

import pkgutil
import shutil
import sys
import tempfile
from pathlib import Path

import reference
from sphinx.cmd.build import main as sphinx

from gfmd_numba import theory
from gfmd_numba.cli import main as gfmd
from gfmd_numba.cli.inspection import schemas

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "CODE_OF_CONDUCT.md", "SECURITY.md")
FOLDERS = ("docs", "campaigns", "benchmarks", "tests")  # the pages, and what they link to


def assemble(tree: Path) -> None:
    """Copy the pages into an empty folder, as they link to each other, and print the reference next to them."""
    for page in PAGES:
        shutil.copy(ROOT / page, tree)
    for name in ("LICENSE", "CITATION.cff"):
        shutil.copy(ROOT / name, tree)
    for folder in FOLDERS:
        shutil.copytree(ROOT / folder, tree / folder, ignore=shutil.ignore_patterns("__pycache__", ".*"))
    shutil.copy(HERE / "index.md", tree)
    written = tree / "docs/reference"
    written.mkdir()
    (tree / "docs/gallery/index.md").write_text(reference.gallery_page(ROOT / "docs/gallery"))
    modules = sorted(module.name for module in pkgutil.iter_modules(theory.__path__))
    pages = {
        "keys": reference.keys_page(schemas()),
        "commands": reference.commands_page(gfmd),
        "files": reference.files_page(),
        "python": reference.python_page(modules),
    }
    for name, text in pages.items():
        (written / f"{name}.md").write_text(text)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        assemble(Path(folder))
        options = ["-W", "--keep-going", "-q", "-b", "html", "-c", str(HERE), "-d", f"{folder}/.doctrees"]
        sys.exit(sphinx([*options, folder, sys.argv[1]]))
