"""Scene files whose values are out of range, or at odds with each other."""

import psutil
import pytest

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.scene import load_scene
from support.faulty_files import CAMPAIGN, SCENE, WHOLE, assert_complaint, changed, complaint, load_checked

VALUES = {
    "nu above 1/2": (
        ("poissons_ratio: 0.33", "poissons_ratio: 0.51"),
        "bad.yaml:2:26: scene.body.poissons_ratio: you gave 0.51; gfmd allows a number above -1 and at most 0.5",
    ),
    "nu of -1": (
        ("poissons_ratio: 0.33", "poissons_ratio: -1"),
        "bad.yaml:2:26: scene.body.poissons_ratio: you gave -1; gfmd allows a number above -1 and at most 0.5",
    ),
    "no nu": (
        ("poissons_ratio: 0.33, ", ""),
        "bad.yaml:2:3: scene.body.poissons_ratio: you gave nothing; gfmd needs a number above -1 and at most 0.5",
    ),
    "aspect ratio of 0": (
        ("aspect_ratio: .inf", "aspect_ratio: 0"),
        "bad.yaml:2:46: scene.body.aspect_ratio: you gave 0; gfmd allows from 1e-12 to 1e30, or .inf for a half-space",
    ),
    "aspect ratio too large for a float": (
        ("aspect_ratio: .inf", "aspect_ratio: 1e400"),
        "bad.yaml:2:46: scene.body.aspect_ratio: you gave '1e400'; gfmd allows from 1e-12 to 1e30, or .inf for a "
        "half-space",
    ),
    "aspect ratio of nan": (
        ("aspect_ratio: .inf", "aspect_ratio: .nan"),
        "bad.yaml:2:46: scene.body.aspect_ratio: you gave nan; gfmd allows from 1e-12 to 1e30, or .inf for a "
        "half-space",
    ),
    "Young's modulus of 0": (
        ("poissons_ratio: 0.33", "poissons_ratio: 0.33, youngs_modulus: 0"),
        "bad.yaml:2:48: scene.body.youngs_modulus: you gave 0; gfmd allows a number from 1e-30 to 1e+30",
    ),
    "H above 1": (
        ("hurst: 0.8", "hurst: 1.4"),
        "bad.yaml:5:12: scene.roughness.hurst: you gave 1.4; gfmd allows a number from 0 to 1",
    ),
    "H below 0": (
        ("hurst: 0.8", "hurst: -1/64"),
        "bad.yaml:5:12: scene.roughness.hurst: you gave -0.015625; gfmd allows a number from 0 to 1",
    ),
    "H of nan": (
        ("hurst: 0.8", "hurst: .nan"),
        "bad.yaml:5:12: scene.roughness.hurst: you gave nan; gfmd allows a number from 0 to 1",
    ),
    "rms gradient of 0": (
        ("rms_gradient: 0.01", "rms_gradient: 0"),
        "bad.yaml:6:19: scene.roughness.rms_gradient: you gave 0; gfmd allows a number from 1e-30 to 1e+30",
    ),
    "negative rms gradient": (
        ("rms_gradient: 0.01", "rms_gradient: -1e-3"),
        "bad.yaml:6:19: scene.roughness.rms_gradient: you gave -0.001; gfmd allows a number from 1e-30 to 1e+30",
    ),
    "infinite rms gradient": (
        ("rms_gradient: 0.01", "rms_gradient: .inf"),
        "bad.yaml:6:19: scene.roughness.rms_gradient: you gave inf; gfmd allows a number from 1e-30 to 1e+30",
    ),
    "negative pressure": (
        ("reduced_pressure: 0.007", "reduced_pressure: -0.007"),
        "bad.yaml:9:23: scene.loading.reduced_pressure: you gave -0.007; gfmd allows a load above 0; "
        "for no load, or a pull, prescribe a displacement",
    ),
    "decimal comma in braces": (
        ("loading:\n    reduced_pressure: 0.007", "loading: {pressure: 1,5 MPa}"),
        "bad.yaml:8:25: scene.loading['5 MPa']: you gave an unknown key; gfmd allows one of 'reduced_pressure', "
        "'pressure', 'line_load', 'force', 'displacement', 'duration', 'speed'; decimals have a point, like 1.5",
    ),
    "both loadings": (
        ("    reduced_pressure: 0.007", "    reduced_pressure: 0.007\n    displacement: 0.1"),
        "bad.yaml:9:5: scene.loading: you gave {'displacement': 0.1, 'reduced_pressure': 0.007}; "
        "gfmd allows exactly one of reduced_pressure, pressure, line_load, force and displacement",
    ),
    "no loading": (
        ("loading:\n    reduced_pressure: 0.007", "loading: {}"),
        "bad.yaml:8:12: scene.loading: you gave {}; "
        "gfmd allows exactly one of reduced_pressure, pressure, line_load, force and displacement",
    ),
    "half-space under displacement": (
        ("reduced_pressure: 0.007", "displacement: 0.1"),
        "bad.yaml:2:46: scene.body.aspect_ratio: you gave inf; gfmd allows a finite aspect_ratio, periodic false, or "
        "a pressure or another load in place of loading.displacement, as a half-space has no reference",
    ),
    "time step above the limit": (
        ("{solver: auto}", "{time_step: 1.01}"),
        "bad.yaml:10:23: numerics.time_step: you gave 1.01; gfmd allows a number from 1e-6 to 1, as more is above "
        "the stability limit",
    ),
    "residual too large": (
        ("{solver: auto}", "{residual: 1/10}"),
        "bad.yaml:10:22: numerics.residual: you gave 0.1; gfmd allows a number above 0 and at most 0.01",
    ),
    "damping too large": (
        ("{solver: auto}", "{damping: 101}"),
        "bad.yaml:10:21: numerics.damping: you gave 101; gfmd allows a number from 0 to 100",
    ),
    "negative seed": (
        ("numerics:", "seed: -1\nnumerics:"),
        "bad.yaml:10:7: seed: you gave -1; gfmd allows a whole number at least 0",
    ),
    "eps above 1": (
        ("eps_c: 1/2", "eps_c: 3/2"),
        "bad.yaml:11:25: discretisation.eps_c: you gave 1.5; gfmd allows a number above 0 and at most 1",
    ),
    "psd without discretisation": (
        ("discretisation: {eps_c: 1/2, eps_f: 1/64, eps_t: 1/2}\n", ""),
        "bad.yaml:1:1: discretisation: you gave nothing; gfmd needs a mapping like {eps_c: 0.25, "
        "eps_f: 0.01, eps_t: 0.25}, as a random surface has no points of its own",
    ),
    "k_l not whole": (
        ("eps_t: 1/2", "eps_t: 2/5"),
        f"bad.yaml:11:50: discretisation.eps_t: you gave 0.4; gfmd allows {WHOLE}eps_c = 0.5 and eps_f = 0.015625; "
        "did you mean 1/3?",
    ),
    "k_s not whole": (
        ("eps_f: 1/64", "eps_f: 0.3"),
        f"bad.yaml:11:37: discretisation.eps_f: you gave 0.3; gfmd allows {WHOLE}eps_c = 0.5 and eps_t = 0.5; "
        "did you mean 2/7?",
    ),
    "nx not whole": (
        ("eps_c: 1/2", "eps_c: 0.3333"),
        f"bad.yaml:11:25: discretisation.eps_c: you gave 0.3333; gfmd allows {WHOLE}eps_f = "
        "0.015625 and eps_t = 0.5; "
        "did you mean 1/3?",
    ),
    "nx below 4": (
        ("eps_c: 1/2, eps_f: 1/64, eps_t: 1/2", "eps_c: 1, eps_f: 1, eps_t: 1"),
        f"bad.yaml:11:25: discretisation.eps_c: you gave 1; gfmd allows {WHOLE}eps_f = 1 and eps_t = 1; did you mean "
        "1/2?",
    ),
    "overflowing nx": (
        ("eps_f: 1/64", "eps_f: 1e-320"),
        "bad.yaml:11:37: discretisation.eps_f: you gave 1e-320; gfmd allows a grid that fits in ",
    ),
}


@pytest.mark.parametrize("name", VALUES)
def test_a_wrong_value_is_refused_where_it_stands(tmp_path, name):
    change, expected = VALUES[name]
    message = assert_complaint(tmp_path, load_checked, SCENE, change, expected)
    assert message.count("\n") == expected.count("\n")


def test_verlet_is_refused_for_an_incompressible_body_under_displacement(tmp_path):
    text = changed(SCENE, "0.33, aspect_ratio: .inf", "0.5, aspect_ratio: 1")
    text = changed(changed(text, "reduced_pressure: 0.007", "displacement: 0.1"), "auto", "verlet")
    assert complaint(tmp_path, gfmd_numba.solve, text).startswith(
        "bad.yaml:10:20: numerics.solver: you gave 'verlet'; gfmd allows 'active_set_newton', 'conjugate_gradients', "
        "'truncated_newton', 'frictional_newton' or 'auto' under loading.displacement at poissons_ratio 0.5"
    )
    (tmp_path / "good.yaml").write_text(changed(text, "poissons_ratio: 0.5", "poissons_ratio: 0.499"))
    assert load_scene(tmp_path / "good.yaml")[0].scene.body.poissons_ratio == 0.499


def test_a_grid_larger_than_the_memory_is_refused(tmp_path, monkeypatch):
    class Memory:
        total = 8e9

    monkeypatch.setattr(psutil, "virtual_memory", Memory)
    text = changed(SCENE, "eps_f: 1/64", "eps_f: 1/16777216")
    assert complaint(tmp_path, load_scene, text) == (
        "bad.yaml:11:37: discretisation.eps_f: you gave 5.960464477539063e-08; gfmd allows a "
        "grid that fits in 8 GB of "
        "memory, where nx = 1.34218e+08 needs 77.3 GB"
    )
    text = changed(CAMPAIGN, "eps_c: [1, 1/2]", "eps_c: [1, 1/2, 1/262144]")
    assert complaint(tmp_path, load_campaign, text).startswith("bad.yaml:10:26: limits.eps_c[2]: you gave 3.8146")
