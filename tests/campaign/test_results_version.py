"""Shards of another version of the code or of the tables are never taken for those of this one."""

import ast
import shutil
from pathlib import Path

import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.campaign.plan import plan
from gfmd_numba.contact import evaluation, problem
from gfmd_numba.contact.observables import OBSERVABLES, Observable
from gfmd_numba.solvers.table import SOLVERS
from support.campaigns import SMALL, campaign
from support.campaigns import TINY as SMALLEST
from support.command_line import python

TINY = SMALL.replace("limits", "# limits").replace("hurst: [0.3, 0.8]", "hurst: [0.8]")


@pytest.fixture(autouse=True)
def _fresh():
    problem.results_version.cache_clear()
    yield
    problem.results_version.cache_clear()


@pytest.mark.long
def test_a_new_observable_is_computed_and_no_old_shard_is_used(tmp_path, monkeypatch):
    path = campaign(tmp_path, TINY)
    gfmd_numba.run(path, tmp_path / "out", workers=0)
    (before,) = {case.problem.identity for case in plan(path).cases}
    toy = Observable("pressure", "largest pressure", "gfmd_numba.contact.evaluation:largest_pressure")
    monkeypatch.setattr(
        evaluation, "largest_pressure", lambda contact: contact.equilibrium.pressure.max(axis=-1), raising=False
    )
    monkeypatch.setitem(OBSERVABLES, "largest_pressure", toy)
    problem.results_version.cache_clear()
    (after,) = {case.problem.identity for case in plan(path).cases}
    assert before != after
    dataset = gfmd_numba.run(path, tmp_path / "out", workers=0)
    assert set(dataset["case_id"].values) == {after}
    assert (dataset["status"] == 0).all()
    assert (dataset["largest_pressure"] > dataset["mean_pressure"]).all()
    assert dataset["largest_pressure"].long_name == "largest pressure"
    shards = {file.name.split("-")[0] for file in (tmp_path / "out" / "shards").glob("*.shard")}
    assert shards == {before, after}
    with xr.open_dataset(tmp_path / "out" / "small.nc") as written:
        assert "largest_pressure" in written


def test_the_version_follows_units_and_solvers_but_not_prose(monkeypatch):
    found = problem.results_version()

    def changed(table, name, **fields):
        with monkeypatch.context() as patch:
            patch.setitem(table, name, type(table[name])(**(vars(table[name]) | fields)))
            problem.results_version.cache_clear()
            return problem.results_version()

    assert changed(OBSERVABLES, "kappa", unit="pressure") != found
    assert changed(SOLVERS, "verlet", gives_up_after=7) != found
    assert changed(OBSERVABLES, "kappa", long_name="another sentence") == found
    assert changed(SOLVERS, "verlet", sentence="another sentence") == found


PACKAGE = Path(gfmd_numba.__file__).parent


class _WithoutProse(ast.NodeTransformer):
    def visit_Expr(self, node):
        return None if isinstance(node.value, ast.Constant) else node


def code_of(text):
    return ast.dump(_WithoutProse().visit(ast.parse(text)))


def _as_string(found):
    """What is left out of a module, as a string without words where it is one."""
    prose = found["prose"] or b""
    docstring = prose.lstrip(b"rR").startswith(b'"""')
    return found["kept"] or (found[0].replace(prose, b'""') if docstring else b"")


@pytest.mark.long
def test_nothing_but_prose_is_left_out_of_the_version():
    left_out = 0
    for file in PACKAGE.rglob("*.py"):
        content = file.read_bytes()
        if file.relative_to(PACKAGE).parts[0] in problem._MAKE_NO_NUMBERS:
            continue
        assert code_of(problem._PROSE.sub(_as_string, content)) == code_of(content), file
        left_out += len(content) - len(problem._PROSE.sub(rb"\g<kept>", content))
    assert left_out > 100_000


@pytest.mark.long
def test_any_change_of_code_that_makes_numbers_is_another_version_and_prose_is_not(tmp_path):
    package = shutil.copytree(PACKAGE, tmp_path / "package", ignore=shutil.ignore_patterns("__pycache__"))
    same = problem.code_digest(package)
    assert same == problem.code_digest(PACKAGE)
    contents = {file: file.read_bytes() for file in package.rglob("*.py")}
    for file, content in contents.items():
        file.write_bytes(content + b'\n# a remark\n"""A docstring\nof two lines."""\n')
    assert problem.code_digest(package) == same
    one_of_each_folder = {file.parent: (file, content) for file, content in sorted(contents.items())}
    makes_numbers = 0
    for file, content in one_of_each_folder.values():
        file.write_bytes(content + b"CHANGED = 1\n")
        differs = problem.code_digest(package) != same
        assert differs == (file.relative_to(package).parts[0] not in problem._MAKE_NO_NUMBERS)
        makes_numbers += differs
        file.write_bytes(content)
    assert makes_numbers > 6
    (package / "new_room").mkdir()
    (package / "new_room" / "solver.py").write_text("x = 1\n")
    assert problem.code_digest(package) != same


IN_A_BLOCK = """
import sys
from gfmd_numba.campaign.plan import plan
problem = next(iter(plan(sys.argv[1]).blocks)).problem
before = set(sys.modules)
from gfmd_numba.contact.load_path import measured
def trace(frame, event, argument):
    rooms.add(frame.f_code.co_filename)
rooms = set()
sys.setprofile(trace)
measured(problem, range(1))
sys.setprofile(None)
print(*(name for name in rooms if "gfmd_numba" in name), sep="\\n")
"""


@pytest.mark.long
def test_every_module_that_works_at_a_block_counts(tmp_path):
    """Those of `storage` keep compiled kernels, and `scene` and `text` describe."""
    worked = python(IN_A_BLOCK, campaign(tmp_path, SMALLEST)).splitlines()
    rooms = {Path(file).relative_to(PACKAGE).parts[0] for file in worked}
    assert {"contact", "solvers", "elasticity", "roughness", "kernels", "fourier"} <= rooms
    assert rooms & problem._MAKE_NO_NUMBERS <= {"storage", "scene", "text"}
