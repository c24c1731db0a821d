"""What a package index, conda and a reader of the distribution find agrees with pyproject.toml and with the code."""

import ast
import re
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement

import gfmd_numba

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
CONDA_NAMES = {"dask": {"dask-core", "distributed"}, "matplotlib": {"matplotlib-base"}}
NAMED_BY = {"dask": {"dask", "distributed"}}  # distributions that one requirement with its extras brings


def _requirements():
    return [Requirement(text) for text in PROJECT["project"]["dependencies"]]


def _imported(folder):
    """Names of all modules outside the package that its files import, wherever the import stands."""
    names = set()
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                names.add(node.module.partition(".")[0])
    return names - set(sys.stdlib_module_names) - {"gfmd_numba", "_typeshed"}


def _described():
    """README as an index page gets it."""
    text = (ROOT / "README.md").read_text()
    hook = PROJECT["tool"]["hatch"]["metadata"]["hooks"]["fancy-pypi-readme"]
    for substitution in hook["substitutions"]:
        text = re.sub(substitution["pattern"], substitution["replacement"], text)
    return text


def _recipe():
    text = (ROOT / "recipe/meta.yaml").read_text()
    lines = [line for line in text.splitlines() if not line.startswith("{%")]
    return yaml.safe_load("\n".join(lines).replace("{{ version }}", "0").replace("{{ PYTHON }}", "python"))


@pytest.mark.long
def test_a_plain_installation_brings_what_is_imported_and_no_more():
    distributions = packages_distributions()
    imported = {
        name.lower() for module in _imported(ROOT / "gfmd_numba") for name in distributions.get(module, [module])
    }
    required = {name for r in _requirements() for name in NAMED_BY.get(r.name, {r.name.lower()})}
    extras = PROJECT["project"]["optional-dependencies"]
    optional = {
        Requirement(extras[name][0]).name.lower() for name in ("instruments", "functions", "cluster", "mpi")
    } | {"dask_jobqueue"}
    with_another = {"pydantic_core"}  # which pydantic pins
    by_name = {
        "pyfftw",
        "cryptography",
    }  # fourier/transform.py loads its compiled module; dask needs the other for TLS
    assert imported - optional - with_another | by_name == required


def test_the_conda_recipe_needs_what_the_wheel_needs():
    expected = {"python >=3.11"}
    for requirement in _requirements():
        names = CONDA_NAMES.get(requirement.name, {requirement.name.lower()})
        expected |= {f"{name} {requirement.specifier}" for name in names}
    recipe = _recipe()
    assert set(recipe["requirements"]["run"]) == expected
    assert set(recipe["requirements"]["host"]) - {"pip", "python >=3.11"} == {
        text.replace(">=", " >=") for text in PROJECT["build-system"]["requires"]
    }


def test_the_version_stands_in_one_place():
    files = [ROOT / name for name in ("pyproject.toml", "CITATION.cff", "recipe/meta.yaml", "README.md")]
    assert not [path for path in files if gfmd_numba.__version__ in path.read_text()]
    pattern = re.search(r"regex_pattern='([^']+)'", (ROOT / "recipe/meta.yaml").read_text())[1]
    assert re.search(pattern, (ROOT / "gfmd_numba/__init__.py").read_text())[1] == gfmd_numba.__version__
    assert f"## {gfmd_numba.__version__}" in (ROOT / "CHANGELOG.md").read_text()


def test_an_index_page_has_no_relative_links():
    targets = re.findall(r"\]\(([^)]+)\)", _described())
    assert len(targets) > 10
    assert not [target for target in targets if not target.startswith(("https://", "#"))]
    assert "/raw/v$HFPR_VERSION/docs/gallery/map.png)" in _described()


def test_one_address_stands_in_all_metadata():
    text = "".join((ROOT / name).read_text() for name in ("pyproject.toml", "recipe/meta.yaml", "CITATION.cff"))
    assert len(set(re.findall(r"https://([^/\"'\s)]+)", text.replace("https?://", "")))) == 1


PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_every_link_of_a_page_leads_to_a_file(page):
    for target in re.findall(r"\]\((?!https?://|#)([^)#]+)", page.read_text()):
        assert (page.parent / target).exists(), target


def test_type_checkers_may_read_the_package():
    assert (ROOT / "gfmd_numba/py.typed").exists()
