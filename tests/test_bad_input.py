import re

import psutil
import pytest

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.contact.refusal import check_combination
from gfmd_numba.scene import InputError, SceneFile, load_scene, read_document, scene_document

SCENE = """\
scene:
  body: {poissons_ratio: 0.33, aspect_ratio: .inf}
  roughness:
    method: psd
    hurst: 0.8
    rms_gradient: 0.01
  interface: {hard_wall: {}}
  loading:
    reduced_pressure: 0.007
numerics: {solver: auto}
discretisation: {eps_c: 1/2, eps_f: 1/64, eps_t: 1/2}
"""
CAMPAIGN = """\
name: chapter4
seed: 2018
realisations: 30
scene:
  body: {poissons_ratio: 0.33, aspect_ratio: 1}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.007}
reference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}
limits: {eps_c: [1, 1/2], eps_t: [1, 1/2, 1/4]}
grid: {hurst: [0.3, 0.5]}
numerics: {solver: auto}
"""
MEASURED = SCENE.replace("method: psd\n    hurst: 0.8\n    rms_gradient: 0.01", "method: measured\n    file: steel.npy")
FLAT = """\
body: {poissons_ratio: 0.33}
roughness: {method: psd, hurst: 1.4, rms_gradient: 0.01}
interface: {hard_wall: {}}
loading: {reduced_presure: 0.007}
discretisation: {eps_c: 1/2, eps_f: 1/64, eps_t: 1/2}
"""
EXPONENT = "a finite number above 0, or the range it lies in, [low, high]"
WHOLE = "a value that makes 1/eps_t, 1/(eps_t eps_f) and nx = 2/(eps_t eps_f eps_c) whole numbers, nx at least 4, with "


def load_checked(path):
    """Read a scene file as `gfmd check` does."""
    file = load_scene(path)
    check_combination(scene_document(path), file.scene, file.numerics, file.path)


def complaint(folder, load, text, name="bad.yaml"):
    """What is said about a text, the folder cut from it, after checking that it is said line by line."""
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as caught:
        load(path)
    message = str(caught.value).replace(f"{folder}/", "")
    for line in message.splitlines():
        assert re.match(rf"{name}:\d+:\d+: .*given .*; allowed: .", line), line
    return message


def changed(text, old, new):
    assert text.count(old) == 1, old
    return text.replace(old, new)


SCENES = {
    "unknown key": (
        ("hurst: 0.8", "hurts: 0.8"),
        "bad.yaml:3:3: scene.roughness.hurst: given nothing; allowed: a number from 0 to 1\n"
        "bad.yaml:5:5: scene.roughness.hurts: given an unknown key; allowed: one of 'rms_height', 'rms_gradient', "
        "'points', 'cut_on', 'method', 'model', 'hurst', 'roll_off', 'plateau', 'anisotropy'; did you mean 'hurst'?",
    ),
    "key of another level": (
        ("    reduced_pressure: 0.007", "    reduced_pressure: 0.007\n    length: 1e-6"),
        "bad.yaml:10:5: scene.loading.length: given an unknown key; allowed: one of 'reduced_pressure', "
        "'displacement'; 'length' belongs to scene",
    ),
    "key of another method": (
        ("method: psd", "method: psd\n    file: steel.npy"),
        "bad.yaml:5:5: scene.roughness.file: given an unknown key; allowed: one of 'rms_height', 'rms_gradient', "
        "'points', 'cut_on', 'method', 'model', 'hurst', 'roll_off', 'plateau', 'anisotropy'; "
        "'file' belongs to scene.roughness with method measured",
    ),
    "unknown key at the top": (
        ("numerics: {", "numeric: {"),
        "bad.yaml:10:1: numeric: given an unknown key; allowed: one of 'scene', "
        "'numerics', 'discretisation', "
        "'seed', 'realisation', 'path'; did you mean 'numerics'?",
    ),
    "unknown choice": (
        ("solver: auto", "solver: verlett"),
        "bad.yaml:10:20: numerics.solver: given 'verlett'; allowed: one of 'auto', 'active_set_newton', "
        "'conjugate_gradients', 'verlet', 'gronbech_jensen', 'fire'; did you mean 'verlet'?",
    ),
    "unknown method": (
        ("method: psd", "method: pds"),
        "bad.yaml:4:13: scene.roughness.method: given 'pds'; allowed: one of 'fourier_filter', 'measured', "
        "'midpoint_displacement', 'psd', 'successive_addition'; did you mean 'psd'?",
    ),
    "no method": (
        ("method: psd\n    ", ""),
        "bad.yaml:3:3: scene.roughness.method: given nothing; allowed: one of 'fourier_filter', 'measured', 'midp",
    ),
    "wrong type": (
        ("hurst: 0.8", "hurst: [0.8, 0.9]"),
        "bad.yaml:5:12: scene.roughness.hurst: given [0.8, 0.9]; allowed: a number from 0 to 1",
    ),
    "a number where a mapping belongs": (
        ("{hard_wall: {}}", "3"),
        "bad.yaml:7:14: scene.interface: given 3; allowed: a mapping of 'hard_wall'",
    ),
    "an empty value": (
        ("{hard_wall: {}}", "{hard_wall: }"),
        "bad.yaml:7:14: scene.interface: given {'hard_wall': None}; allowed: hard_wall, cohesive, or",
    ),
    "a truncated long value": (
        ("solver: auto", "solver: " + 500 * "x"),
        f"bad.yaml:10:20: numerics.solver: given '{27 * 'x'}...{28 * 'x'}'; allowed: one of",
    ),
    "quoted number": (
        ("hurst: 0.8", "hurst: '0.8'"),
        "bad.yaml:5:12: scene.roughness.hurst: given '0.8'; allowed: a number from 0 to "
        "1; did you mean 0.8 without quotes?",
    ),
    "underscored number": (
        ("{solver: auto}", "{max_iterations: 1_000}"),
        "bad.yaml:10:28: numerics.max_iterations: given '1_000'; allowed: a whole number at least 1",
    ),
    "broken whole number": (
        ("{solver: auto}", "{max_iterations: 1e3}"),
        "bad.yaml:10:28: numerics.max_iterations: given 1000.0; allowed: a whole number at least 1",
    ),
    "no as text": (
        ("hurst: 0.8", "hurst: no"),
        "bad.yaml:5:12: scene.roughness.hurst: given 'no'; allowed: a number from 0 to 1",
    ),
    "boolean": (
        ("hurst: 0.8", "hurst: true"),
        "bad.yaml:5:12: scene.roughness.hurst: given true; allowed: a number from 0 to 1",
    ),
    "nu above 1/2": (
        ("poissons_ratio: 0.33", "poissons_ratio: 0.51"),
        "bad.yaml:2:26: scene.body.poissons_ratio: given 0.51; allowed: a number above -1 and at most 0.5",
    ),
    "nu of -1": (
        ("poissons_ratio: 0.33", "poissons_ratio: -1"),
        "bad.yaml:2:26: scene.body.poissons_ratio: given -1; allowed: a number above -1 and at most 0.5",
    ),
    "no nu": (
        ("poissons_ratio: 0.33, ", ""),
        "bad.yaml:2:3: scene.body.poissons_ratio: given nothing; allowed: a number above -1 and at most 0.5",
    ),
    "aspect ratio of 0": (
        ("aspect_ratio: .inf", "aspect_ratio: 0"),
        "bad.yaml:2:46: scene.body.aspect_ratio: given 0; allowed: from 1e-12 to 1e30, or .inf for a half-space",
    ),
    "aspect ratio too large for a float": (
        ("aspect_ratio: .inf", "aspect_ratio: 1e400"),
        "bad.yaml:2:46: scene.body.aspect_ratio: given '1e400'; allowed: from 1e-12 to 1e30, or .inf for a half-space",
    ),
    "aspect ratio of nan": (
        ("aspect_ratio: .inf", "aspect_ratio: .nan"),
        "bad.yaml:2:46: scene.body.aspect_ratio: given nan; allowed: from 1e-12 to 1e30, or .inf for a half-space",
    ),
    "Young's modulus of 0": (
        ("poissons_ratio: 0.33", "poissons_ratio: 0.33, youngs_modulus: 0"),
        "bad.yaml:2:48: scene.body.youngs_modulus: given 0; allowed: a number from 1e-30 to 1e+30",
    ),
    "H above 1": (
        ("hurst: 0.8", "hurst: 1.4"),
        "bad.yaml:5:12: scene.roughness.hurst: given 1.4; allowed: a number from 0 to 1",
    ),
    "H below 0": (
        ("hurst: 0.8", "hurst: -1/64"),
        "bad.yaml:5:12: scene.roughness.hurst: given -0.015625; allowed: a number from 0 to 1",
    ),
    "H of nan": (
        ("hurst: 0.8", "hurst: .nan"),
        "bad.yaml:5:12: scene.roughness.hurst: given nan; allowed: a number from 0 to 1",
    ),
    "rms gradient of 0": (
        ("rms_gradient: 0.01", "rms_gradient: 0"),
        "bad.yaml:6:19: scene.roughness.rms_gradient: given 0; allowed: a number from 1e-30 to 1e+30",
    ),
    "negative rms gradient": (
        ("rms_gradient: 0.01", "rms_gradient: -1e-3"),
        "bad.yaml:6:19: scene.roughness.rms_gradient: given -0.001; allowed: a number from 1e-30 to 1e+30",
    ),
    "infinite rms gradient": (
        ("rms_gradient: 0.01", "rms_gradient: .inf"),
        "bad.yaml:6:19: scene.roughness.rms_gradient: given inf; allowed: a number from 1e-30 to 1e+30",
    ),
    "negative pressure": (
        ("reduced_pressure: 0.007", "reduced_pressure: -0.007"),
        "bad.yaml:9:23: scene.loading.reduced_pressure: given -0.007; allowed: a number from 1e-30 to 1e+30",
    ),
    "both loadings": (
        ("    reduced_pressure: 0.007", "    reduced_pressure: 0.007\n    displacement: 0.1"),
        "bad.yaml:9:5: scene.loading: given {'displacement': 0.1, 'reduced_pressure': 0.007}; "
        "allowed: exactly one of reduced_pressure and displacement",
    ),
    "no loading": (
        ("loading:\n    reduced_pressure: 0.007", "loading: {}"),
        "bad.yaml:8:12: scene.loading: given {}; allowed: exactly one of reduced_pressure and displacement",
    ),
    "half-space under displacement": (
        ("reduced_pressure: 0.007", "displacement: 0.1"),
        "bad.yaml:2:46: scene.body.aspect_ratio: given inf; allowed: a finite aspect_ratio, or "
        "loading.reduced_pressure in place of loading.displacement, as a half-space has no reference",
    ),
    "time step above the limit": (
        ("{solver: auto}", "{time_step: 1.01}"),
        "bad.yaml:10:23: numerics.time_step: given 1.01; allowed: a number from 1e-6 to 1, as more is above "
        "the stability limit",
    ),
    "residual too large": (
        ("{solver: auto}", "{residual: 1/10}"),
        "bad.yaml:10:22: numerics.residual: given 0.1; allowed: a number above 0 and at most 0.01",
    ),
    "residual too small for single precision": (
        ("{solver: auto}", "{precision: single, residual: 1e-4}"),
        "bad.yaml:10:41: numerics.residual: given 0.0001; allowed: at least 0.001 in single precision",
    ),
    "residual by default too small for single precision": (
        ("{solver: auto}", "{precision: single}"),
        "bad.yaml:10:1: numerics.residual: given nothing; allowed: at least 0.001 in single precision",
    ),
    "damping too large": (
        ("{solver: auto}", "{damping: 101}"),
        "bad.yaml:10:21: numerics.damping: given 101; allowed: a number from 0 to 100",
    ),
    "negative seed": (
        ("numerics:", "seed: -1\nnumerics:"),
        "bad.yaml:10:7: seed: given -1; allowed: a whole number at least 0",
    ),
    "eps above 1": (
        ("eps_c: 1/2", "eps_c: 3/2"),
        "bad.yaml:11:25: discretisation.eps_c: given 1.5; allowed: a number above 0 and at most 1",
    ),
    "psd without discretisation": (
        ("discretisation: {eps_c: 1/2, eps_f: 1/64, eps_t: 1/2}\n", ""),
        "bad.yaml:1:1: discretisation: given nothing; allowed: a mapping with eps_c, eps_f and eps_t, which "
        "a random surface without points of its own needs",
    ),
    "k_l not whole": (
        ("eps_t: 1/2", "eps_t: 2/5"),
        f"bad.yaml:11:50: discretisation.eps_t: given 0.4; allowed: {WHOLE}eps_c = 0.5 and eps_f = 0.015625; "
        "did you mean 1/3?",
    ),
    "k_s not whole": (
        ("eps_f: 1/64", "eps_f: 0.3"),
        f"bad.yaml:11:37: discretisation.eps_f: given 0.3; allowed: {WHOLE}eps_c = 0.5 and eps_t = 0.5; "
        "did you mean 2/7?",
    ),
    "nx not whole": (
        ("eps_c: 1/2", "eps_c: 0.3333"),
        f"bad.yaml:11:25: discretisation.eps_c: given 0.3333; allowed: {WHOLE}eps_f = "
        "0.015625 and eps_t = 0.5; "
        "did you mean 1/3?",
    ),
    "nx below 4": (
        ("eps_c: 1/2, eps_f: 1/64, eps_t: 1/2", "eps_c: 1, eps_f: 1, eps_t: 1"),
        f"bad.yaml:11:25: discretisation.eps_c: given 1; allowed: {WHOLE}eps_f = 1 and eps_t = 1; did you mean 1/2?",
    ),
    "overflowing nx": (
        ("eps_f: 1/64", "eps_f: 1e-320"),
        "bad.yaml:11:37: discretisation.eps_f: given 1e-320; allowed: a grid that fits in ",
    ),
    "duplicate key": (
        ("    hurst: 0.8\n", "    hurst: 0.8\n    hurst: 0.9\n"),
        "bad.yaml:6:5: scene.roughness.hurst: given a second time (first on line 5); allowed: each key once",
    ),
    "alias": (
        ("hurst: 0.8", "hurst: *other"),
        "bad.yaml:5:12: given an anchor or alias; allowed: the value itself",
    ),
    "anchor": (
        ("hurst: 0.8", "hurst: &other 0.8"),
        "bad.yaml:5:12: given an anchor or alias; allowed: the value itself",
    ),
    "merge key": (
        ("hurst: 0.8", "<<: {hurst: 0.8}"),
        "bad.yaml:5:5: scene.roughness: given the key '<<'; allowed: keys that are text, no merge keys",
    ),
    "tag": (
        ("hurst: 0.8", "hurst: !!python/object/apply:os.system [echo]"),
        "bad.yaml:5:12: given the tag tag:yaml.org,2002:python/object/apply:os.system; allowed: a value without a tag",
    ),
    "number as a key": (
        ("hurst: 0.8", "1: 0.8"),
        "bad.yaml:5:5: scene.roughness: given the key 1; allowed: keys that are text",
    ),
    "key that is no word": (
        ("hurst: 0.8", 'hurst: 0.8\n    "a\\nb": 1'),
        "bad.yaml:6:5: scene.roughness['a\\nb']: given an unknown key; allowed: one of 'rms_height', 'rms_gradient', ",
    ),
    "list as a key": (
        ("hurst: 0.8", "[a]: 0.8"),
        "bad.yaml:5:5: scene.roughness: given a list or mapping as a key; allowed: keys that are text",
    ),
    "second document": (
        ("numerics:", "---\nnumerics:"),
        "bad.yaml:10:1: given a second document; allowed: one document per file",
    ),
    "tab": (
        ("    hurst: 0.8", "\thurst: 0.8"),
        "bad.yaml:5:1: given a tab; allowed: spaces",
    ),
    "syntax": (
        ("hurst: 0.8", "hurst: 0.8: 3"),
        "bad.yaml:5:15: given text that is not YAML (mapping values are not allowed here); allowed: YAML 1.2",
    ),
    "unprintable character": (
        ("hurst: 0.8", "hurst: \x07"),
        "bad.yaml:5:12: given the character U+0007; allowed: printable text",
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_bad_scene(tmp_path, name):
    change, expected = SCENES[name]
    load_checked(tmp_path.joinpath("good.yaml").write_text(SCENE) and tmp_path / "good.yaml")
    message = complaint(tmp_path, load_checked, changed(SCENE, *change))
    assert message.startswith(expected)
    assert message.count("\n") == expected.count("\n")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "bad.yaml:1:1: given an empty file; allowed: a mapping"),
        ("# nothing\n", "bad.yaml:1:1: given an empty file; allowed: a mapping"),
        ("~\n", "bad.yaml:1:1: given an empty value; allowed: a mapping of 'scene', 'numerics', "),
        ("\n- 1\n- 2\n", "bad.yaml:2:1: given [1, 2]; allowed: a mapping of 'scene', 'numerics', "),
        ("a: " + 100_000 * "[", "bad.yaml:1:23: given deeper nesting; allowed: at most 20 levels"),
        ("- " * 5000 + "1", "bad.yaml:1:41: given deeper nesting; allowed: at most 20 levels"),
        ("a: &a [1]\nb: [*a, *a]\n", "bad.yaml:1:4: given an anchor or alias; allowed: the value itself"),
        (b"scene:\n  a: \xff\n", "bad.yaml:2:6: given the byte 0xff; allowed: text in UTF-8"),
        ("a: [1, 2\n", "bad.yaml:2:1: given text that is not YAML"),
    ],
)
def test_bad_text(tmp_path, text, expected):
    assert complaint(tmp_path, load_scene, text).startswith(expected)


def test_alias_bomb_is_refused_at_its_first_anchor(tmp_path):
    levels = [f"l{i}: &l{i} [{', '.join(9 * [f'*l{i - 1}'])}]" for i in range(1, 40)]
    message = complaint(tmp_path, read_document, "\n".join(["l0: &l0 lol", *levels]))
    assert message == "bad.yaml:1:5: given an anchor or alias; allowed: the value itself"


def test_path_that_is_no_file(tmp_path):
    with pytest.raises(InputError) as caught:
        load_scene(tmp_path / "absent.yaml")
    assert str(caught.value) == (
        f"{tmp_path}/absent.yaml: given a path that cannot be read (No such file or directory); allowed: a YAML file"
    )
    with pytest.raises(InputError, match="Is a directory"):
        load_scene(tmp_path)


def test_flat_file_is_told_its_own_paths(tmp_path):
    assert complaint(tmp_path, load_scene, FLAT) == (
        "bad.yaml:2:33: roughness.hurst: given 1.4; allowed: a number from 0 to 1\n"
        "bad.yaml:4:11: loading.reduced_presure: given an unknown key; allowed: one of 'reduced_pressure', "
        "'displacement'; did you mean 'reduced_pressure'?"
    )
    assert (
        complaint(tmp_path, load_scene, "roughnes: 1\n" + FLAT)
        .splitlines()[-1]
        .startswith("bad.yaml:1:1: roughnes: given an unknown key; allowed: one of 'body', 'roughness', ")
    )
    body = changed(FLAT, "body: {poissons_ratio: 0.33}\n", "")
    assert complaint(tmp_path, load_scene, body).startswith("bad.yaml:1:1: body: given nothing; allowed: a mapping")


def test_mapping_is_told_the_path_alone():
    with pytest.raises(InputError) as caught:
        load_scene({"body": {"poissons_ratio": "0.3"}})
    assert str(caught.value).splitlines()[0] == (
        "body.poissons_ratio: given '0.3'; allowed: a number above -1 and at most 0.5; did you mean 0.3 without quotes?"
    )


def test_mapping_with_a_number_as_a_key():
    with pytest.raises(InputError, match=r"body\[1\]: given an unknown key; allowed: one of 'youngs_modulus'"):
        load_scene({"body": {"poissons_ratio": 0.3, 1: 2}})


def test_record_is_checked_too(tmp_path):
    path = tmp_path / "good.yaml"
    path.write_text(SCENE)
    good = load_scene(path)
    bad = SceneFile.model_validate({**good.model_dump(), "discretisation": {"eps_c": 1, "eps_f": 1, "eps_t": 0.3}})
    with pytest.raises(InputError, match=r"^discretisation\.eps_t: given 0\.3; .*; did you mean 1/3\?$"):
        load_scene(bad)


def test_incompressible_body_under_displacement_with_verlet(tmp_path):
    text = changed(SCENE, "0.33, aspect_ratio: .inf", "0.5, aspect_ratio: 1")
    text = changed(changed(text, "reduced_pressure: 0.007", "displacement: 0.1"), "auto", "verlet")
    assert complaint(tmp_path, gfmd_numba.solve, text).startswith(
        "bad.yaml:10:20: numerics.solver: given 'verlet'; allowed: 'active_set_newton', 'conjugate_gradients' or "
        "'auto' under loading.displacement at poissons_ratio 0.5"
    )
    (tmp_path / "good.yaml").write_text(changed(text, "poissons_ratio: 0.5", "poissons_ratio: 0.499"))
    assert load_scene(tmp_path / "good.yaml").scene.body.poissons_ratio == 0.499


def test_nx_too_large(tmp_path, monkeypatch):
    class Memory:
        total = 8e9

    monkeypatch.setattr(psutil, "virtual_memory", Memory)
    text = changed(SCENE, "eps_f: 1/64", "eps_f: 1/16777216")
    assert complaint(tmp_path, load_scene, text) == (
        "bad.yaml:11:37: discretisation.eps_f: given 5.960464477539063e-08; allowed: a "
        "grid that fits in 8 GB of "
        "memory, where nx = 1.34218e+08 needs 17.2 GB"
    )
    text = changed(CAMPAIGN, "eps_c: [1, 1/2]", "eps_c: [1, 1/2, 1/262144]")
    assert complaint(tmp_path, load_campaign, text).startswith("bad.yaml:10:26: limits.eps_c[2]: given 3.8146")


@pytest.mark.parametrize(
    ("file", "expected"),
    [
        (
            "steel.npy",
            "bad.yaml:5:11: scene.roughness.file: given 'steel.npy'; allowed: an existing file, unlike ",
        ),
        (
            "steel.txt",
            "bad.yaml:5:11: scene.roughness.file: given 'steel.txt'; allowed: an existing file, unlike ",
        ),
        ("steal.npy", "; did you mean 'steels.npy'?"),
        ("a/b/steel.npy", "allowed: an existing file, unlike a/b/steel.npy"),
        ("''", "bad.yaml:5:11: scene.roughness.file: given ''; allowed: text"),
    ],
)
def test_bad_profile(tmp_path, file, expected):
    (tmp_path / "steels.npy").touch()
    text = changed(MEASURED.partition("discretisation")[0], "steel.npy", file)
    assert expected in complaint(tmp_path, load_scene, text)
    text = changed(text, f"file: {file}", "file: steels.npy")
    (tmp_path / "good.yaml").write_text(text)
    assert load_scene(tmp_path / "good.yaml").scene.roughness.file.endswith("steels.npy")


def test_a_folder_is_no_profile(tmp_path):
    (tmp_path / "steel.npy").mkdir()
    complaints = complaint(tmp_path, load_scene, MEASURED.partition("discretisation")[0])
    assert "allowed: an existing file, unlike the folder" in complaints
    assert "did you mean" not in complaints


def test_measured_profile_with_discretisation(tmp_path):
    (tmp_path / "steel.npy").touch()
    assert complaint(tmp_path, load_scene, MEASURED).startswith(
        "bad.yaml:10:17: discretisation: given {'eps_c': 0.5, 'eps_f': 0.015625, 'eps_t': 0.5}; "
        "allowed: nothing, as every surface has its own grid"
    )


CAMPAIGNS = {
    "name": (
        ("name: chapter4", "name: ../etc"),
        "bad.yaml:1:7: name: given '../etc'; allowed: up to 100 letters, digits, '.', '_' and '-', not starting",
    ),
    "long name": (
        ("name: chapter4", "name: " + 101 * "a"),
        "bad.yaml:1:7: name: given 'aaaa",
    ),
    "empty name": (
        ("name: chapter4", "name: ''"),
        "bad.yaml:1:7: name: given ''; allowed: up to 100 letters",
    ),
    "no realisations": (
        ("realisations: 30", "realisations: 0"),
        "bad.yaml:3:15: realisations: given 0; allowed: a whole number from 1 to 1000000, or a mapping of such",
    ),
    "realisations for fewer levels than there are": (
        ("realisations: 30", "realisations: {reference: 30, eps_t: [3, 2]}"),
        "bad.yaml:3:38: realisations.eps_t: given [3, 2]; allowed: 3 numbers, as limits.eps_t has so many levels",
    ),
    "realisations of an unknown limit": (
        ("realisations: 30", "realisations: {reference: 30, eps_x: 3}"),
        "bad.yaml:3:31: realisations.eps_x: given an unknown key; allowed: one of 'reference', 'eps_c', 'eps_f', ",
    ),
    "realisations of no reference": (
        ("realisations: 30", "realisations: {eps_c: 3}"),
        "bad.yaml:3:1: realisations.reference: given nothing; allowed: a whole number from 1 to 1000000",
    ),
    "key of another level": (
        ("seed: 2018", "seed: 2018\nlength: 1e-6"),
        "bad.yaml:3:1: length: given an unknown key; allowed: one of 'name', 'seed', "
        "'realisations', 'scene', "
        "'reference', 'limits', 'grid', 'numerics', 'fit', 'target', 'case_timeout'; 'length' belongs to scene",
    ),
    "key of several levels": (
        ("seed: 2018", "seed: 2018\neps_c: 1"),
        "bad.yaml:3:1: eps_c: given an unknown key; allowed: one of 'name', 'seed', 'realisations', 'scene', "
        "'reference', 'limits', 'grid', 'numerics', 'fit', 'target', 'case_timeout'; "
        "'eps_c' belongs to realisations or reference or limits or grid or fit.fixed",
    ),
    "unknown axis": (
        ("grid: {hurst", "grid: {hurts"),
        "bad.yaml:11:8: grid.hurts: given an unknown key; allowed: one of 'hurst', ",
    ),
    "axis that is no list": (
        ("[0.3, 0.5]", "0.3"),
        "bad.yaml:11:15: grid.hurst: given 0.3; allowed: a list of one or more numbers from 0 to 1",
    ),
    "empty axis": (
        ("[0.3, 0.5]", "[]"),
        "bad.yaml:11:15: grid.hurst: given []; allowed: a list of one or more numbers from 0 to 1",
    ),
    "bad value on an axis": (
        ("[0.3, 0.5]", "[0.3, 1.5]"),
        "bad.yaml:11:21: grid.hurst[1]: given 1.5; allowed: a number from 0 to 1",
    ),
    "repeated value": (
        ("[1, 1/2, 1/4]", "[1, 1/2, 0.5]"),
        "bad.yaml:10:43: limits.eps_t[2]: given 0.5; allowed: each value once",
    ),
    "eps above 1": (
        ("eps_c: [1, 1/2]", "eps_c: [2, 1/2]"),
        "bad.yaml:10:18: limits.eps_c[0]: given 2; allowed: a number above 0 and at most 1",
    ),
    "axis in limits and grid": (
        ("{hurst: [0.3, 0.5]}", "{eps_c: [1, 1/4]}"),
        "bad.yaml:11:15: grid.eps_c: given [1, 0.25]; allowed: eps_c in either limits or grid, not in both",
    ),
    "measured profile": (
        ("{method: psd, hurst: 0.8, rms_gradient: 0.01}", "{method: measured, file: steel.npy}"),
        "bad.yaml:6:23: scene.roughness.method: given 'measured'; allowed: a random surface in a "
        "campaign, like method 'psd'; a measured profile "
        "belongs to `gfmd solve`",
    ),
    "pressure axis under displacement": (
        (
            "{reduced_pressure: 0.007}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\n"
            "limits: {eps_c: [1, 1/2], eps_t: [1, 1/2, 1/4]}\ngrid: {hurst: [0.3, 0.5]}",
            "{displacement: 0.1}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\ngrid: {reduced_pressure: [0.3]}",
        ),
        "bad.yaml:10:26: grid.reduced_pressure: given [0.3]; allowed: nothing, as the loading is a displacement",
    ),
    "half-space axis under displacement": (
        (
            "{reduced_pressure: 0.007}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\n"
            "limits: {eps_c: [1, 1/2], eps_t: [1, 1/2, 1/4]}\ngrid: {hurst: [0.3, 0.5]}",
            "{displacement: 0.1}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\ngrid: {aspect_ratio: [1, .inf]}",
        ),
        "bad.yaml:10:26: grid.aspect_ratio[1]: given inf; allowed: a finite aspect_ratio, or loading.reduced",
    ),
    "incompressible axis under displacement with verlet": (
        (
            "{reduced_pressure: 0.007}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\n"
            "limits: {eps_c: [1, 1/2], eps_t: [1, 1/2, 1/4]}\ngrid: {hurst: [0.3, "
            "0.5]}\nnumerics: {solver: auto}",
            "{displacement: 0.1}\nreference: {eps_c: 1/2, eps_f: 1/1024, eps_t: 1/2}\n"
            "grid: {poissons_ratio: [0.4, 1/2]}\nnumerics: {solver: verlet}",
        ),
        "bad.yaml:10:30: grid.poissons_ratio[1]: given 0.5; allowed: a number below 0.5 with solver verlet",
    ),
    "limit that gives no whole waves": (
        ("[1, 1/2, 1/4]", "[1, 1/2, 0.3]"),
        f"bad.yaml:10:43: limits.eps_t[2]: given 0.3; allowed: {WHOLE}eps_c = 0.5 and eps_f = 0.000976562; "
        "did you mean 1/3?",
    ),
    "reference that gives no whole waves": (
        ("eps_f: 1/1024", "eps_f: 0.3"),
        f"bad.yaml:9:32: reference.eps_f: given 0.3; allowed: {WHOLE}eps_c = 0.5 and eps_t = 0.5; did you mean 2/7?",
    ),
    "limit at odds with the reference": (
        ("eps_f: 1/1024", "eps_f: 2/3"),
        f"bad.yaml:10:35: limits.eps_t[0]: given 1; allowed: {WHOLE}eps_c = 0.5 and eps_f = 0.666667; "
        "did you mean 1/2?",
    ),
    "grid that gives no whole waves": (
        ("grid: {hurst: [0.3, 0.5]}", "grid: {eps_f: [1/64, 0.3]}"),
        f"bad.yaml:11:22: grid.eps_f[1]: given 0.3; allowed: {WHOLE}eps_c = 0.5 and eps_t = 0.5; did you mean 2/7?",
    ),
    "unknown variable of the fit": (
        ("numerics: {solver: auto}", "fit: {variable: kapa}"),
        "bad.yaml:12:17: fit.variable: given 'kapa'; allowed: one of 'kappa', 'kappa_counted', 'kappa_r'; "
        "did you mean 'kappa'?",
    ),
    "unknown sharing of exponents": (
        ("numerics: {solver: auto}", "fit: {exponents: both}"),
        "bad.yaml:12:18: fit.exponents: given 'both'; allowed: one of 'shared', 'free'",
    ),
    "unknown key of the fit": (
        ("numerics: {solver: auto}", "fit: {fix: {eps_t: 1}}"),
        "bad.yaml:12:7: fit.fix: given an unknown key; allowed: one of 'variable', 'exponents', 'fixed'",
    ),
    "exponent of no limit": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_x: 1}}"),
        "bad.yaml:12:15: fit.fixed.eps_x: given an unknown key; allowed: one of 'eps_c', 'eps_f', 'eps_t'",
    ),
    "exponents without limits": (
        ("numerics: {solver: auto}", "fit: {fixed: 1}"),
        "bad.yaml:12:14: fit.fixed: given 1; allowed: a mapping of 'eps_c', 'eps_f', 'eps_t'",
    ),
    "exponent of 0": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: 0}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given 0; allowed: {EXPONENT}",
    ),
    "infinite exponent": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: .inf}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given inf; allowed: {EXPONENT}",
    ),
    "exponent of nan": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: .nan}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given nan; allowed: {EXPONENT}",
    ),
    "exponent that is no number": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: one}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given 'one'; allowed: {EXPONENT}",
    ),
    "quoted exponent": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: '1'}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given '1'; allowed: {EXPONENT}; did you mean 1 without quotes?",
    ),
    "boolean exponent": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: true}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given true; allowed: {EXPONENT}",
    ),
    "range of exponents upside down": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: [1, 1/2]}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given [1, 0.5]; allowed: {EXPONENT}",
    ),
    "range of exponents from 0": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: [0, 1]}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given [0, 1]; allowed: {EXPONENT}",
    ),
    "endless range of exponents": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: [1, .inf]}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given [1, inf]; allowed: {EXPONENT}",
    ),
    "range of exponents with three ends": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: [0.5, 0.7, 1]}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given [0.5, 0.7, 1]; allowed: {EXPONENT}",
    ),
    "empty range of exponents": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: []}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given []; allowed: {EXPONENT}",
    ),
    "range of exponents in words": (
        ("numerics: {solver: auto}", "fit: {fixed: {eps_t: [low, high]}}"),
        f"bad.yaml:12:22: fit.fixed.eps_t: given ['low', 'high']; allowed: {EXPONENT}",
    ),
}


@pytest.mark.parametrize("name", CAMPAIGNS)
def test_bad_campaign(tmp_path, name):
    change, expected = CAMPAIGNS[name]
    (tmp_path / "good.yaml").write_text(CAMPAIGN)
    load_campaign(tmp_path / "good.yaml")
    assert complaint(tmp_path, load_campaign, changed(CAMPAIGN, *change)).startswith(expected)


def test_too_many_cases(tmp_path):
    hundred = [f"{i}/1000" for i in range(1, 101)]
    axes = ", ".join(f"{axis}: [{', '.join(hundred)}]" for axis in ("hurst", "aspect_ratio", "reduced_pressure"))
    message = complaint(tmp_path, load_campaign, changed(CAMPAIGN, "hurst: [0.3, 0.5]", axes))
    assert message.startswith("bad.yaml:11:7: grid: given {")
    assert message.endswith("; allowed: at most 1000000 cases, not 4000000")
