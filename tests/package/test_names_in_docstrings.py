"""Docstrings and comments name files, classes and attributes that exist."""

import ast
import itertools
import re
from pathlib import Path

import gfmd_numba

PACKAGE = Path(gfmd_numba.__file__).parent
SOURCES = {file.relative_to(PACKAGE): file.read_text("utf-8") for file in sorted(PACKAGE.rglob("*.py"))}
QUOTED = re.compile(r"`([\w/]+\.py)`|`((?:\w+\.)+\w+)`")
ELSEWHERE = {"Dataset", "MPI"}  # of xarray, mpi4py


def names_by_owner():
    """Names in each module, room and class, by what a docstring calls it."""
    found = {}
    for path, source in SOURCES.items():
        words = set(re.findall(r"\w+", source))
        for owner in (path.stem, *path.parent.parts):
            found.setdefault(owner, set()).update(words)
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.ClassDef):
                body = [each for each in ast.walk(node) if isinstance(each, (ast.FunctionDef, ast.Name, ast.Attribute))]
                own = {getattr(each, "name", getattr(each, "id", getattr(each, "attr", None))) for each in body}
                found.setdefault(node.name, set()).update(
                    own, *(found.get(getattr(base, "id", ""), ()) for base in node.bases)
                )
    return found


def missing(sources, owners):
    """Quoted names of which there is no file, or that their class or module does not have."""
    for path, source in sources.items():
        for file, dotted in QUOTED.findall(source):
            if file and not any(f"/{each.as_posix()}".endswith(f"/{file}") for each in SOURCES):
                yield f"{path}: {file}"
            parts = [part for part in dotted.split(".") if part]
            for owner, name in itertools.pairwise(parts):
                if owner in owners and owner not in ELSEWHERE and name not in owners[owner]:
                    yield f"{path}: {dotted}"


def test_names_in_docstrings_exist():
    owners = names_by_owner()
    stale = {Path("solvers/friction/x.py"): "`kernels.ContactLimits.held`, `solvers/coulomb_cone.py`, `Contact.punch`"}
    assert len(list(missing(stale, owners))) == 2
    benchmarks = {path: re.sub(r"`benchmarks/\w+\.py`", "", source) for path, source in SOURCES.items()}
    assert not list(missing(benchmarks, owners))
