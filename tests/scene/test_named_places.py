"""How a message names the place of a fault: in a file, a flat file, a mapping and a record."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.scene import InputError, SceneFile, load_scene
from support.faulty_files import SCENE, changed, complaint

FLAT = """\
body: {poissons_ratio: 0.33}
roughness: {method: psd, hurst: 1.4, rms_gradient: 0.01}
interface: {hard_wall: {}}
loading: {reduced_presure: 0.007}
discretisation: {eps_c: 1/2, eps_f: 1/64, eps_t: 1/2}
"""


def test_a_path_that_is_no_file_is_named(tmp_path):
    with pytest.raises(InputError) as caught:
        load_scene(tmp_path / "absent.yaml")
    assert str(caught.value) == (
        f"{tmp_path}/absent.yaml: you gave a path that cannot be read (No such file or directory); gfmd allows a "
        "YAML file"
    )
    with pytest.raises(InputError, match="Is a directory"):
        load_scene(tmp_path)


def test_flat_file_is_told_its_own_paths(tmp_path):
    assert complaint(tmp_path, load_scene, FLAT) == (
        "bad.yaml:2:33: roughness.hurst: you gave 1.4; gfmd allows a number from 0 to 1\n"
        "bad.yaml:4:11: loading.reduced_presure: you gave an unknown key; gfmd allows one of 'reduced_pressure', "
        "'pressure', 'line_load', 'force', 'displacement', 'duration', 'speed'; did you mean "
        "'reduced_pressure'?"
    )
    assert (
        complaint(tmp_path, load_scene, "roughnes: 1\n" + FLAT)
        .splitlines()[-1]
        .startswith("bad.yaml:1:1: roughnes: you gave an unknown key; gfmd allows one of 'body', 'roughness', ")
    )
    body = changed(FLAT, "body: {poissons_ratio: 0.33}\n", "")
    assert complaint(tmp_path, load_scene, body).startswith(
        "bad.yaml:1:1: body: you gave nothing; gfmd needs a mapping"
    )


def test_mapping_is_told_the_path_alone():
    with pytest.raises(InputError) as caught:
        load_scene({"body": {"poissons_ratio": "0.3"}})
    assert str(caught.value).splitlines()[0] == (
        "body.poissons_ratio: you gave '0.3'; gfmd allows a number above -1 and at most 0.5; did you mean 0.3 "
        "without quotes?"
    )


def test_a_fraction_in_quotes_is_told_like_a_number_in_quotes():
    with pytest.raises(InputError, match=r"eps_c: you gave '1/4'; gfmd allows .*; did you mean 1/4 without quotes"):
        load_scene({"scene": {}, "discretisation": {"eps_c": "1/4", "eps_f": 0.5, "eps_t": 0.5}})


def test_a_number_of_numpy_is_told_like_any_other():
    with pytest.raises(InputError, match=r"poissons_ratio: you gave 0\.7; gfmd allows"):
        load_scene({"body": {"poissons_ratio": np.float64(0.7)}})


def test_a_number_as_a_key_of_a_mapping_is_refused():
    with pytest.raises(InputError, match=r"body\[1\]: you gave an unknown key; gfmd allows one of 'youngs_modulus'"):
        load_scene({"body": {"poissons_ratio": 0.3, 1: 2}})


def test_record_is_checked_too(tmp_path):
    path = tmp_path / "good.yaml"
    path.write_text(SCENE)
    good = load_scene(path)[0]
    bad = SceneFile.model_validate({**good.model_dump(), "discretisation": {"eps_c": 1, "eps_f": 1, "eps_t": 0.3}})
    with pytest.raises(InputError, match=r"^discretisation\.eps_t: you gave 0\.3; .*; did you mean 1/3\?$"):
        load_scene(bad)


@pytest.mark.parametrize(
    ("place", "given", "meant"),
    [
        (("scene", "body", "E"), 1e9, "youngs_modulus"),
        (("scene", "body", "nu"), 0.3, "poissons_ratio"),
        (("scene", "roughness", "lambda_s"), 1e-6, "cutoff"),
        (("scene", "roughness", "Stylus_radius"), 1e-6, "cutoff"),
        (("scene", "roughness", "lambda_c"), 1e-4, "detrend"),
        (("scene", "roughness", "detrend"), "plane", "tilt"),
        (("scene", "roughness", "periodic"), False, "none"),
        (("scene", "interface", "JKR"), {}, "exponential"),
    ],
)
def test_names_of_standards_and_other_programs_are_known(place, given, meant):
    scene = {
        "body": {},
        "roughness": {"method": "measured", "heights": [0, 1, 0, 2]},
        "interface": {},
        "loading": {"reduced_pressure": 0.1},
    }
    scene[place[1]][place[2]] = given
    with pytest.raises(InputError) as refused:
        gfmd_numba.solve({"scene": scene})
    assert f"{'.'.join(place)}: you gave" in str(refused.value)
    assert f"did you mean {meant!r}?" in str(refused.value)


def test_a_list_of_loads_names_where_lists_stand():
    scene = {"body": {}, "interface": {"hard_wall": {}}, "roughness": {"method": "measured", "heights": [0, 1, 0, 2]}}
    with pytest.raises(InputError, match="one load: several are those of `gfmd curve --loads`, of a `path`"):
        gfmd_numba.solve({"scene": scene | {"loading": {"reduced_pressure": [0.1, 0.2]}}})
    with pytest.raises(InputError, match=r"needs a mapping like {pressure: 10 MPa}, of the first load"):
        gfmd_numba.solve({"scene": scene, "path": [{"reduced_pressure": 0.1}]})
