"""Text of strangers: nothing in a file, its name or a command can act on the terminal or fill it."""

import re

import numpy as np
import pytest
import xarray as xr

from gfmd_numba.cli import terminal
from gfmd_numba.cli.terminal import print_table
from gfmd_numba.scene import InputError, load_scene, read_document
from gfmd_numba.scene.surface_file import load_surface
from gfmd_numba.text.printable import printable
from support.command_line import gfmd
from support.scenes import SCENE

EVIL = "\x1b]0;owned\x07\x1b[2J\x9b31m\u202e\u2066\u2028\r\nb"
HARMLESS = re.compile(r"[^\x00-\x09\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]*")


@pytest.fixture(autouse=True)
def _patient(monkeypatch):
    """A busy machine adds no line that says so."""
    monkeypatch.setattr(terminal, "_PATIENCE", 3600.0)


def assert_harmless(text, lines=1):
    assert HARMLESS.fullmatch(text), text
    assert text.rstrip("\n").count("\n") == lines - 1
    assert len(text) < 8500


def test_what_is_not_printable_is_escaped():
    assert printable("a\x1b\n\u202e\udcffé ß名\xa0") == r"a\x1b\n\u202e\udcffé ß名\xa0"


TEXTS = {
    "tag": "a: !<!%1b%5b2J%0a%e2%80%ae> 1",
    "value": '"scene": "\\e[2J\\nb\\u202e"',
    "key": '"scene": 1\n"\\e[2J\\nb\\u202e": 1',
    "method": 'surface: {method: "\\e[2J\\nb", file: x.csv}',
    "file": 'surface: {method: measured, file: "\\e[2J\\nb\\u202e\\0.csv"}',
}


@pytest.mark.parametrize("name", TEXTS)
@pytest.mark.parametrize("load", [read_document, load_scene, load_surface])
def test_what_a_file_says_is_escaped(tmp_path, name, load):
    path = tmp_path / "bad.yaml"
    path.write_text(TEXTS[name], encoding="utf-8")
    try:
        load(path)
    except InputError as error:
        assert_harmless(str(error), len(error.args))


@pytest.mark.parametrize(
    "command",
    ["check", "run", "plan", "solve", "curve --loads=0.1", "surface", "fit", "plot", "fields", "statistics", "status"],
)
@pytest.mark.parametrize("there", [True, pytest.param(False, marks=pytest.mark.long)])
def test_a_name_is_escaped_in_what_a_command_says(tmp_path, command, there):
    path = tmp_path / f"{EVIL}.yaml"
    if there:
        path.write_text("scene: 1", encoding="utf-8")
    command, *options = command.split()
    output = ["-o", tmp_path / "out.nc"] if command in ("solve", "curve", "surface", "fields", "statistics") else []
    done = gfmd(command, path, *options, *output)
    assert done.exit_code == 2
    assert_harmless(done.output, done.output.rstrip("\n").count("\n") + 1)
    assert "b.yaml" not in done.output.splitlines()


def test_names_are_escaped_in_what_a_good_command_says(tmp_path):
    scene = tmp_path / f"{EVIL}.yaml"
    scene.write_text(SCENE, encoding="utf-8")
    done = gfmd("check", scene)
    assert done.exit_code == 0
    assert_harmless(done.output)
    done = gfmd("solve", scene, "-o", tmp_path / f"{EVIL}.nc")
    assert done.exit_code == 0
    assert_harmless(done.output, done.output.rstrip("\n").count("\n") + 1)
    assert done.stdout.startswith("results  ")
    assert r"\u2028\r\nb.nc" in done.stdout.splitlines()[0]
    done = gfmd("init", tmp_path / f"{EVIL}.new")
    assert done.exit_code == 0
    assert_harmless(done.output, done.output.rstrip("\n").count("\n") + 1)


def test_what_a_file_of_results_says_is_escaped(tmp_path):
    scene = tmp_path / "scene.yaml"
    height = xr.DataArray(np.sin(np.arange(64.0)), dims="x", attrs={"units": EVIL}, name="\u202eheight\u2066")
    xr.Dataset({height.name: height, "\u2028": height}).to_netcdf(tmp_path / "p.nc")
    scene.write_text(f"surface: {{method: measured, file: {tmp_path / 'p.nc'}}}")
    done = gfmd("surface", scene, "-o", tmp_path / "out.nc")
    assert done.exit_code == 2
    assert_harmless(done.output)


def test_a_message_is_bounded_whatever_is_wrong(tmp_path):
    path = tmp_path / "bad.yaml"
    path.write_text("".join(f"{'k' * 50}{i}: 1\n" for i in range(1200)), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_scene(path)
    said = str(caught.value)
    assert len(said) < 8500
    assert said.count("\n") <= 100
    assert re.search(r"\nand \d{4} more$", said)


def test_a_long_line_loses_its_middle():
    said = str(InputError("you gave " + "x" * 10_000 + "; gfmd allows less"))
    assert len(said) < 2000
    assert said.startswith("you gave xxx")
    assert said.endswith("xx; gfmd allows less")


@pytest.mark.parametrize("arguments", [(EVIL,), ("check", f"--{EVIL}"), ("run", "x", "--workers", EVIL)])
def test_a_wrong_argument_is_escaped(arguments):
    done = gfmd(*arguments)
    assert done.exit_code == 2
    assert_harmless(done.output, done.output.rstrip("\n").count("\n") + 1)


def test_cells_and_headings_of_a_table_are_escaped(capsys):
    print_table("title \x1b[2J", {"name": ["\x1b[31m", "b"]}, {"unit \u202e": ["1", "\x07"]})
    said = capsys.readouterr().out
    assert "\\x1b[31m" in said
    assert all(line.isprintable() for line in said.splitlines())
