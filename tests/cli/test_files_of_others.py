"""A file that gfmd did not write is never replaced, whether its name was given or is the usual one."""

import matplotlib as mpl
import netCDF4
import pytest
import xarray as xr
from click.testing import CliRunner
from matplotlib.figure import Figure

from gfmd_numba.cli import main
from gfmd_numba.storage.atomic_file import foreign, write_dataset, write_picture, write_table
from support.cases import some_of
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
    changed = "which gfmd did not write, or somebody has changed since"
    assert f"--output: you gave {mine}, {changed}; gfmd allows a new file" in said
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


@pytest.mark.parametrize("kind", some_of(["png", "pdf", "svg", "ps", "eps"], 0, 2, 3))
def test_pictures_of_ours_are_known_from_those_of_others(tmp_path, kind):
    figure = Figure()
    with mpl.rc_context({"svg.fonttype": "none"}):
        write_picture(tmp_path / f"ours.{kind}", figure)
        figure.savefig(tmp_path / f"other.{kind}")
    assert not foreign(tmp_path / f"ours.{kind}")
    assert foreign(tmp_path / f"other.{kind}")


@pytest.mark.parametrize("kind", ["png", "pdf", "svg", "ps", "eps"])
def test_a_picture_of_ours_that_somebody_drew_into_is_his(tmp_path, kind):
    picture = tmp_path / f"ours.{kind}"
    write_picture(picture, Figure())
    content = picture.read_bytes()
    middle = len(content) // 2
    for edited in (
        content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :],
        content[:middle] + b"<g/>" + content[middle:],
        content + b"%%EOF\n",
        content[:-1],
    ):
        picture.write_bytes(edited)
        assert foreign(picture)
    picture.write_bytes(content)
    assert not foreign(picture)


def extended_by_xarray(file):
    with xr.open_dataset(file) as read:
        dataset = read.load()
    dataset.assign(mine=dataset["gap"] ** 2).to_netcdf(file, engine="netcdf4")


def extended_by_netcdf(file):
    """Made with all that the first file has, its attributes and whatever marks they hold."""
    extended_by_xarray(file)
    with netCDF4.Dataset(file, "a") as opened:
        opened.remark = "checked"
        opened["gap"][0] = 7.0


def changed_in_place(file):
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


def added_behind_the_mark(file):
    file.write_bytes(file.read_bytes() + b"\n")


@pytest.mark.parametrize("change", [extended_by_xarray, extended_by_netcdf, changed_in_place, added_behind_the_mark])
def test_a_dataset_of_ours_that_somebody_changed_is_his(tmp_path, scene, change):
    out = tmp_path / "out.nc"
    assert gfmd("solve", scene, "-o", out)[0] == 0
    change(out)
    before = out.read_bytes()
    code, said = gfmd("solve", scene, "-o", out)
    assert code == 2
    assert f"--output: you gave {out}, which gfmd did not write, or somebody has changed since" in said
    assert out.read_bytes() == before


@pytest.mark.parametrize("target", ["file", "ours", "nothing"])
def test_an_output_is_not_written_through_a_link(tmp_path, scene, target):
    mine, link = tmp_path / "mine.nc", tmp_path / "out.nc"
    if target == "ours":
        assert gfmd("solve", scene, "-o", mine)[0] == 0
    elif target == "file":
        mine.write_text("precious")
    before = mine.read_bytes() if mine.exists() else None
    link.symlink_to(mine)
    code, said = gfmd("solve", scene, "-o", link)
    assert code == 2
    assert f"--output: you gave {link}, which is a link; gfmd allows a new file" in said
    assert link.is_symlink()
    assert (mine.read_bytes() if mine.exists() else None) == before


def test_datasets_of_ours_are_known_from_those_of_others(tmp_path):
    dataset = xr.Dataset({"x": ("i", [1.0])}, attrs={"title": f"{'long ' * 200}"})
    write_dataset(tmp_path / "ours.nc", dataset)
    dataset.to_netcdf(tmp_path / "other.nc")
    assert not foreign(tmp_path / "ours.nc")
    assert foreign(tmp_path / "other.nc")


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
    assert not foreign(table)
    text = table.read_bytes()
    table.write_bytes(EDITS[edit](text))
    assert table.read_bytes() != text
    assert foreign(table)


@pytest.mark.long
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
    changed = "which gfmd did not write, or somebody has changed since"
    assert f"{table}: the table would go here, {changed}; gfmd allows another --output" in said
    assert table.read_text() == edited
    assert (tmp_path / "c.nc").read_bytes() == before
