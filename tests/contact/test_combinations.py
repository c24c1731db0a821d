"""What does not go together is refused in one place, before anything is computed, and a knob without effect with it."""

import subprocess
import sys
from itertools import product

import numpy as np
import pytest
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.cli import main
from gfmd_numba.contact.combinations import REFUSALS
from gfmd_numba.scene.interface_records import LAWS
from gfmd_numba.solvers.table import able
from support.faulty_files import CAMPAIGN, SCENE, changed, complaint

FRICTION = ("{hard_wall: {}}", "{hard_wall: {}, friction: {coefficient: 0.3}}")
SCENES = {
    "time step of a solver without one": (
        ("{solver: auto}", "{time_step: 0.5}"),
        "bad.yaml:10:23: numerics.time_step: you gave 0.5; gfmd allows nothing with solver active_set_newton, which "
        "has no "
        "time_step; these have one: verlet, gronbech_jensen, fire",
    ),
    "damping of a solver without one": (
        ("{solver: auto}", "{solver: fire, damping: 0.5}"),
        "bad.yaml:10:35: numerics.damping: you gave 0.5; gfmd allows nothing with solver fire, which has no damping; "
        "these",
    ),
    "order of no topography": (
        ("{solver: auto}", "{topography_order: 2}"),
        "bad.yaml:10:30: numerics.topography_order: you gave 2; gfmd allows nothing where no deformable body is rough",
    ),
    "solver of one displacement": (
        (
            FRICTION[0] + "\n  loading:\n    reduced_pressure: 0.007\nnumerics: {solver: auto",
            FRICTION[1] + "\n  loading:\n    reduced_pressure: 0.007\nnumerics: {solver: fire",
        ),
        "bad.yaml:10:20: numerics.solver: you gave 'fire'; gfmd allows 'frictional_newton', 'verlet' or 'auto', "
        "which follow both displacements",
    ),
    "anisotropy of a profile": (
        ("rms_gradient: 0.01", "rms_gradient: 0.01\n    anisotropy: 2"),
        "bad.yaml:7:17: scene.roughness.anisotropy: you gave 2; gfmd allows nothing with dimension 1",
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_is_refused_by_check_and_by_solve_alike(tmp_path, name):
    change, expected = SCENES[name]
    said = complaint(tmp_path, gfmd_numba.solve, changed(SCENE, *change))
    assert said.startswith(expected)
    done = CliRunner().invoke(main, ["check", str(tmp_path / "bad.yaml")])
    assert done.exit_code == 2
    assert said in done.stderr.replace(f"{tmp_path}/", "")


@pytest.mark.filterwarnings("ignore:the grid has too few nodes")
def test_the_options_of_the_solver_that_is_named_are_accepted(tmp_path):
    named = "{solver: verlet, time_step: 0.5, damping: 1, residual: 1e-3}"
    text = changed(changed(SCENE, *FRICTION), "{solver: auto}", named)
    (tmp_path / "good.yaml").write_text(changed(text, "1/64", "1/4"))
    assert int(gfmd_numba.solve(tmp_path / "good.yaml")["status"]) == 0


def test_every_fault_is_told_on_a_line_of_its_own(tmp_path):
    text = changed(changed(SCENE, *FRICTION), "{solver: auto}", "{topography_order: 1, solver: fire}")
    said = complaint(tmp_path, gfmd_numba.solve, text).splitlines()
    assert [line.split(": ")[1] for line in said] == ["numerics.topography_order", "numerics.solver"]


def test_an_incompressible_value_of_a_grid_is_refused_to_a_solver_without_a_rigid_mean(tmp_path):
    laws = "{hard_wall: {}, exponential: {work_of_adhesion: 1e-6, range: 0.1}, friction: {coefficient: 0.1}}"
    text = changed(CAMPAIGN, "{hard_wall: {}}", laws)
    text = changed(text, "{reduced_pressure: 0.007}", "{displacement: 0.1}")
    text = changed(text, "grid: {hurst: [0.3, 0.5]}", "grid: {poissons_ratio: [0.3, 1/2]}")
    (tmp_path / "good.yaml").write_text(text)
    load_campaign(tmp_path / "good.yaml")
    said = complaint(tmp_path, load_campaign, changed(text, "{solver: auto}", "{solver: verlet}"))
    assert "grid.poissons_ratio[1]: you gave 0.5; gfmd allows a number below 0.5 with solver verlet" in said


def test_a_hardness_of_a_grid_alone_is_refused_what_one_of_the_scene_is(tmp_path):
    text = changed(changed(CAMPAIGN, *FRICTION), "grid: {hurst: [0.3, 0.5]}", "grid: {hardness: [0.1, 0.2]}")
    assert "gfmd allows a hard_wall without hardness, as" in complaint(tmp_path, load_campaign, text)


def test_what_is_not_refused_has_a_solver():
    laws = (["hard_wall"], ["exponential"], ["hard_wall", "exponential"], ["cohesive"], ["hard_wall", "friction"])
    others = product(("dimension 1", "dimension 2"), laws, ([], ["rigid mean"]))
    for dimension, interface, mean in others:
        found = {dimension, *interface, *mean}
        refused = any({row.present, row.refused} <= found for row in REFUSALS)
        needs = {dimension, *mean, *(LAWS[law].ability for law in interface)}
        assert refused or able(needs), needs


def test_the_tables_compile_nothing():
    code = "import sys, gfmd_numba.contact.refusal; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numpy", "numba", "dask", "scipy", "xarray"} & set(done.stdout.split())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"dimension": 1}, "1 but for maps under a punch"),
        ({"interface": {"hard_wall": {"hardness": 0.5}}}, "as others are solved by one thread"),
        ({"interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}}}, "with solver frictional_newton"),
    ],
)
def test_threads_that_have_nothing_to_share_are_refused(monkeypatch, change, said):
    monkeypatch.setattr("gfmd_numba.arrays.threads._FEWEST", 0)
    scene = {
        "dimension": 2,
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 1},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05},
    }
    file = {"scene": scene, "discretisation": {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1.0}}
    together = gfmd_numba.solve({**file, "numerics": {"threads": 2}})
    np.testing.assert_array_equal(together["pressure"], gfmd_numba.solve(file)["pressure"])
    with pytest.raises(gfmd_numba.InputError, match=said):
        gfmd_numba.solve({**file, "scene": scene | change, "numerics": {"threads": 2}})
