"""Whose an output directory is: one that a run has marked is ours, and nothing of anybody else's is touched."""

import os

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.campaign.output_directory import claimed
from gfmd_numba.campaign.shards import Finished, store
from gfmd_numba.scene import InputError
from support.campaigns import SMALL, TINY, campaign, numbers
from support.command_line import gfmd, unfolded
from support.scenes import SCENE

pytestmark = pytest.mark.usefixtures("undrawn")

PRECIOUS = ("small.nc", "small.png", "notes.tmp", "run.json", "campaign.yaml.1.tmp", "thesis.tex")


def contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("precious", [*PRECIOUS, None])
@pytest.mark.parametrize("command", ["run", "status", "collect", "verify"])
def test_the_folder_of_the_campaign_file_is_not_taken_for_an_output_directory(tmp_path, precious, command):
    path = campaign(tmp_path)
    if precious:
        (tmp_path / precious).write_text("{}")
    before = contents(tmp_path)
    said = gfmd(*(("run", path, "-o", tmp_path, "--workers=0") if command == "run" else (command, tmp_path)))
    assert said.exit_code == 2
    assert ".gfmd-campaign" in said.stderr
    assert "gfmd allows " in said.stderr
    assert contents(tmp_path) == before


def test_the_default_output_next_to_the_file_is_not_taken_from_its_owner(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    campaign(tmp_path)
    (tmp_path / "small").mkdir()
    campaign(tmp_path / "small", SMALL + "# mine\n")
    before = contents(tmp_path)
    said = gfmd("run", "campaign.yaml", "--workers=0")
    assert said.exit_code == 2
    assert (
        "small: you gave a path that holds something else; gfmd allows a new or empty directory, or one" in said.stderr
    )
    assert contents(tmp_path) == before


@pytest.mark.long
def test_files_of_others_in_an_output_directory_survive_a_run(tmp_path):
    short = "fit: {fixed: {eps_c: 1, eps_f: 1}}\ngrid:"
    path, out = campaign(tmp_path, **{"grid:": short, "[0.3, 0.8]": "[0.8]"}), tmp_path / "out"
    assert gfmd("run", path, "-o", out, "--workers=0").exit_code == 0
    for name in ("notes.tmp", "thesis.tex", "shards/mine.tmp", "small.png"):
        (out / name).write_text("precious")
    said = gfmd("run", path, "-o", out, "--workers=0")
    assert said.exit_code == 0
    assert "small.png, which gfmd did not write, or somebody has changed since, stays as it is" in unfolded(said.output)
    for name in ("notes.tmp", "thesis.tex", "shards/mine.tmp", "small.png"):
        assert (out / name).read_text() == "precious"


def test_an_edited_campaign_file_reuses_what_is_finished(tmp_path):
    one = SMALL.replace("[0.3, 0.8]", "[0.8]").replace("eps_c: [1/2, 1/4, 1/8], ", "")
    path, out = campaign(tmp_path, one), tmp_path / "out"
    whole = gfmd_numba.run(path, out)
    stamps = {shard: shard.stat().st_mtime_ns for shard in out.glob("shards/*.shard")}
    text = one.replace("eps_f: [1/8, 1/16, 1/32]", "eps_f: [1/8, 1/16]")
    with pytest.warns(UserWarning, match="holds another version of this campaign: its results are replaced"):
        changed = gfmd_numba.run(campaign(tmp_path, text), out)
    assert (whole.sizes["case"], changed.sizes["case"]) == (3, 2)
    assert {shard: shard.stat().st_mtime_ns for shard in out.glob("shards/*.shard")} == stamps
    assert (out / "campaign.yaml").read_text() == text


def test_a_copy_edited_by_hand_is_never_lost(tmp_path):
    path, out = campaign(tmp_path, TINY), tmp_path / "out"
    first = gfmd_numba.run(path, out)
    copy = out / "campaign.yaml"
    edited = TINY.replace("seed: 1", "seed: 2   # mine")
    copy.write_text(edited)
    with pytest.raises(
        InputError, match=r"campaign.yaml: you gave a copy of the campaign file that somebody has changed"
    ):
        gfmd_numba.run(path, out)
    for command in ("status", "collect", "verify"):
        assert "runs the changed one" in gfmd(command, out).stderr
    assert copy.read_text() == edited
    second = gfmd_numba.run(copy, out)  # as the message says
    assert copy.read_text() == edited
    assert second.attrs["seed"] == 2
    copy.unlink()
    xr.testing.assert_identical(numbers(gfmd_numba.run(path, out)), numbers(first))


def test_a_link_in_place_of_the_copy_is_not_written_through(tmp_path):
    path, out = campaign(tmp_path, TINY), tmp_path / "out"
    gfmd_numba.run(path, out)
    (out / "campaign.yaml").unlink()
    mine = tmp_path / "mine.yaml"
    mine.write_text(TINY)
    (out / "campaign.yaml").symlink_to(mine)
    for text in (TINY, TINY + "# new\n"):
        with pytest.raises(InputError, match="somebody has changed"):
            gfmd_numba.run(campaign(tmp_path, text), out)
    assert mine.read_text() == TINY


@pytest.mark.parametrize("mark", ["{", "[]", "null", '{"labels": 1}', '{"labels": [[], {}]}', "[" * 100_000, "\0"])
def test_a_damaged_mark_is_no_traceback_and_costs_no_shard(tmp_path, mark):
    out = tmp_path / "out"
    with claimed(out, "small", SMALL):
        (out / "shards").mkdir()
        store(out, {"a": {"kappa": np.ones(2)}})
    (out / ".gfmd-campaign").write_text(mark)
    assert (
        ".gfmd-campaign: you gave a path which gfmd did not write, or somebody has changed"
        in gfmd("status", out).stderr
    )
    with pytest.raises(InputError, match="makes it again"), claimed(out, "small", SMALL):
        pass
    assert (out / ".gfmd-campaign").read_text() == mark
    (out / ".gfmd-campaign").unlink()
    with claimed(out, "small", SMALL):
        assert Finished(out).is_sound("a")
    assert gfmd("status", out).exit_code == 0


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:.*multi-threaded")  # by other tests
@pytest.mark.parametrize("moment", range(4))
def test_a_kill_while_a_directory_is_claimed_does_not_lock_its_owner_out(tmp_path, moment):
    """After that many of the renames that put mark and copy there, first for one text, then for another."""
    out, edited, rename, left = tmp_path / "out", SMALL + "# one\n", os.replace, [moment]

    def replace(*names):
        if left[0] == 0:
            os._exit(1)
        left[0] -= 1
        rename(*names)

    child = os.fork()
    if child == 0:
        try:
            os.replace = replace
            for text in (SMALL, edited):
                with claimed(out, "small", text):
                    pass
        finally:
            os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 1
    for text in (SMALL + "# two\n", edited, SMALL):
        with claimed(out, "small", text):
            pass
        assert (out / "campaign.yaml").read_text() == text


@pytest.mark.parametrize(
    "command", ["plot", *(pytest.param(each, marks=pytest.mark.long) for each in ("fields", "surface", "accuracy"))]
)
def test_a_picture_of_somebody_else_is_not_drawn_over(tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(SCENE)
    assert gfmd("solve", "scene.yaml", "-o", "contact.nc").exit_code == 0
    campaign(tmp_path)
    (tmp_path / "photo.png").write_text("precious")
    (tmp_path / "contact.nc").rename("photo.nc" if command == "plot" else "contact.nc")
    said = {
        "fields": lambda: gfmd("fields", "contact.nc", "-o", "photo.nc"),
        "surface": lambda: gfmd("surface", "scene.yaml", "-o", "photo.nc"),
        "plot": lambda: gfmd("plot", "photo.nc"),
        "accuracy": lambda: gfmd("accuracy", "campaign.yaml", "-o", "photo.nc"),
    }[command]()
    assert said.exit_code == 2
    assert "photo.png: the picture would go here, which gfmd did not write, or somebody has changed" in said.stderr
    assert (tmp_path / "photo.png").read_text() == "precious"


def test_a_surface_does_not_take_the_place_of_the_profile_it_is_made_from(tmp_path):
    xr.Dataset({"height": ("x", [0.0, 1.0, 0.0, 2.0, 1.0, 0.5])}).to_netcdf(tmp_path / "profile.nc")
    (tmp_path / "s.yaml").write_text("surface: {method: measured, file: profile.nc}\n")
    before = (tmp_path / "profile.nc").read_bytes()
    said = gfmd("surface", tmp_path / "s.yaml", "-o", tmp_path / "profile.nc")
    assert said.exit_code == 2
    assert "profile.nc, which is an input" in said.stderr
    assert (tmp_path / "profile.nc").read_bytes() == before
