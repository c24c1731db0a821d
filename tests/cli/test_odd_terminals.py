"""Standard streams that are closed or full, and few files that may be open: what is done, and how it is said."""

import os
import resource
import subprocess
import sys

import pytest
import xarray as xr

from support.campaigns import TINY
from support.scenes import SCENE


def gfmd(folder, shell, prepare=None):
    """What a shell with such redirections has of the command in it."""
    (folder / "scene.yaml").write_text(SCENE)
    (folder / "tiny.yaml").write_text(TINY)
    (folder / "bad.yaml").write_text("scene: 1")
    command = shell.replace("gfmd", f"'{sys.executable}' -m gfmd_numba")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.run(
        ["/bin/sh", "-c", command], cwd=folder, env=environment, capture_output=True, text=True, preexec_fn=prepare
    )


@pytest.mark.long
@pytest.mark.parametrize(
    ("command", "closed"),
    [
        ("run tiny.yaml -o out --workers 0", "<&- >&- 2>&-"),
        ("solve scene.yaml -o out.nc", "2>&-"),
    ],
)
def test_closed_streams_change_nothing(tmp_path, command, closed):
    done = gfmd(tmp_path, f"gfmd {command} {closed}")
    assert done.returncode == 0
    with xr.open_dataset(tmp_path / ("out/tiny.nc" if "run" in command else "out.nc")) as dataset:
        assert not dataset["status"].any()


@pytest.mark.long
def test_workers_start_without_standard_streams(tmp_path):
    assert gfmd(tmp_path, "gfmd run tiny.yaml -o out --workers 1 <&- >&- 2>&-").returncode == 0
    assert (tmp_path / "out" / "tiny.nc").is_file()


@pytest.mark.long
@pytest.mark.parametrize("stream", ["2>&-", "2>/dev/full"])
def test_bad_input_exits_with_2_though_nobody_can_be_told(tmp_path, stream):
    done = gfmd(tmp_path, f"gfmd check bad.yaml {stream}")
    assert done.returncode == 2
    assert done.stderr == ""


@pytest.mark.long
@pytest.mark.parametrize("command", ["run tiny.yaml -o out --workers 0", "check scene.yaml"])
def test_a_full_standard_output_is_no_bad_input(tmp_path, command):
    done = gfmd(tmp_path, f"gfmd {command} >/dev/full")
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last == (
        "gfmd: standard output cannot be written (No space left on device); files that were written are kept"
    )
    assert "Traceback" not in done.stderr
    if "run" in command:
        with xr.open_dataset(tmp_path / "out/tiny.nc") as dataset:
            assert not dataset["status"].any()


def test_too_few_open_files_are_told_at_once(tmp_path):
    done = gfmd(tmp_path, "ulimit -n 32; gfmd run tiny.yaml -o out")
    assert done.returncode == 2
    assert done.stderr == "gfmd: ulimit -n: you gave 32 open files; gfmd allows at least 256\n"
    assert not (tmp_path / "out").exists()


@pytest.mark.long
def test_few_open_files_become_more_if_they_may(tmp_path):
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    done = gfmd(
        tmp_path,
        "gfmd run tiny.yaml -o out --workers 2",
        lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (32, hard)),
    )
    assert done.returncode == 0, done.stderr
