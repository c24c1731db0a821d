"""Boundaries that are over-determined, out of balance or unreadable: what is said about them, and where."""

import numpy as np
import pytest

import gfmd_numba
from support.faulty_files import SCENE, changed, complaint

LOADED = """\
scene:
  body: {poissons_ratio: 0.3, aspect_ratio: 0.5}
  boundary:
    normal_traction: pull.csv
    tangential_displacement: held.npy
"""
PRESSED = SCENE.replace("numerics:", "  boundary:\n    normal_traction: wave.csv\nnumerics:").replace("1/64", "1/2")
VALUES = (
    "a number up to 1e30 in size or a pressure in Pa, kPa, MPa, GPa or the like, for every node, "
    "or the name of a .npy or .csv file with one value for each node"
)
BEFORE = "bad.yaml:4:22: scene.boundary.normal_traction: you gave "
LOADS = {
    "nothing prescribed": (
        ("boundary:\n    normal_traction: pull.csv\n    tangential_displacement: held.npy", "boundary: {}"),
        "bad.yaml:3:13: scene.boundary: you gave {}; gfmd allows at least one of normal_traction, "
        "tangential_traction, ",
    ),
    "no grid": (
        ("normal_traction: pull.csv\n    tangential_displacement: held.npy", "normal_traction: 0.1"),
        "bad.yaml:1:1: points: you gave nothing; gfmd needs the number of nodes, as no file of the boundary gives it",
    ),
    "unknown key": (
        ("normal_traction", "normal_tracton"),
        "bad.yaml:4:5: scene.boundary.normal_tracton: you gave an unknown key; gfmd allows one of 'normal_traction', "
        "'tangential_traction', 'normal_displacement', 'tangential_displacement', 'tangential_traction_y', "
        "'tangential_displacement_y'; did you mean 'normal_traction'?",
    ),
    "list": (("pull.csv", "[0.1, 0.2]"), f"{BEFORE}[0.1, 0.2]; gfmd allows {VALUES}"),
    "infinite traction": (("pull.csv", ".inf"), f"{BEFORE}inf; gfmd allows {VALUES}"),
    "boolean": (("pull.csv", "true"), f"{BEFORE}true; gfmd allows {VALUES}"),
    "quoted number": (("pull.csv", "'0.1'"), f"{BEFORE}'0.1'; gfmd allows {VALUES}; did you mean 0.1 without quotes?"),
    "file of another kind": (("pull.csv", "pull.nc"), f"{BEFORE}'pull.nc'; gfmd allows {VALUES}"),
    "no such file": (("pull.csv", "pul.csv"), f"{BEFORE}'pul.csv'; gfmd allows an existing file, unlike pul.csv; did"),
    "text in a file": (("pull.csv", "words.csv"), f"{BEFORE}words.csv (no row of numbers, but 'one')"),
    "infinity in a file": (
        ("pull.csv", "endless.csv"),
        f"{BEFORE}endless.csv (inf at index 3); gfmd allows finite numbers of at most 1e+30, and not-a-number "
        "where nothing is prescribed",
    ),
    "nothing in a file": (
        ("pull.csv", "nothing.csv"),
        f"{BEFORE}nothing.csv (no number); gfmd allows a number for at least one node",
    ),
    "two columns": (
        ("pull.csv", "table.csv"),
        f"{BEFORE}table.csv (an array of shape (16, 2) and type float64, not one row of numbers)",
    ),
    "grids that differ": (
        ("pull.csv", "long.csv"),
        "bad.yaml:5:30: scene.boundary.tangential_displacement: you gave held.npy (16 values); gfmd allows one value "
        "for "
        "each of the 20 nodes",
    ),
    "a grid unlike the points": (
        ("scene:", "points: 12\nscene:"),
        "bad.yaml:5:22: scene.boundary.normal_traction: you gave pull.csv (16 values); gfmd allows one value for "
        "each of "
        "the 12 nodes",
    ),
    "both at every node": (
        ("pull.csv", "0.2\n    normal_displacement: 0"),
        f"{BEFORE}0.2 at node 0; gfmd allows a file with not-a-number at the nodes whose normal_displacement is "
        "prescribed, of which this is one",
    ),
    "both at one node": (
        ("pull.csv", "pull.csv\n    tangential_traction: pull.csv"),
        "bad.yaml:5:26: scene.boundary.tangential_traction: you gave 3 at node 3; gfmd allows a file with "
        "not-a-number at "
        "the nodes whose tangential_displacement is prescribed, of which this is one",
    ),
    "half-space out of balance": (
        ("0.5}", ".inf}"),
        f"{BEFORE}a mean of 7.5; gfmd allows a mean of 0, or a finite aspect_ratio or a normal_displacement, as "
        "nothing "
        "holds a half-space",
    ),
    "incompressible slab without a free node": (
        (
            "0.3, aspect_ratio: 0.5}\n  boundary:\n    normal_traction: pull.csv",
            "0.5, aspect_ratio: 0.5}\n  boundary:\n    normal_displacement: 0.1",
        ),
        "bad.yaml:4:26: scene.boundary.normal_displacement: you gave 0.1; gfmd allows not-a-number for at least one "
        "node of "
        "an incompressible slab, whose pressure no displacement tells",
    ),
    "solver of one component": (
        ("scene:", "numerics: {solver: fire}\nscene:"),
        "bad.yaml:1:20: numerics.solver: you gave 'fire'; gfmd allows 'verlet' or 'auto', the solver of both "
        "displacements",
    ),
    "a path without a punch": (
        ("scene:", "path: [{displacement: 0.1}]\nscene:"),
        "bad.yaml:1:7: path: you gave [{'displacement': 0.1}]; gfmd allows nothing without a punch",
    ),
    "a window without a punch": (
        ("0.5}", "0.5}\n  periodic: false"),
        "bad.yaml:3:13: scene.periodic: you gave false; gfmd allows true without a punch: ",
    ),
    "a counter body without a loading": (
        ("0.5}", "0.5}\n  counter_body: {poissons_ratio: 0.3}"),
        "bad.yaml:1:1: scene.interface: you gave nothing; gfmd needs ",
    ),
    "a loading without a punch": (
        ("scene:", "scene:\n  loading: {reduced_pressure: 0.1}"),
        "bad.yaml:1:1: scene.interface: you gave nothing; gfmd needs ",
    ),
}
FAULTS_UNDER_A_PUNCH = {
    "mean pressure and mean traction": (
        ("wave.csv", "0.01"),
        "bad.yaml:11:22: scene.boundary.normal_traction: you gave a mean of 0.01; gfmd allows a mean of 0, as "
        "loading.reduced_pressure prescribes the mean pressure",
    ),
    "half-space out of balance": (
        ("wave.csv", "wave.csv\n    tangential_traction: 0.01"),
        "bad.yaml:12:26: scene.boundary.tangential_traction: you gave a mean of 0.01; gfmd allows a mean of 0, or a "
        "finite "
        "aspect_ratio, as nothing holds a half-space",
    ),
    "another grid": (
        ("wave.csv", "long.csv"),
        "bad.yaml:11:22: scene.boundary.normal_traction: you gave long.csv (20 values); gfmd allows one value for "
        "each of "
        "the 16 nodes",
    ),
    "points under a punch": (
        ("scene:", "points: 16\nscene:"),
        "bad.yaml:1:9: points: you gave 16; gfmd allows nothing here, as the surfaces have a grid of their own",
    ),
    "displacements under a punch": (
        ("wave.csv", "wave.csv\n    tangential_displacement: 0"),
        "bad.yaml:12:30: scene.boundary.tangential_displacement: you gave 0; gfmd allows only tractions with a "
        "punch, as "
        "the punch prescribes displacements (to make it stick: friction with coefficient .inf); ",
    ),
}


@pytest.fixture
def folder(tmp_path):
    x, held = np.arange(16), np.full(16, np.nan)
    held[3:6] = 0.1
    np.save(tmp_path / "held.npy", held)
    columns = {
        "pull": x,
        "wave": np.cos(np.pi * x / 8),
        "nothing": np.nan * x,
        "long": np.cos(np.pi * np.arange(20) / 10),
    }
    for name, values in columns.items():
        np.savetxt(tmp_path / f"{name}.csv", values)
    np.savetxt(tmp_path / "table.csv", np.ones((16, 2)), delimiter=",")
    np.savetxt(tmp_path / "endless.csv", np.where(x == 3, np.inf, x))
    (tmp_path / "words.csv").write_text("one\ntwo\nthree\nfour\n")
    return tmp_path


@pytest.mark.parametrize("name", LOADS)
def test_a_bad_load_on_a_body_is_refused_where_it_stands(folder, name):
    change, expected = LOADS[name]
    assert complaint(folder, gfmd_numba.solve, changed(LOADED, *change)).startswith(expected)


@pytest.mark.parametrize("name", FAULTS_UNDER_A_PUNCH)
def test_a_bad_boundary_under_a_punch_is_refused_where_it_stands(folder, name):
    change, expected = FAULTS_UNDER_A_PUNCH[name]
    assert complaint(folder, gfmd_numba.solve, changed(PRESSED, *change)).startswith(expected)


@pytest.mark.filterwarnings("ignore:the grid has too few nodes")
@pytest.mark.parametrize("text", [LOADED, PRESSED])
def test_what_the_bad_ones_were_made_from_is_good(folder, text):
    path = folder / "good.yaml"
    path.write_text(text)
    assert int(gfmd_numba.solve(path)["status"]) == 0
