"""A file that gfmd did not write is never replaced, whether its name was given or is the usual one."""

import matplotlib as mpl
import pytest
import xarray as xr
from click.testing import CliRunner
from matplotlib.figure import Figure

from gfmd_numba.cli import main
from gfmd_numba.storage.atomic_file import write_dataset, write_picture, write_table
from gfmd_numba.storage.mark import may_be_replaced
from support.command_line import unfolded
from support.scenes import SCENE


def gfmd(*arguments):
    said = CliRunner().invoke(main, list(map(str, arguments)))
    return said.exit_code, unfolded(said.output)


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "scene.yaml").write_text(SCENE)
    return tmp_path / "scene.yaml"


def test_an_output_of_ours_is_written_again(tmp_path, scene):
    for _ in range(2):
        code, _ = gfmd("solve", scene, "-o", tmp_path / "out.nc")
        assert code == 0


def test_an_empty_file_holds_nothing_to_lose(tmp_path, scene):
    (tmp_path / "out.nc").touch()
    assert gfmd("solve", scene, "-o", tmp_path / "out.nc")[0] == 0


@pytest.mark.parametrize("content", [b"notes on gfmd-numba\n", b"\x89HDF\r\n\x1a\n of another program"])
def test_a_file_of_the_user_is_no_output(tmp_path, scene, content):
    mine = tmp_path / "out.nc"
    mine.write_bytes(content)
    code, said = gfmd("solve", scene, "-o", mine)
    assert code == 2
    assert f"--output: given {mine}, which gfmd did not write; allowed: a new file" in said
    assert mine.read_bytes() == content


def test_results_of_another_program_at_the_usual_name_of_an_accuracy_stay(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert gfmd("init", tmp_path / "study.yaml")[0] == 0
    name = next(line.split()[1] for line in (tmp_path / "study.yaml").read_text().splitlines() if line[:5] == "name:")
    mine = tmp_path / f"{name}-accuracy.nc"
    xr.Dataset({"x": ("i", [1.0])}).to_netcdf(mine)
    before = mine.read_bytes()
    code, said = gfmd("accuracy", tmp_path / "study.yaml")
    assert code == 2
    assert "which gfmd did not write" in said
    assert mine.read_bytes() == before


@pytest.mark.parametrize("kind", ["png", "pdf", "svg", "ps", "eps"])
def test_pictures_of_ours_are_known_from_those_of_others(tmp_path, kind):
    figure = Figure()
    with mpl.rc_context({"svg.fonttype": "none"}):
        write_picture(tmp_path / f"ours.{kind}", figure, dpi=50)
        figure.savefig(tmp_path / f"other.{kind}")
    assert may_be_replaced(tmp_path / f"ours.{kind}")
    assert not may_be_replaced(tmp_path / f"other.{kind}")


def test_datasets_of_ours_are_known_from_those_of_others(tmp_path):
    dataset = xr.Dataset({"x": ("i", [1.0])}, attrs={"title": f"{'long ' * 200}"})
    write_dataset(tmp_path / "ours.nc", dataset)
    dataset.to_netcdf(tmp_path / "other.nc")
    assert may_be_replaced(tmp_path / "ours.nc")
    assert not may_be_replaced(tmp_path / "other.nc")


EDITS = {
    "a number": lambda text: text.replace(b"2.5", b"2.6"),
    "a row": lambda text: text + b"3,4\n",
    "line ends": lambda text: text.replace(b"\n", b"\r\n"),
    "the mark": lambda text: text.replace(b"sha256 ", b"sha256 0"),
    "a mark without a digest": lambda text: b"# written by gfmd-numba\n" + text.partition(b"\n")[2],
    "a cut": lambda text: text[:40],
}


@pytest.mark.parametrize("edit", EDITS)
def test_a_table_of_ours_that_was_edited_is_its_editors(tmp_path, edit):
    table = tmp_path / "c.csv"
    write_table(table, {"a (1)": [1.0, 2.5], "b (m)": [3, 4]})
    assert may_be_replaced(table)
    text = table.read_bytes()
    table.write_bytes(EDITS[edit](text))
    assert table.read_bytes() != text
    assert not may_be_replaced(table)


def test_an_edited_table_of_a_curve_stays(tmp_path, scene):
    asked = ("curve", scene, "--loads", "0.05,0.1", "-o", tmp_path / "c.nc")
    for _ in range(2):
        assert gfmd(*asked)[0] == 0
    table = tmp_path / "c.csv"
    edited = table.read_text() + "# my notes\n"
    table.write_text(edited)
    before = (tmp_path / "c.nc").read_bytes()
    code, said = gfmd(*asked)
    assert code == 2
    assert f"{table}: given a file that gfmd did not write, where its table would go; allowed: no such file, or" in said
    assert table.read_text() == edited
    assert (tmp_path / "c.nc").read_bytes() == before
