"""Pages that people read: nothing is too wide, and whatever a page prints to be typed does what the page says."""

import ast
import os
import re
import shutil
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

from gfmd_numba.cli import main
from support.fake_slurm import fake_slurm
from support.pages import FILES, PAGES, ROOT, files_of, options, printed, profile, smaller, words

DOCS = [page for page in PAGES if page.name != "CONTRIBUTING.md"]


@pytest.mark.parametrize("page", DOCS, ids=lambda path: path.name)
def test_no_table_is_wider_than_80_columns(page):
    lines = page.read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if line.lstrip().startswith("|") and len(line) > 80] == []


@pytest.mark.parametrize("page", [ROOT / "CHANGELOG.md", *PAGES], ids=lambda path: path.name)
def test_no_line_of_prose_is_longer_than_120_characters(page):
    text = re.sub(r"^ *```.*?^ *```$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    assert [line for line in text.splitlines() if len(line) > 120 and not line.startswith("    ")] == []


def test_the_readme_is_read_in_a_few_minutes():
    assert (ROOT / "README.md").read_text(encoding="utf-8").count("\n") <= 120


# what a test cannot type, by its beginning, and what answers for it
ELSEWHERE = {
    "python3 -m venv": "the gate makes an environment with it",
    ".venv/bin/pip install": "the gate installs the extras",
    ".venv/bin/python": "the gate runs the tests and builds the site",
    ".venv/bin/ruff": "the gate",
    ".venv/bin/mypy": "the gate",
    ".venv/bin/lint-imports": "the gate",
    "python docs/site/build.py": "the gate",
    "python -m build": "it needs the network",
    "pip install": "it needs the network",
    "docker": "it needs a container engine",
    "mpirun": "tests/cli/test_mpi.py starts processes",
    "sbatch": "it needs a cluster",
}
PLACEHOLDERS = {"DIRECTORY": "campaign", "FILE": "scene.yaml"}


def typed(arguments):
    """What a command says; raises AssertionError unless it ends well."""
    done = CliRunner().invoke(main, [str(argument) for argument in arguments])
    where = f"gfmd {' '.join(map(str, arguments))}"
    assert done.exit_code == 0, f"{where}: exit {done.exit_code}\n{done.output[-800:]}\n{done.exception!r}"
    return done.output


class Reader:
    """Types what a page prints, in order, in a folder of its own; or reads it and runs nothing."""

    def __init__(self, folder, page, runs):
        self.folder, self.runs, self.known, self.python = folder, runs, dict(FILES), {}
        for item in printed(page):  # a page may speak of a file before it prints it
            if item.kind == "yaml" and not item.text.startswith("# excerpt"):
                for name, record in files_of(item, self.known):
                    (folder / name).write_text(yaml.safe_dump(smaller(record)))

    def follow(self, item):
        """Type one block or command; raises whatever goes wrong."""
        if item.kind == "command":
            self._command(item)
        elif item.kind == "yaml":
            for name, record in files_of(item, self.known):
                self._file(name, record, excerpt=item.text.startswith("# excerpt"))
        elif item.kind == "python":
            self._python(item.text)
        else:
            assert item.kind == "text", f"{item}: no test reads {item.kind!r}"

    def _file(self, name, record, excerpt):
        path = self.folder / (f"excerpt-{name}" if excerpt else name)
        path.write_text(yaml.safe_dump(record, sort_keys=False))
        typed(["check", path])  # as printed
        path.write_text(yaml.safe_dump(smaller(record), sort_keys=False))
        if not excerpt:
            self.known[name] = record
        if not self.runs:
            return
        if "surface" in record:
            typed(["surface", path, "-o", path.with_suffix(".nc")])
        elif "name" in record:
            typed(["run", path, "--workers", 0])
        elif "scene" in record:
            out = "contact.nc" if name == "scene.yaml" and not excerpt else path.with_suffix(".nc")
            typed(["solve", path, "-o", out])

    def _command(self, item):
        if item.text.startswith(tuple(ELSEWHERE)):
            return
        line = item.text.removeprefix(".venv/bin/").split(" > ")[0]
        program, *arguments = words(line)
        if program == "python":
            assert compile((self.folder / arguments[0]).read_text(), arguments[0], "exec")
            results = [Path(word) for word in arguments if word.endswith(".nc")]
            assert all((self.folder / "campaigns" / f"{path.parent}.yaml").exists() for path in results)
        elif program == "gfmd":
            self._gfmd(line, [PLACEHOLDERS.get(word, word) for word in arguments], item.inline)

    def _gfmd(self, line, arguments, inline):
        command = main.commands[arguments[0]]
        known = {name for parameter in command.params for name in parameter.opts}
        assert set(options(line)) <= known, f"{line}: no such option"
        if inline and (len(arguments) < 2 or arguments[1].startswith("-")):
            return  # it names a command
        if not self.runs:
            return
        if {"--cluster", "--scheduler"} & set(arguments):
            with command.make_context(arguments[0], arguments[1:]):
                return  # `needs_workers` below, and test_job_queue.py
        if arguments[0] == "run":
            arguments = [*_without(arguments, "--workers"), "--workers", "0"]
            arguments = [re.sub(r"=\d+%$", "=30%", word) for word in arguments]  # the price of the target is no matter
        if arguments[0] == "curve":
            arguments = [re.sub(r"^(.+:.+):\d+$", r"\1:3", word) for word in arguments]
        if "--realisations" in arguments:
            arguments = [*_without(arguments, "--realisations"), "--realisations", "2"]
        typed(arguments)

    def _python(self, text):
        if "workers=" in text or not self.runs:
            ast.parse(text)  # `needs_workers` below
        else:
            exec(compile(text, "block", "exec"), self.python)


def _without(arguments, option):
    if option not in arguments:
        return arguments
    at = arguments.index(option)
    return arguments[:at] + arguments[at + 2 :]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Folder with the files that pages speak of."""
    folder = tmp_path_factory.mktemp("files")
    for name, record in FILES.items():
        (folder / name).write_text(yaml.safe_dump(record))
    heights = profile()
    rows = "".join(f"{i / heights.size},{1e6 * height}\n" for i, height in enumerate(heights))
    for name in ("profile.csv", "steel.csv", "new.csv", "worn.csv", "polished.csv"):
        (folder / name).write_text(f"x [mm],z [um]\n{rows}")
    for name, unit in {"profile.npy": 1e-6, "punch.npy": 1e-3, "surface.npy": 1e-3}.items():
        np.save(folder / name, heights / unit)  # in um, and in L_x
    free = np.arange(heights.size) % 64 > 20
    waves = 1j * np.geomspace(1e-2, 1e4, 31)
    rubber = 3.0 + 5.0 * waves / (1.0 + waves) + 50.0 * waves / (300.0 + waves)
    np.savetxt(folder / "rubber.csv", np.column_stack([waves.imag, rubber.real, rubber.imag]), delimiter=",")
    np.savetxt(folder / "punch.csv", np.where(free, np.nan, -heights))
    np.savetxt(folder / "wave.csv", 1e4 * np.sin(np.linspace(0.0, 2.0 * np.pi, heights.size, endpoint=False)))
    np.save(folder / "shear.npy", np.full(heights.size, 1e-4))
    shutil.copytree(ROOT / "benchmarks", folder / "benchmarks", ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "campaigns").mkdir()
    for path in (ROOT / "campaigns").glob("*.yaml"):
        (folder / "campaigns" / path.name).write_text(yaml.safe_dump(smaller(yaml.safe_load(path.read_text()))))
    return folder


@pytest.fixture(scope="module")
def desk(undrawn, files, tmp_path_factory):
    """The same with the results of two commands of the README."""
    folder = shutil.copytree(files, tmp_path_factory.mktemp("desk"), dirs_exist_ok=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        typed(["solve", "scene.yaml", "-o", "contact.nc"])
        typed(["solve", "map.yaml", "-o", "map.nc"])
        for campaign in ("campaign.yaml", "loads.yaml", "campaigns/quickstart.yaml"):
            typed(["run", campaign, "--workers", 0])
    return folder


def failures(page, reader):
    """Items of a page that a reader cannot follow, and why."""
    failed = []
    for item in printed(page):
        try:
            reader.follow(item)
        except (Exception, SystemExit) as error:
            failed.append(f"{item}\n    {error!r}")
    return "\n".join(failed)


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_every_file_on_a_page_is_good_and_every_option_exists(page, files, tmp_path, monkeypatch):
    shutil.copytree(files, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    assert failures(page, Reader(tmp_path, page, runs=False)) == ""


@pytest.mark.long
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_every_block_and_command_of_a_page_does_what_it_says(page, desk, tmp_path, monkeypatch):
    shutil.copytree(desk, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    assert failures(page, Reader(tmp_path, page, runs=True)) == ""


CLUSTERS = next(page for page in PAGES if page.name == "clusters.md")


def needs_workers(kind, beginning=""):
    """Printed items of the page of clusters that its test above does not run."""
    return [item.text for item in printed(CLUSTERS) if item.kind == kind and beginning in item.text]


@pytest.mark.long
@pytest.mark.filterwarnings("default")
def test_the_block_of_a_cluster_with_slurm_runs(desk, tmp_path, monkeypatch):
    pytest.importorskip("dask_jobqueue", reason="the extra `cluster` is not installed")
    shutil.copytree(desk, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "slurm").mkdir()
    fake_slurm(tmp_path / "slurm", monkeypatch)
    whole = next(yaml.safe_load(text) for text in needs_workers("yaml") if text.startswith("# cluster.yaml"))
    small = whole | {"cores": 1, "memory": "2 GB", "jobs": {"max": 1}}
    (tmp_path / "cluster.yaml").write_text(yaml.safe_dump(small))
    shutil.rmtree(tmp_path / "campaign")
    (block,) = needs_workers("python", 'workers="cluster.yaml"')
    made = {"__name__": "__main__"}
    exec(compile(block, "block", "exec"), made)
    assert (made["dataset"]["status"] == 0).all()


@pytest.mark.long
def test_the_commands_of_a_cluster_of_ones_own_run(desk, tmp_path):
    if shutil.which("openssl") is None:
        pytest.skip("openssl is not installed")
    shutil.copytree(desk, tmp_path, dirs_exist_ok=True)
    shutil.rmtree(tmp_path / "campaign")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    commands = [item.text for item in printed(CLUSTERS) if item.kind == "command" and not item.inline]
    first = next(rank for rank, command in enumerate(commands) if command.startswith("openssl"))
    last = next(rank for rank, command in enumerate(commands) if "--scheduler" in command)
    (block,) = needs_workers("python", "Client(")
    script = "\n".join(commands[first : last + 1]) + f"\nrm -r campaign\npython <<'END'\n{block}END\n"
    script = script.replace("SCHEDULER", "127.0.0.1").replace("8786", port).replace("--nworkers 8", "--nworkers 1")
    script = re.sub(r"^(dask .*)$", r"\1 &", script, flags=re.MULTILINE)  # on machines of their own
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-euc", f"trap 'kill $(jobs -p)' EXIT\n{script}"],
        cwd=tmp_path,
        env=os.environ | {"PATH": path},
        capture_output=True,
        text=True,
        timeout=500,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    assert (tmp_path / "campaign/campaign.nc").exists()


SMALLER = {
    "python benchmarks/friction_and_law.py 2048 30": ("128", "1"),
    "python benchmarks/law_hunt.py hardness 0 300": ("hardness", "0", "3"),
    "python benchmarks/hardness.py area": ("area",),
    "python benchmarks/free_peers.py": ("compare", "64"),
}


@pytest.mark.long
@pytest.mark.parametrize("command", SMALLER)
def test_a_benchmark_that_a_page_names_runs_on_smaller_grids(command, tmp_path):
    """Those that end within a minute; the others are compiled by the test of their page."""
    assert command in [item.text for page in PAGES for item in printed(page)]
    line = [sys.executable, ROOT / command.split()[1], *SMALLER[command]]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True, timeout=500)
    assert done.returncode == 0, done.stderr[-3000:]
    assert done.stdout


TERMS = re.compile(r"ε_[cft]\b|\beps_[cft]\b|\bcondensed\b|\brigid mean\b|κ_r\b|`kappa_r`|`cut_on`")


@pytest.mark.parametrize("page", DOCS, ids=lambda path: path.name)
def test_a_page_says_where_its_terms_are_explained_before_it_uses_one(page):
    text = page.read_text(encoding="utf-8")
    link = re.search(r"\(#?(?:docs/)?terms\.md", text)
    used = TERMS.search(text)
    if used and page.name not in ("terms.md", "errata.md", "combinations.md"):  # eps is a strain there
        assert link
        assert link.start() < used.start() or page.name == "limit.md"  # where they are defined


def test_pages_print_blocks_and_commands():
    """So that no change of their look hides them from the test above."""
    kinds = [item.kind for page in PAGES for item in printed(page)]
    assert kinds.count("yaml") >= 26
    assert kinds.count("python") >= 7
    commands = [item.text for page in PAGES for item in printed(page) if item.kind == "command"]
    assert sum(" " in command.removeprefix("gfmd ") for command in commands) >= 90
