"""Files that are none: pipes, devices, folders and endless ones are refused at once, wherever a user may name one."""

import os
import socket

import netCDF4
import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.scene import InputError, load_scene, read_document, regular_file
from support.command_line import gfmd
from support.scenes import SCENE

KINDS = ["pipe", "device", "socket", "link to a device"]


def odd(folder, kind, name):
    """A path of that name that is no regular file."""
    path = folder / name
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "socket":
        here = os.getcwd()
        os.chdir(folder)  # the name of a socket has to be short
        with socket.socket(socket.AF_UNIX) as listening:
            listening.bind(name)
        os.chdir(here)
    elif kind == "link to a device":
        path.symlink_to("/dev/zero")
    else:
        return "/dev/zero"
    return path


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "command", ["check", "run", "plan", "accuracy", "solve", "surface", "fields", "statistics", "fit", "plot"]
)
def test_a_command_refuses_what_is_no_regular_file(tmp_path, command, kind):
    output = ["-o", tmp_path / ("p.png" if command == "plot" else "p.nc")] if command not in ("check", "plan") else []
    done = gfmd(command, odd(tmp_path, kind, "odd.yaml"), *output)
    assert done.exit_code == 2
    assert "you gave a device, pipe or socket, not a regular file; gfmd allows " in done.output


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "device"])
@pytest.mark.parametrize("suffix", ["npy", "csv", "nc", "opd"])
def test_a_surface_refuses_what_is_no_regular_file(tmp_path, kind, suffix):
    file = odd(tmp_path, kind, f"odd.{suffix}")
    with pytest.raises(InputError, match=r"you gave .*; gfmd allows an existing file"):
        gfmd_numba.make_surface({"surface": {"method": "measured", "file": str(file)}})


def test_a_folder_is_no_input(tmp_path):
    for command in ("check", "run", "plan", "solve", "surface"):
        done = gfmd(command, tmp_path, *(["-o", tmp_path / "o.nc"] if command in ("solve", "surface") else []))
        assert done.exit_code == 2
        assert "is a directory" in done.output
    with pytest.raises(InputError, match=r"a path that cannot be read \(Is a directory\)"):
        load_scene(tmp_path)


def test_a_file_larger_than_any_input_is_not_read(tmp_path):
    for name in ("scene.yaml", "p.npy", "p.csv", "p.nc"):
        with open(tmp_path / name, "wb") as file:
            file.truncate(2**42)
    assert "you gave a file of 4.398e+06 MB, more than" in gfmd("check", tmp_path / "scene.yaml").output
    assert "you gave a file of 4.398e+06 MB, more than" in gfmd("fit", tmp_path / "p.nc").output
    for name in ("p.npy", "p.csv", "p.nc"):
        with pytest.raises(InputError, match=r"a file of 4\.398e\+06 MB, more than"):
            gfmd_numba.make_surface({"surface": {"method": "measured", "file": str(tmp_path / name)}})


def test_a_file_that_grows_is_not_read_without_end(tmp_path, monkeypatch):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    monkeypatch.setattr(regular_file, "check_regular", lambda path, most: None)
    with pytest.raises(ValueError, match="a file of more than"):
        regular_file.read_regular(path, 10)


def test_a_netcdf_file_that_is_larger_than_it_looks_is_not_loaded(tmp_path):
    with netCDF4.Dataset(tmp_path / "p.nc", "w") as file:
        file.createDimension("x", 2**40)
        file.createVariable("height", "f8", "x", chunksizes=[2**20])
    assert (tmp_path / "p.nc").stat().st_size < 100_000
    with pytest.raises(InputError, match="MB of numbers, more than"):
        gfmd_numba.make_surface({"surface": {"method": "measured", "file": str(tmp_path / "p.nc")}})


@pytest.mark.parametrize("name", ["a\0b", "x" * 10_000, "\ud800", ""])
def test_a_name_that_no_file_can_have_is_told(name):
    with pytest.raises(InputError):
        read_document(name)
    for suffix in (".npy", ".csv", ".nc"):
        with pytest.raises(InputError):
            gfmd_numba.make_surface({"surface": {"method": "measured", "file": name + suffix}})
        scene = {"body": {"poissons_ratio": 0.3}, "roughness": {"method": "measured", "file": name + suffix}}
        with pytest.raises(InputError):
            load_scene({**scene, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.1}})


HEADERS = {
    "no end": b"{'descr': '<f8', 'fortran_order': False, 'shape': (8,",
    "huge": b"{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999999,), }",
    "large": b"{'descr': '<f8', 'fortran_order': False, 'shape': (999999999999,), }",
    "negative": b"{'descr': '<f8', 'fortran_order': False, 'shape': (-8,), }",
    "deep": b"(" * 5000,
    "a type of itself": b"{'descr': [('a', '<f8', 8)], 'fortran_order': False, 'shape': (1,), }",
    "objects": b"{'descr': '|O', 'fortran_order': False, 'shape': (8,), }",
    "a mapping as a type": b"{'descr': {1: 2}, 'fortran_order': False, 'shape': (8,), }",
}


@pytest.mark.parametrize("name", HEADERS)
def test_a_damaged_header_of_an_array_is_told(tmp_path, name):
    header = HEADERS[name] + b"\n"
    content = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + np.arange(8.0).tobytes()
    (tmp_path / "p.npy").write_bytes(content)
    with pytest.raises(InputError, match=r"you gave p.npy \((no .npy array of numbers|an array of shape)"):
        gfmd_numba.make_surface({"surface": {"method": "measured", "file": str(tmp_path / "p.npy")}})


def test_a_link_is_of_the_kind_its_name_says(tmp_path):
    """The file it leads to was asked for its kind: KeyError ''."""
    (tmp_path / "heights").write_text("\n".join(map(str, 1e-3 * np.sin(np.arange(32.0)))))
    (tmp_path / "shadow").write_text("root:*:19000:0:99999:7:::\nbin:*:1\n")
    (tmp_path / "p.csv").symlink_to(tmp_path / "heights")
    (tmp_path / "q.csv").symlink_to(tmp_path / "shadow")
    scene = {"body": {"poissons_ratio": 0.3}, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.1}}
    rough = {"method": "measured", "file": str(tmp_path / "p.csv")}
    assert int(gfmd_numba.solve({**scene, "roughness": rough})["status"]) == 0
    with pytest.raises(InputError, match=r"you gave q.csv \(no row of numbers, but 'root"):
        gfmd_numba.solve({**scene, "roughness": rough | {"file": str(tmp_path / "q.csv")}})
    loaded = {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1},
        "boundary": {"normal_traction": str(tmp_path / "q.csv")},
    }
    with pytest.raises(InputError, match=r"you gave q.csv \(no row of numbers, but 'root"):
        gfmd_numba.solve({"scene": loaded})
