"""A disk that fills up: one message, and whatever stood there before is unharmed."""

import errno
import os
import resource
import subprocess
import sys
from contextlib import contextmanager

import pytest
from click.testing import CliRunner

from gfmd_numba.campaign import work_precision
from gfmd_numba.campaign.shards import Finished
from gfmd_numba.campaign.work_precision import Point
from gfmd_numba.cli import main
from gfmd_numba.storage.atomic_file import replace
from gfmd_numba.storage.mark import is_product
from support.campaigns import campaign
from support.command_line import unfolded
from support.scenes import SCENE

pytestmark = pytest.mark.usefixtures("laws_that_hold", "undrawn")

SURFACE = """
surface: {method: psd, hurst: 0.8, cut_on: 0.01, roll_off: 0.5, rms_gradient: 0.1, points: 512}
"""
COMMANDS = {
    "solve": "solve scene.yaml -o contact.nc",
    "surface": "surface surface.yaml -o surface.nc",
    "fields": "fields contact.nc -o fields.nc",
    "fit": "fit out --fixed=eps_c=1 --fixed=eps_f=1 -o fit.nc",
    "plot": "plot out --fixed=eps_c=1 --fixed=eps_f=1 -o plot.png",
    "picture of a contact": "plot contact.nc",
    "collect": "collect out",
    "report": "report contact.nc",
    "accuracy": "accuracy means.yaml -o accuracy.nc",
    "plan": "plan campaign.yaml --target=kappa=20% --workers=0",
    "init": "init new.yaml",
}


@contextmanager
def no_room(size=200):
    """Let no file grow beyond a size, as if the disk were full."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def gfmd(command):
    return CliRunner().invoke(main, command.split() if isinstance(command, str) else command)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("folder")
    (folder / "scene.yaml").write_text(SCENE)
    (folder / "surface.yaml").write_text(SURFACE)
    text = campaign(folder).read_text()
    (folder / "means.yaml").write_text(text.replace("small", "means").replace("limits:", "# limits:"))
    path = campaign(folder, **{"grid: {hurst: [0.3, 0.8]}": "fit: {fixed: {eps_c: 1, eps_f: 1}}"})
    for command in (["run", path, "-o", folder / "out", "--workers=0"], ["solve", folder / "scene.yaml"]):
        command += ["-o", folder / "contact.nc"] if command[0] == "solve" else []
        assert gfmd(list(map(str, command))).exit_code == 0
    return folder


def contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file() and path.name != ".lock"}


@pytest.mark.parametrize(
    "command",
    [pytest.param(name, marks=() if name in ("solve", "init") else pytest.mark.long) for name in COMMANDS],
)
def test_a_full_disk_is_one_message_and_harms_no_file(folder, monkeypatch, command):
    monkeypatch.chdir(folder)
    point = Point("surfaces", "one", 4.0, 0.1, 1.0, float("nan"), 0)
    monkeypatch.setattr(work_precision, "studies", lambda planned, realisations: [point])
    if command != "init":  # which writes a new file only
        assert gfmd(COMMANDS[command]).exit_code == 0
    before = contents(folder)
    with no_room():
        said = gfmd(COMMANDS[command])
    assert said.exit_code == 2, said.output
    message = said.stderr.splitlines()[-1]
    assert message.startswith("gfmd: [Errno 27] File too large")
    assert contents(folder) == before
    assert gfmd(COMMANDS[command]).exit_code == 0


def test_results_that_do_not_fit_on_the_disk_are_a_run_to_resume(folder):
    before = contents(folder / "out")
    with no_room(max(shard.stat().st_size for shard in folder.glob("out/shards/*")) + 1000):
        said = gfmd(["run", str(folder / "campaign.yaml"), "-o", str(folder / "out"), "--workers=0"])
    assert said.exit_code == 3
    assert said.stderr.lstrip().startswith("gfmd: [Errno 27] File too large")  # after an empty line of rich below 15
    assert unfolded(said.stderr).endswith("out/small.nc'; finished work is kept, the same command resumes")
    assert contents(folder / "out") == before


def test_a_picture_that_does_not_fit_on_the_disk_leaves_the_results(folder, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device", "small.png")

    monkeypatch.setattr("gfmd_numba.cli.campaigns.write_picture", full)
    said = gfmd(["run", str(folder / "campaign.yaml"), "-o", str(folder / "out"), "--workers=0"])
    assert said.exit_code == 3
    assert "No space left on device: 'small.png'; the results are complete, and `gfmd plot " in unfolded(said.stderr)


@pytest.fixture
def small_disk(tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=320k", "none", disk], capture_output=True).returncode:
        pytest.skip("only root can mount a small disk")
    yield disk
    subprocess.run(["umount", disk], check=True)


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="no disk to mount")
def test_a_run_on_a_disk_that_is_full_resumes_once_there_is_room(small_disk, tmp_path):
    path, out, filler = campaign(tmp_path), small_disk / "out", small_disk / "filler"
    command = ["run", str(path), "-o", str(out), "--workers=0"]
    for left in (0, 20_000, 100_000):  # no room for the claim, for the shards, for the results
        filler.unlink(missing_ok=True)
        room = os.statvfs(small_disk)
        filler.write_bytes(bytes(max(0, room.f_bavail * room.f_frsize - left)))
        stopped = gfmd(command)
        assert stopped.exit_code == 3, stopped.stderr
        lines = stopped.stderr.splitlines()
        said = unfolded(" ".join(line for line in lines if not line.startswith(("blocks", "busy"))))
        assert said.count("gfmd: ") == 1
        assert said.startswith("gfmd: [Errno 28] No space left on device: ")
        assert said.endswith("; finished work is kept, the same command resumes")
        finished = Finished(out)
        assert all(finished.is_sound(name) for name in finished)
        assert not list(small_disk.rglob("*.tmp"))
    filler.unlink()
    assert gfmd(command).exit_code == 0


def test_a_replaced_file_keeps_its_permissions(tmp_path):
    file = tmp_path / "file"
    file.touch(mode=0o600)
    replace(file, [b"new"], is_product)
    assert file.read_bytes() == b"new"
    assert file.stat().st_mode & 0o777 == 0o600


def test_a_pipe_is_no_output(tmp_path):
    os.mkfifo(tmp_path / "pipe.nc")
    (tmp_path / "scene.yaml").write_text(SCENE)
    said = gfmd(["solve", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / "pipe.nc")])
    assert said.exit_code == 2
    assert "pipe.nc, which is not a regular file" in said.stderr
