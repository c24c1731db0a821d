"""The functions of the package: each takes a path, a mapping or a record, and a file is parsed once."""

import inspect
from importlib.metadata import version

import pytest
import xarray as xr
import yaml
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.cli import main
from gfmd_numba.scene import document, load_scene
from gfmd_numba.scene.surface_file import load_surface

SCENE = {
    "body": {"poissons_ratio": 0.3, "aspect_ratio": 1.0},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.1},
    "discretisation": {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 1},
}
SURFACE = {
    "surface": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01, "points": 64, "cut_on": 0.1, "roll_off": 0.5}
}
CAMPAIGN = {
    "name": "small",
    "seed": 1,
    "realisations": 1,
    "scene": {key: value for key, value in SCENE.items() if key != "discretisation"},
    "reference": {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 1},
}
LOADED = {
    "scene": {"body": {"poissons_ratio": 0.3, "aspect_ratio": 1.0}, "boundary": {"normal_traction": 0.01}},
    "points": 16,
}


def _curve(scene):
    return gfmd_numba.load_curve(scene, [0.1, 0.2])


@pytest.mark.parametrize(
    ("function", "load", "mapping"),
    [
        (gfmd_numba.solve, load_scene, SCENE),
        (gfmd_numba.solve, load_scene, LOADED),
        (_curve, load_scene, SCENE),
        (gfmd_numba.make_surface, load_surface, SURFACE),
        (gfmd_numba.run, load_campaign, CAMPAIGN),
    ],
)
def test_a_path_a_mapping_and_a_record_give_the_same(tmp_path, monkeypatch, function, load, mapping):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file.yaml").write_text(yaml.safe_dump(mapping))
    record = load(mapping)[0]
    first, *others = [function(source) for source in (tmp_path / "file.yaml", mapping, record)]
    timed = [name for name in first.variables if str(name).endswith(("_time", "seconds"))]
    for other in others:
        xr.testing.assert_identical(other.drop_vars(timed).drop_attrs(), first.drop_vars(timed).drop_attrs())


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    ("command", "mapping"), [("solve", SCENE), ("solve", LOADED), ("surface", SURFACE), ("check", SCENE)]
)
def test_a_command_parses_its_file_once(tmp_path, monkeypatch, command, mapping):
    parsed = []
    loader = document._PlainLoader
    monkeypatch.setattr(document, "_PlainLoader", lambda text: parsed.append(text) or loader(text))
    (tmp_path / "file.yaml").write_text(yaml.safe_dump(mapping))
    output = [] if command == "check" else ["-o", str(tmp_path / "out.nc")]
    done = CliRunner().invoke(main, [command, str(tmp_path / "file.yaml"), *output])
    assert done.exit_code == 0, done.output
    assert len(parsed) == 1


def test_every_public_function_names_its_arguments_and_types():
    for name in gfmd_numba.__all__:
        function = getattr(gfmd_numba, name)
        if inspect.isfunction(function):
            signature = inspect.signature(function)
            kinds = {parameter.kind for parameter in signature.parameters.values()}
            assert kinds == {inspect.Parameter.POSITIONAL_OR_KEYWORD}, name
            assert all(parameter.annotation for parameter in signature.parameters.values()), name
            assert signature.return_annotation in ("xr.Dataset", "Iterator[xr.Dataset]"), name
            assert "InputError" in function.__doc__, name


def test_version_and_error_are_exported():
    assert gfmd_numba.__version__ == version("gfmd-numba")
    with pytest.raises(gfmd_numba.InputError):
        gfmd_numba.solve({})
