"""`gfmd solve --mpi`: processes that mpirun starts, and what is said without MPI."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr

from gfmd_numba.cli.mpi import of_the_first
from gfmd_numba.text.input_error import InputError
from support.command_line import gfmd, refused
from support.team_of_threads import together

MAP = """scene:
  dimension: 2
  body: {poissons_ratio: 0.33, aspect_ratio: 0.2}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
discretisation: {eps_c: 1/4, eps_f: 1/8, eps_t: 1/2}
"""


def test_without_mpi4py_it_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mpi4py", None)
    (tmp_path / "map.yaml").write_text(MAP)
    said = refused("solve", tmp_path / "map.yaml", "--mpi", "-o", tmp_path / "out.nc")
    assert "pip install 'gfmd-numba[mpi]'" in said


def test_what_the_first_process_finds_or_refuses_holds_for_all():
    asked = []

    def find(member):
        return of_the_first(member, lambda: asked.append(member.rank) or 7)

    def fail(member):
        with pytest.raises(InputError, match="no such file"):
            of_the_first(member, lambda: (_ for _ in ()).throw(InputError("no such file")))

    assert together(3, find) == [7, 7, 7]
    assert asked == [0]
    together(3, fail)


@pytest.fixture
def mpirun():
    """The command that starts processes, with what one machine of few cores and a container need."""
    pytest.importorskip("mpi4py")
    command = shutil.which("mpirun", path=str(Path(sys.executable).parent)) or shutil.which("mpirun")
    if command is None:
        pytest.skip("no mpirun")
    of_openmpi = "Open MPI" in subprocess.run([command, "--version"], capture_output=True, text=True).stdout

    def run(processes, *arguments):
        options = ["--allow-run-as-root", "--oversubscribe"] if of_openmpi else []
        script = "from gfmd_numba.cli import main; main()"
        asked = [command, *options, "-n", str(processes), sys.executable, "-c", script, *map(str, arguments)]
        return subprocess.run(asked, capture_output=True, text=True, timeout=300)

    return run


@pytest.mark.long
def test_two_processes_write_the_nodes_of_one(tmp_path, mpirun):
    (tmp_path / "map.yaml").write_text(MAP)
    done = mpirun(2, "solve", tmp_path / "map.yaml", "--mpi", "-o", tmp_path / "two.nc")
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("residual ") == 1
    assert gfmd("solve", tmp_path / "map.yaml", "-o", tmp_path / "one.nc").exit_code == 0
    with xr.open_dataset(tmp_path / "one.nc") as one, xr.open_dataset(tmp_path / "two.nc") as two:
        assert bool(((one["pressure"] > 0.0) == (two["pressure"] > 0.0)).all())
        assert int(two["status"]) == 0


@pytest.mark.long
def test_a_file_that_is_refused_ends_all_processes_with_one_message(tmp_path, mpirun):
    (tmp_path / "map.yaml").write_text(MAP.replace("dimension: 2", "dimension: 1"))
    done = mpirun(2, "solve", tmp_path / "map.yaml", "--mpi", "-o", tmp_path / "out.nc")
    assert done.returncode == 2
    assert done.stderr.count("gfmd: ") == 1
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out.nc").exists()
