"""Commands that are refused: options, files that are no results, and outputs that would do harm."""

import os

import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.scene import InputError
from support.campaigns import campaign
from support.command_line import gfmd, refused
from support.scenes import SCENE

pytestmark = pytest.mark.usefixtures("undrawn")


@pytest.mark.parametrize(
    "option",
    ["eps_c", "eps_c=one", "eps_c=1:two", "eps_c=1:", "eps_x=1", "eps_c=nan", "eps_c=-1", "eps_c=2:1", "eps_c=.inf"],
)
def test_a_malformed_exponent_is_told_what_is_allowed(results, option):
    message = refused("fit", results, "--fixed", option)
    assert message.startswith("gfmd: --fixed: you gave ")
    assert (
        f"you gave {option!r}; gfmd allows eps_c, eps_f, eps_t with a number above 0 or a range, like eps_t=1"
        in message
    )


@pytest.mark.parametrize("command", ["fit", "plot"])
def test_an_exponent_that_no_law_has_is_refused(results, command, tmp_path):
    output = tmp_path / {"fit": "x.nc", "plot": "x.png"}[command]
    message = refused(command, results, "--fixed", "eps_f=1", "--fixed", "eps_t=1", "-o", output)
    assert message == (
        "gfmd: --fixed: you gave an exponent of eps_t; gfmd allows none for eps_t: these results have no levels of it"
    )
    with pytest.raises(InputError, match=r"^fixed: you gave an exponent of eps_t; gfmd allows none"):
        gfmd_numba.fit_tfc(results, fixed={"eps_f": 1.0, "eps_t": 1.0})


@pytest.fixture(scope="module")
def contact(tmp_path_factory):
    folder = tmp_path_factory.mktemp("contact")
    (folder / "scene.yaml").write_text(SCENE)
    assert gfmd("solve", folder / "scene.yaml", "-o", folder / "contact.nc").exit_code == 0
    return folder / "contact.nc"


@pytest.mark.parametrize(
    ("command", "name", "content"), [("fit", "results.yaml", "name: text\n"), ("plot", "results.nc", "")]
)
def test_files_that_are_no_results_are_refused(tmp_path, command, name, content):
    (tmp_path / name).write_text(content)
    message = refused(command, tmp_path / name, "-o", tmp_path / f"out.{'nc' if command == 'fit' else 'png'}")
    assert f"{tmp_path / name}: you gave a file that is not netCDF" in message
    assert "; gfmd allows a netCDF file that gfmd has written" in message


def test_results_of_another_kind_are_refused(tmp_path, contact):
    assert refused("fit", contact).startswith(f"gfmd: {contact}: you gave no results of a campaign; gfmd allows ")
    xr.open_dataset(contact).drop_vars("gap").to_netcdf(tmp_path / "nogap.nc")
    assert f"{tmp_path / 'nogap.nc'}: you gave no results of a contact" in refused("plot", tmp_path / "nogap.nc")
    xr.Dataset().to_netcdf(tmp_path / "empty.nc")
    assert f"{tmp_path / 'empty.nc'}: you gave no results of a campaign" in refused("plot", tmp_path / "empty.nc")


def test_an_unknown_variable_or_picture_is_told_what_is_allowed(tmp_path, results):
    message = refused("fit", results, "--variable=kapa")
    assert message.startswith(
        "gfmd: --variable: you gave 'kapa'; gfmd allows one of 'kappa', 'kappa_counted', 'kappa_r'"
    )
    message = refused("plot", results, "-o", tmp_path / "picture.doc")
    assert f"you gave {tmp_path / 'picture.doc'}; gfmd allows a picture, ending in" in message


def test_inputs_are_not_overwritten(tmp_path, results):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE.replace("{method: psd, hurst: 0.8, rms_gradient: 0.01}", "{method: measured, file: p.csv}"))
    scene.write_text(scene.read_text().partition("discretisation")[0])
    (tmp_path / "p.csv").write_text("0\n1\n0\n2\n")
    before = {file: file.read_bytes() for file in (scene, tmp_path / "p.csv", results)}
    assert f"--output: you gave {scene}, which is an input; gfmd allows another file" in refused(
        "solve", scene, "-o", scene
    )
    assert "p.csv, which is an input" in refused("solve", scene, "-o", tmp_path / "p.csv")
    assert "which is an input" in refused("fit", results.parent, "-o", results)
    assert "which is an input" in refused("plot", results, "-o", results.parent / "campaign.yaml")
    assert {file: file.read_bytes() for file in before} == before


def test_an_output_that_cannot_be_written_is_told_before_solving(tmp_path, monkeypatch):
    (tmp_path / "scene.yaml").write_text(SCENE)
    monkeypatch.setattr("gfmd_numba.solve", None)
    message = refused("solve", tmp_path / "scene.yaml", "-o", tmp_path / "no" / "out.nc")
    assert f"gfmd allows a file in a folder that exists, unlike {tmp_path / 'no'}" in message
    monkeypatch.setattr("os.access", lambda path, mode: mode != os.W_OK)
    assert "which you may not write" in refused("solve", tmp_path / "scene.yaml", "-o", tmp_path / "out.nc")


def test_a_campaign_is_no_scene_and_says_what_takes_it(tmp_path):
    message = refused("solve", campaign(tmp_path), "-o", tmp_path / "out.nc")
    assert (
        "realisations: you gave a key of campaigns; gfmd allows the keys of a scene; gfmd run and gfmd plan take"
        in message
    )
    assert message.count("you gave") == 1


@pytest.mark.parametrize("command", ["run", "plan", "accuracy"])
@pytest.mark.parametrize("scene", [SCENE, "body: {poissons_ratio: 0.3}\ninterface: {hard_wall: {}}\n"])
def test_a_scene_is_no_campaign_and_says_what_takes_it(command, scene, tmp_path):
    (tmp_path / "s.yaml").write_text(scene)
    message = refused(command, tmp_path / "s.yaml")
    assert "you gave a scene; gfmd allows the keys of a campaign; gfmd solve and gfmd curve take a scene" in message
    assert message.count("you gave") == 1


@pytest.mark.parametrize("command", ["run", "plan", "solve", "curve"])
def test_a_surface_is_no_scene_and_no_campaign_and_says_what_takes_it(command, tmp_path):
    (tmp_path / "s.yaml").write_text("surface: {method: psd, hurst: 0.8, rms_height: 1e-3, points: 64}\n")
    options = {"solve": ("-o", tmp_path / "c.nc"), "curve": ("--loads", "1,2", "-o", tmp_path / "c.nc")}
    message = refused(command, tmp_path / "s.yaml", *options.get(command, ()))
    kind = "a scene" if command in options else "a campaign"
    assert f"s.yaml:1:1: surface: you gave a surface; gfmd allows the keys of {kind}; gfmd surface takes" in message
    assert message.count("you gave") == 1


@pytest.mark.parametrize("option", [("--variable", "kappa"), ("--exponents", "shared"), ("--fixed", "eps_c=1")])
def test_a_picture_without_a_fit_takes_no_options_of_one(contact, tmp_path, option):
    message = refused("plot", contact, *option, "-o", tmp_path / "contact.png")
    assert f"{option[0]}: the picture of {contact} has no fit; leave the option out" in message
    assert not (tmp_path / "contact.png").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--foo"], "gfmd: no such option '--foo'; `gfmd --help` says what it takes"),
        (
            ["solve", "s.yaml", "--load", "1"],
            "gfmd: no such option '--load'; --loads is an option of `gfmd curve`; `gfmd ",
        ),
        (["curve", "s.yaml", "--thread", "1"], "gfmd: no such option '--thread'; --threads is an option of `gfmd "),
        (["foo"], "gfmd: no such command 'foo'; `gfmd --help` says what it takes"),
        (["fit"], "gfmd: missing argument 'RESULTS'; `gfmd fit --help` says what it takes"),
        (["fit", "none.nc"], "gfmd: RESULTS: you gave none.nc, which does not exist; gfmd needs a path that does"),
        (["solve", ".", "-o", "a.nc"], "gfmd: FILE: you gave ., which is a directory; gfmd needs a file"),
        (["status", __file__], f"gfmd: DIRECTORY: you gave {__file__}, which is a file; gfmd needs a directory"),
        (["run", "a.yaml", "--workers=x"], "gfmd: --workers: you gave 'x'; gfmd allows a number"),
        (["run", "a.yaml", "--limit=0"], "gfmd: --limit: you gave 0; gfmd allows x>=1"),
        (
            ["run", "a.yaml", "--until=foo=1%"],
            "gfmd: --until: you gave 'foo'; gfmd allows one of kappa, kappa_counted, ",
        ),
    ],
)
def test_a_command_line_is_refused_in_one_sentence_as_a_file_is(tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.yaml").write_text("a: 1\n")
    done = gfmd(*arguments)
    assert done.exit_code == 2
    assert done.stderr.startswith(said)
    assert done.stderr.count("\n") == 1
    assert "{" not in done.stderr


def test_a_netcdf_file_has_a_name_that_says_so(tmp_path):
    (tmp_path / "scene.yaml").write_text(SCENE)
    for name in ("contact.txt", "contact", "contact.png"):
        message = refused("solve", tmp_path / "scene.yaml", "-o", tmp_path / name)
        assert message == f"gfmd: --output: you gave {tmp_path / name}; gfmd allows a netCDF file, ending in .nc, .nc4"
        assert not (tmp_path / name).exists()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("cut_on: 1 um", "cut_on: 0.1 um", "cut_on: you gave '0.1 um'; gfmd allows at least 0.322581 um"),
        ("cut_on: 1 um", "cut_on: 100 nm", "cut_on: you gave '100 nm'; gfmd allows at least 322.581 nm"),
        ("cut_on: 1 um", "cut_on: 1e-7", "cut_on: you gave 1e-07; gfmd allows at least 3.22581e-07"),
        ("roll_off: 5 um", "roll_off: 0.02 mm", "roll_off: you gave '0.02 mm'; gfmd allows at most the period 0.01 mm"),
    ],
)
def test_what_is_allowed_stands_in_the_unit_that_was_given(tmp_path, old, new, said):
    text = (
        "surface: {method: psd, hurst: 0.8, rms_height: 0.01 um, points: 64, cut_on: 1 um, roll_off: 5 um}\n"
        "length: 10 um\n"
    )
    (tmp_path / "s.yaml").write_text(text.replace(old, new))
    assert said in refused("surface", tmp_path / "s.yaml", "-o", tmp_path / "s.nc")
