"""Scene files that name a profile that is not there, or is none."""

import pytest

from gfmd_numba.scene import load_scene
from support.faulty_files import SCENE, changed, complaint

MEASURED = SCENE.replace("method: psd\n    hurst: 0.8\n    rms_gradient: 0.01", "method: measured\n    file: steel.npy")


@pytest.mark.parametrize(
    ("file", "expected"),
    [
        (
            "steel.npy",
            "bad.yaml:5:11: scene.roughness.file: you gave 'steel.npy'; gfmd allows an existing file, unlike ",
        ),
        (
            "steel.txt",
            "bad.yaml:5:11: scene.roughness.file: you gave 'steel.txt'; gfmd allows an existing file, unlike ",
        ),
        ("steal.npy", "; did you mean 'steels.npy'?"),
        ("a/b/steel.npy", "gfmd allows an existing file, unlike a/b/steel.npy"),
        ("''", "bad.yaml:5:11: scene.roughness.file: you gave ''; gfmd allows a file name"),
    ],
)
def test_a_file_that_is_no_profile_is_refused_where_it_is_named(tmp_path, file, expected):
    (tmp_path / "steels.npy").touch()
    text = changed(MEASURED.partition("discretisation")[0], "steel.npy", file)
    assert expected in complaint(tmp_path, load_scene, text)
    text = changed(text, f"file: {file}", "file: steels.npy")
    (tmp_path / "good.yaml").write_text(text)
    assert load_scene(tmp_path / "good.yaml")[0].scene.roughness.file.endswith("steels.npy")


def test_a_folder_is_no_profile(tmp_path):
    (tmp_path / "steel.npy").mkdir()
    complaints = complaint(tmp_path, load_scene, MEASURED.partition("discretisation")[0])
    assert "gfmd allows an existing file, unlike the folder" in complaints
    assert "did you mean" not in complaints


def test_a_measured_profile_has_no_discretisation(tmp_path):
    (tmp_path / "steel.npy").touch()
    assert complaint(tmp_path, load_scene, MEASURED).startswith(
        "bad.yaml:10:17: discretisation: you gave {'eps_c': 0.5, 'eps_f': 0.015625, 'eps_t': 0.5}; "
        "gfmd allows nothing, as every surface has its own grid"
    )
