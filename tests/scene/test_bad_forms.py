"""Scene files of a wrong form: keys, kinds of values, and text that is no plain YAML."""

import pytest

from gfmd_numba.scene import load_scene, read_document
from support.faulty_files import SCENE, assert_complaint, complaint, load_checked

FORMS = {
    "unknown key": (
        ("hurst: 0.8", "hurts: 0.8"),
        "bad.yaml:3:3: scene.roughness.hurst: you gave nothing; gfmd needs a number from 0 to 1\n"
        "bad.yaml:5:5: scene.roughness.hurts: you gave an unknown key; gfmd allows one of 'rms_height', "
        "'rms_gradient', "
        "'scaling', 'points', 'cut_on', 'hurst', 'roll_off', 'method', 'model', 'plateau', 'anisotropy'; "
        "did you mean 'hurst'?",
    ),
    "key of another level": (
        ("    reduced_pressure: 0.007", "    reduced_pressure: 0.007\n    length: 1e-6"),
        "bad.yaml:10:5: scene.loading.length: you gave an unknown key; gfmd allows one of 'reduced_pressure', "
        "'pressure', 'line_load', 'force', 'displacement', 'duration', 'speed'; 'length' belongs to "
        "scene",
    ),
    "key of another method": (
        ("method: psd", "method: psd\n    file: steel.npy"),
        "bad.yaml:5:5: scene.roughness.file: you gave an unknown key; gfmd allows one of 'rms_height', 'rms_gradient', "
        "'scaling', 'points', 'cut_on', 'hurst', 'roll_off', 'method', 'model', 'plateau', 'anisotropy'; "
        "'file' belongs to scene.roughness with method measured",
    ),
    "unknown key at the top": (
        ("numerics: {", "numeric: {"),
        "bad.yaml:10:1: numeric: you gave an unknown key; gfmd allows one of 'scene', "
        "'numerics', 'points', 'discretisation', "
        "'seed', 'realisation', 'path'; did you mean 'numerics'?",
    ),
    "unknown choice": (
        ("solver: auto", "solver: verlett"),
        "bad.yaml:10:20: numerics.solver: you gave 'verlett'; gfmd allows one of 'auto', 'active_set_newton', "
        "'conjugate_gradients', 'truncated_newton', 'frictional_newton', 'verlet', 'gronbech_jensen', 'fire', "
        "'sliding_newton'; did you "
        "mean 'verlet'?",
    ),
    "unknown method": (
        ("method: psd", "method: pds"),
        "bad.yaml:4:13: scene.roughness.method: you gave 'pds'; gfmd allows one of 'fourier_filter', 'measured', "
        "'midpoint_displacement', 'psd', 'successive_addition'; did you mean 'psd'?",
    ),
    "no method": (
        ("method: psd\n    ", ""),
        "bad.yaml:3:3: scene.roughness.method: you gave nothing; gfmd needs one of 'fourier_filter', 'measured', 'midp",
    ),
    "wrong type": (
        ("hurst: 0.8", "hurst: [0.8, 0.9]"),
        "bad.yaml:5:12: scene.roughness.hurst: you gave [0.8, 0.9]; gfmd allows a number from 0 to 1",
    ),
    "a number where a mapping belongs": (
        ("{hard_wall: {}}", "3"),
        "bad.yaml:7:14: scene.interface: you gave 3; gfmd allows a mapping of 'hard_wall'",
    ),
    "an empty value": (
        ("{hard_wall: {}}", "{hard_wall: }"),
        "bad.yaml:7:14: scene.interface: you gave {'hard_wall': None}; gfmd allows hard_wall: {}, cohesive, ",
    ),
    "a truncated long value": (
        ("solver: auto", "solver: " + 500 * "x"),
        f"bad.yaml:10:20: numerics.solver: you gave '{27 * 'x'}...{28 * 'x'}'; gfmd allows one of",
    ),
    "quoted number": (
        ("hurst: 0.8", "hurst: '0.8'"),
        "bad.yaml:5:12: scene.roughness.hurst: you gave '0.8'; gfmd allows a number from 0 to "
        "1; did you mean 0.8 without quotes?",
    ),
    "underscored number": (
        ("{solver: auto}", "{max_iterations: 1_000}"),
        "bad.yaml:10:28: numerics.max_iterations: you gave '1_000'; gfmd allows a whole number at least 1",
    ),
    "broken whole number": (
        ("{solver: auto}", "{max_iterations: 1e3}"),
        "bad.yaml:10:28: numerics.max_iterations: you gave 1000.0; gfmd allows a whole number at least 1",
    ),
    "no as text": (
        ("hurst: 0.8", "hurst: no"),
        "bad.yaml:5:12: scene.roughness.hurst: you gave 'no'; gfmd allows a number from 0 to 1",
    ),
    "boolean": (
        ("hurst: 0.8", "hurst: true"),
        "bad.yaml:5:12: scene.roughness.hurst: you gave true; gfmd allows a number from 0 to 1",
    ),
    "duplicate key": (
        ("    hurst: 0.8\n", "    hurst: 0.8\n    hurst: 0.9\n"),
        "bad.yaml:6:5: scene.roughness.hurst: you gave the key a second time (first on line 5); gfmd allows each key "
        "once",
    ),
    "alias": (
        ("hurst: 0.8", "hurst: *other"),
        "bad.yaml:5:12: you gave an anchor or alias; gfmd allows the value itself",
    ),
    "anchor": (
        ("hurst: 0.8", "hurst: &other 0.8"),
        "bad.yaml:5:12: you gave an anchor or alias; gfmd allows the value itself",
    ),
    "merge key": (
        ("hurst: 0.8", "<<: {hurst: 0.8}"),
        "bad.yaml:5:5: scene.roughness: you gave the key '<<'; gfmd allows keys that are text, no merge keys",
    ),
    "tag": (
        ("hurst: 0.8", "hurst: !!python/object/apply:os.system [echo]"),
        "bad.yaml:5:12: you gave the tag tag:yaml.org,2002:python/object/apply:os.system; gfmd allows a value "
        "without a tag",
    ),
    "number as a key": (
        ("hurst: 0.8", "1: 0.8"),
        "bad.yaml:5:5: scene.roughness: you gave the key 1; gfmd allows keys that are text",
    ),
    "key that is no word": (
        ("hurst: 0.8", 'hurst: 0.8\n    "a\\nb": 1'),
        "bad.yaml:6:5: scene.roughness['a\\nb']: you gave an unknown key; gfmd allows one of 'rms_height', "
        "'rms_gradient', ",
    ),
    "list as a key": (
        ("hurst: 0.8", "[a]: 0.8"),
        "bad.yaml:5:5: scene.roughness: you gave a list or mapping as a key; gfmd allows keys that are text",
    ),
    "second document": (
        ("numerics:", "---\nnumerics:"),
        "bad.yaml:10:1: you gave a second document; gfmd allows one document per file",
    ),
    "tab": (
        ("    hurst: 0.8", "\thurst: 0.8"),
        "bad.yaml:5:1: you gave a tab; gfmd allows spaces",
    ),
    "syntax": (
        ("hurst: 0.8", "hurst: 0.8: 3"),
        "bad.yaml:5:15: you gave text that is not YAML (mapping values are not allowed here); gfmd allows YAML 1.2, "
        "with a colon and a space after each key",
    ),
    "unprintable character": (
        ("hurst: 0.8", "hurst: \x07"),
        "bad.yaml:5:12: you gave the character U+0007; gfmd allows printable text",
    ),
}


@pytest.mark.parametrize("name", FORMS)
def test_a_wrong_form_is_refused_where_it_stands(tmp_path, name):
    change, expected = FORMS[name]
    message = assert_complaint(tmp_path, load_checked, SCENE, change, expected)
    assert message.count("\n") == expected.count("\n")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "bad.yaml:1:1: you gave an empty file; gfmd allows a mapping"),
        ("# nothing\n", "bad.yaml:1:1: you gave an empty file; gfmd allows a mapping"),
        ("~\n", "bad.yaml:1:1: you gave an empty value; gfmd allows a mapping of 'scene', 'numerics', "),
        ("\n- 1\n- 2\n", "bad.yaml:2:1: you gave [1, 2]; gfmd allows a mapping of 'scene', 'numerics', "),
        ("a: " + 100_000 * "[", "bad.yaml:1:23: you gave deeper nesting; gfmd allows at most 20 levels"),
        ("- " * 5000 + "1", "bad.yaml:1:41: you gave deeper nesting; gfmd allows at most 20 levels"),
        ("a: &a [1]\nb: [*a, *a]\n", "bad.yaml:1:4: you gave an anchor or alias; gfmd allows the value itself"),
        (b"scene:\n  a: \xff\n", "bad.yaml:2:6: you gave the byte 0xff; gfmd allows text in UTF-8"),
        ("a: [1, 2\n", "bad.yaml:2:1: you gave text that is not YAML"),
    ],
)
def test_text_that_is_no_plain_yaml_is_refused_at_its_first_fault(tmp_path, text, expected):
    assert complaint(tmp_path, load_scene, text).startswith(expected)


def test_an_alias_bomb_is_refused_at_its_first_anchor(tmp_path):
    levels = [f"l{i}: &l{i} [{', '.join(9 * [f'*l{i - 1}'])}]" for i in range(1, 40)]
    message = complaint(tmp_path, read_document, "\n".join(["l0: &l0 lol", *levels]))
    assert message == "bad.yaml:1:5: you gave an anchor or alias; gfmd allows the value itself"
