"""Commands that are refused: options, files that are no results, and outputs that would do harm."""

import os

import pytest
import xarray as xr

from support.campaigns import campaign
from support.command_line import gfmd, refused
from support.scenes import SCENE


@pytest.mark.parametrize(
    "option",
    ["eps_c", "eps_c=one", "eps_c=1:two", "eps_c=1:", "eps_x=1", "eps_c=nan", "eps_c=-1", "eps_c=2:1", "eps_c=.inf"],
)
def test_a_malformed_exponent_is_told_what_is_allowed(results, option):
    message = refused("fit", results, "--fixed", option)
    assert "'--fixed'" in message
    assert f"given {option!r}; allowed: eps_c, eps_f, eps_t with a number above 0 or a range, like eps_t=1" in message


@pytest.fixture(scope="module")
def contact(tmp_path_factory):
    folder = tmp_path_factory.mktemp("contact")
    (folder / "scene.yaml").write_text(SCENE)
    assert gfmd("solve", folder / "scene.yaml", "-o", folder / "contact.nc").exit_code == 0
    return folder / "contact.nc"


@pytest.mark.parametrize("command", ["fit", "plot"])
@pytest.mark.parametrize("content", ["", "name: text\n"])
def test_files_that_are_no_results_are_refused(tmp_path, command, content):
    for name in ("results.nc", "results.yaml"):
        (tmp_path / name).write_text(content)
        message = refused(command, tmp_path / name, "-o", tmp_path / "out.png")
        assert f"{tmp_path / name}: given a file that is not netCDF" in message
        assert "; allowed: a netCDF file that gfmd has written" in message


def test_results_of_another_kind_are_refused(tmp_path, results, contact):
    assert gfmd("fit", results, "--fixed=eps_c=1", "--fixed=eps_f=1/2:1", "-o", tmp_path / "fit.nc").exit_code == 0
    message = refused("fit", tmp_path / "fit.nc")
    assert message.startswith(f"gfmd: {tmp_path / 'fit.nc'}: given no results of a campaign; allowed: ")
    assert refused("fit", contact).startswith(f"gfmd: {contact}: given no results of a campaign; allowed: ")
    xr.open_dataset(contact).drop_vars("gap").to_netcdf(tmp_path / "nogap.nc")
    assert f"{tmp_path / 'nogap.nc'}: given no results of a contact" in refused("plot", tmp_path / "nogap.nc")
    xr.Dataset().to_netcdf(tmp_path / "empty.nc")
    for command in ("fit", "plot"):
        assert f"{tmp_path / 'empty.nc'}: given no results of a campaign" in refused(command, tmp_path / "empty.nc")


def test_an_unknown_variable_or_picture_is_told_what_is_allowed(tmp_path, results):
    assert "'kapa' is not one of 'kappa', 'kappa_counted', 'kappa_r'" in refused("fit", results, "--variable=kapa")
    message = refused("plot", results, "-o", tmp_path / "picture.doc")
    assert f"given {tmp_path / 'picture.doc'}; allowed: a picture ending in" in message


def test_inputs_are_not_overwritten(tmp_path, results):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE.replace("{method: psd, hurst: 0.8, rms_gradient: 0.01}", "{method: measured, file: p.csv}"))
    scene.write_text(scene.read_text().partition("discretisation")[0])
    (tmp_path / "p.csv").write_text("0\n1\n0\n2\n")
    before = {file: file.read_bytes() for file in (scene, tmp_path / "p.csv", results)}
    assert f"--output: given {scene}, which is an input; allowed: another file" in refused("solve", scene, "-o", scene)
    assert "p.csv, which is an input" in refused("solve", scene, "-o", tmp_path / "p.csv")
    assert "which is an input" in refused("fit", results.parent, "-o", results)
    assert "which is an input" in refused("plot", results, "-o", results.parent / "campaign.yaml")
    assert {file: file.read_bytes() for file in before} == before


def test_an_output_that_cannot_be_written_is_told_before_solving(tmp_path, monkeypatch):
    (tmp_path / "scene.yaml").write_text(SCENE)
    monkeypatch.setattr("gfmd_numba.solve", None)
    message = refused("solve", tmp_path / "scene.yaml", "-o", tmp_path / "no" / "out.nc")
    assert f"allowed: a file in a folder that exists, unlike {tmp_path / 'no'}" in message
    monkeypatch.setattr("os.access", lambda path, mode: mode != os.W_OK)
    assert "which you may not write" in refused("solve", tmp_path / "scene.yaml", "-o", tmp_path / "out.nc")


def test_a_campaign_is_no_scene_and_says_what_takes_it(tmp_path):
    message = refused("solve", campaign(tmp_path), "-o", tmp_path / "out.nc")
    assert (
        "realisations: given a key of campaigns; allowed: the keys of a scene; gfmd run and gfmd plan take" in message
    )
    assert message.count("given") == 1


@pytest.mark.parametrize("option", [("--variable", "kappa"), ("--exponents", "shared"), ("--fixed", "eps_c=1")])
def test_a_picture_without_a_fit_takes_no_options_of_one(contact, tmp_path, option):
    message = refused("plot", contact, *option, "-o", tmp_path / "contact.png")
    assert f"{option[0]}: given for" in message
    assert "allowed: nothing, as its picture has no fit" in message
    assert not (tmp_path / "contact.png").exists()
