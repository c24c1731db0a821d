"""What commands print: lines of at most 80 columns, numbers with units, and a word where they take their time."""

import re
import time

import numpy as np
import pytest
from click import unstyle

from gfmd_numba.cli import main, terminal
from gfmd_numba.cli.terminal import print_table, say, say_command
from gfmd_numba.text.printable import word
from support.campaigns import campaign
from support.command_line import gfmd
from support.scenes import SCENE

pytestmark = pytest.mark.usefixtures("undrawn")

STEPS = "path: [{reduced_pressure: 0.12345678}, {reduced_pressure: 0.05, sliding: 1.2345678e-7}]\n"
SURFACE = """
surface: {method: psd, model: exponential, hurst: 0.8, correlation_length: 0.05, rms_height: 0.01, points: 256}
"""
COMMANDS = """
accuracy campaign.yaml --realisations=2
check campaign.yaml
collect small
conductance contact.nc
conductance steps.nc -o conductance.nc
curve broken-one.yaml --loads 0.1,0.2 -o curve.nc
curve one.yaml --loads 1e-3:1:2 -o curve.nc
curve one.yaml --loads 1e-3:1:2 --realisations 2 -o curve.nc
doctor
fields contact.nc -o fields.nc
fit small
fit small --fixed eps_c=0.5:2 --exponents free --variable kappa_counted -o fit.nc
init new.yaml
leakage map.nc -o leakage.nc
leakage steps.nc
plan campaign.yaml --pilot=0.01
plan campaign.yaml --target=3% --workers=0
plot small
relaxation dma.csv --unit=Pa
report small
report contact.nc
run broken.yaml --workers=0
run campaign.yaml --workers=0
run means.yaml --workers=0
solve broken-scene.yaml -o contact.nc
solve path.yaml -o path.nc
solve scene.yaml -o contact.nc
statistics contact.nc -o statistics.nc
statistics map.nc -o statistics.nc --percolation
statistics steps.nc -o statistics.nc --percolation
status broken
status small
surface surface.yaml -o surface.nc
verify small
"""
LINES, LONG = COMMANDS.strip().splitlines(), pytest.mark.long
RARE = ("accuracy", "doctor", "plan campaign.yaml", "statistics map", "statistics steps", "curve one", "curve broken")
RARE += ("leakage", "run campaign", "run means", "run broken", "conductance steps", "fit small --fixed", "plot small")
RARE += ("report small", "collect small")


@pytest.fixture(scope="module")
def folder(undrawn, tmp_path_factory):
    """Files of every kind under short names, for long ones are never folded."""
    folder = tmp_path_factory.mktemp("terminal")
    broken = {"grid:": "numerics: {max_iterations: 1}\ngrid:", "small": "broken", "limits:": "#"}
    campaign(folder, **broken).rename(folder / "broken.yaml")
    slabs = "grid: {poissons_ratio: [0.2, 0.3], aspect_ratio: [.inf, 1.5], "
    campaign(folder, **{"limits:": "#", "grid: {": slabs, "small": "means"}).rename(folder / "means.yaml")
    campaign(folder, **{"grid:": "fit: {fixed: {eps_c: 1, eps_f: 0.75}}\ngrid:"})
    (folder / "scene.yaml").write_text(SCENE)
    friction = SCENE.replace("{hard_wall: {}}", "{hard_wall: {}, friction: {coefficient: 0.3}}")
    (folder / "broken-scene.yaml").write_text(friction + STEPS + "numerics: {max_iterations: 1}\n")
    (folder / "path.yaml").write_text(friction + STEPS)
    (folder / "one.yaml").write_text(SCENE)
    (folder / "broken-one.yaml").write_text(SCENE + "numerics: {max_iterations: 1}\n")
    (folder / "surface.yaml").write_text(SURFACE)
    (folder / "dma.csv").write_text("f [Hz],E' [Pa],E'' [Pa]\n1,3e6,1e5\n10,4e6,8e5\n100,6e6,4e5\n")
    a_map = SCENE.replace("scene:", "scene:\n  dimension: 2").replace(
        "eps_c: 1/4, eps_f: 1/16", "eps_c: 1/2, eps_f: 1/8"
    )
    (folder / "map.yaml").write_text(a_map)
    (folder / "steps.yaml").write_text(a_map + "path: [{reduced_pressure: 0.12345678}, {reduced_pressure: 0.7}]\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for command in (
            "run campaign.yaml --workers=0",
            "run broken.yaml --workers=0",
            "solve scene.yaml -o contact.nc",
            "solve map.yaml -o map.nc",
            "solve steps.yaml -o steps.nc",
        ):
            assert gfmd(*command.split()).exit_code in (0, 3)
    return folder


@pytest.mark.parametrize(
    "command",
    [
        *(pytest.param(line, marks=LONG if line.startswith(RARE) else ()) for line in LINES),
        "-h",
        *(f"{name} -h" for name in main.commands),
    ],
)
def test_everything_fits_80_columns(folder, monkeypatch, command):
    monkeypatch.chdir(folder)
    monkeypatch.setattr(terminal, "_PATIENCE", 0.0)
    monkeypatch.setattr("gfmd_numba.cli.report._drawn", lambda dataset, fitted: [])
    said = gfmd(*command.split())
    assert said.exit_code in (0, 3), said.output
    assert said.output
    assert [line for line in unstyle(said.output).splitlines() if len(line) > 80] == []


def test_every_command_is_looked_at():
    printing_json = {"schema"}  # for editors
    assert {command.split()[0] for command in LINES} | printing_json == set(main.commands)


def test_a_parameter_of_all_rows_stands_above_the_table_once(capsys):
    print_table("title", {"H": ["0.3", "0.8"], "nu": ["0.33"] * 2, "p*": ["-"] * 2}, {"kappa": ["2.0±0.1", "1.9±0.1"]})
    assert capsys.readouterr().out == "title\nnu = 0.33\n\n  H    kappa\n0.3  2.0±0.1\n0.8  1.9±0.1\n\n"


@pytest.mark.parametrize("n_parameters", [1, 4, 12])
def test_columns_that_do_not_fit_go_below(capsys, n_parameters):
    parameters = {f"key {i}": ["1.23457e-05", str(i)] for i in range(n_parameters)}
    values = {f"value {i}": [f"{i}.5±0.123", "-"] for i in range(12)}
    print_table("title", parameters, values)
    said = capsys.readouterr().out
    assert max(map(len, said.splitlines())) <= 80
    assert set(re.findall(r"\d+\.5±0\.123", said)) == {f"{i}.5±0.123" for i in range(12)}
    for table in said.strip().split("\n\n")[1:]:
        heading = table.splitlines()[0].split()[0]
        assert heading == ("key" if n_parameters < 12 else "case")


def test_a_word_longer_than_a_line_stays_whole(capsys):
    path = "/".join(["folder"] * 20)
    say("note", f"{path} is where the results of this campaign have been written to, as you asked")
    first, second, third = capsys.readouterr().out.splitlines()
    assert (first, second.startswith("         is where"), third[:9]) == (f"note     {path}", True, " " * 9)


def test_a_folded_command_is_one_to_the_shell(capsys):
    command = "gfmd run small/campaign.yaml --output small --only case_id=0123456789abcdef --retry-failed --workers 0"
    say_command(command, width=10)
    said = capsys.readouterr().out
    assert max(map(len, said.splitlines())) <= 80
    assert said.replace("\\\n", "").split() == command.split()


@pytest.mark.parametrize("name", ["two words " * 12, "it's; touch X", "a\nb 'c' \\d", '"'])
def test_a_quoted_path_is_not_folded(capsys, name):
    command = f"gfmd run {word(name)} --output {word(name)} --only case_id=0123456789abcdef --retry-failed --workers 0"
    say_command(command, width=10)
    assert " ".join(capsys.readouterr().out.replace("\\\n", "").split(" ")).split() == command.split()
    say("note", f"the results are complete, and `gfmd plot {word(name)}` draws them, wherever you want to have them")
    assert f"`gfmd plot {word(name)}`" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("length", "modulus", "units"),
    [("", "", ("L_x", "E*")), ("  length: 1e-4\n", "youngs_modulus: 70e9, ", ("nm", "MPa"))],
)
def test_numbers_of_a_contact_have_units(tmp_path, length, modulus, units):
    scene = tmp_path / "scene.yaml"
    free = SCENE.replace("  length: 1e-4\n", length).replace("youngs_modulus: 70e9, ", modulus)
    scene.write_text(free)
    said = gfmd("solve", scene, "-o", tmp_path / "out.nc").output
    assert re.search(rf"mean pressure +\S+ +[kMG]?{re.escape(units[1])}\n", said)
    scene.write_text(free.replace("reduced_pressure: 0.05", "displacement: 1e-7") + "path: [{displacement: 2e-7}]\n")
    heading, *_ = re.findall(
        r"steps of the path\n\n(.*?)\n +0 ", gfmd("solve", scene, "-o", tmp_path / "out.nc").output, re.S
    )
    assert re.findall(r"\((.*?)\)", heading)[:2] == list(units)


def test_a_wait_is_told_and_a_short_one_is_not(capsys, monkeypatch):
    with terminal.waiting("looking"):
        pass
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(terminal, "_PATIENCE", 0.0)
    said, until = "", time.monotonic() + 10.0
    with terminal.waiting("looking"):
        while not said and time.monotonic() < until:
            said = capsys.readouterr().err
    assert said == "busy     looking\n"


def test_large_errors_stay_short(capsys):
    from gfmd_numba.cli.tables import _with_errors

    assert _with_errors([np.float64(2.5)], [1e300]) == ["0±1.0e+300"]
