"""Good scene and campaign files to put one fault into, and what is said about it."""

import re

import pytest

from gfmd_numba.contact.refusal import check_combination
from gfmd_numba.scene import InputError, load_scene

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
WHOLE = "a value that makes 1/eps_t, 1/(eps_t eps_f) and nx = 2/(eps_t eps_f eps_c) whole numbers, nx at least 4, with "


def load_checked(path):
    """Read a scene file as `gfmd check` does."""
    file, document = load_scene(path)
    check_combination(document, file.scene, file.numerics, file.path)


def complaint(folder, load, text, name="bad.yaml"):
    """What is said about a text, the folder cut from it, after checking that it is said line by line."""
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as caught:
        load(path)
    message = str(caught.value).replace(f"{folder}/", "")
    for line in message.splitlines():
        assert re.match(rf"{name}:\d+:\d+: .*you gave .*; gfmd (allows|needs) .", line), line
    return message


def assert_complaint(folder, load, good, change, expected):
    """Assert that a good text loads, and how the complaint about it begins once it is changed; return the complaint."""
    (folder / "good.yaml").write_text(good)
    load(folder / "good.yaml")
    message = complaint(folder, load, changed(good, *change))
    assert message.startswith(expected)
    return message


def changed(text, old, new):
    assert text.count(old) == 1, old
    return text.replace(old, new)


def refusal(load, path):
    """What an InputError says, None without one; any other exception is a failure."""
    try:
        load(path)
    except InputError as error:
        return str(error)
    return None
