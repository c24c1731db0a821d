"""Campaigns of several measured punches, each pressed on the same rough body or between two elastic bodies."""

import json

import numpy as np
import pytest
import yaml

import gfmd_numba
from gfmd_numba.campaign.plan import plan
from gfmd_numba.scene import InputError
from support.command_line import gfmd
from support.realisations import assert_as_solved

# profiles of a few waves are wavy by what they are
pytestmark = [pytest.mark.filterwarnings("ignore:.*waves longer than two fifths"), pytest.mark.usefixtures("undrawn")]
X = np.arange(64) / 64
SHORT = 1e-3 * np.cos(2 * np.pi * X) + 2e-4 * np.cos(2 * np.pi * 7 * X)
LONG = 1e-3 * np.sin(2 * np.pi * 2 * X) + 3e-4 * np.cos(2 * np.pi * 5 * X)
RANDOM = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02, "points": 64, "roll_off": 0.5, "cut_on": 1 / 8}
MEASURED = {"method": "measured", "units": {"z": "L_x"}}
SLAB = {"poissons_ratio": 0.33, "aspect_ratio": 0.5}
WALL = {"interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.05}}
FILES = {"file": ["short.npy", "long.npy"]}


@pytest.fixture
def folder(tmp_path):
    np.save(tmp_path / "short.npy", SHORT)
    np.save(tmp_path / "long.npy", LONG)
    np.save(tmp_path / "body.npy", 0.5 * np.roll(LONG, 9))
    waves = 2e-4 * np.cos(2 * np.pi * 3 * (X[:32] + X[:32, np.newaxis]) * 2)
    for name, heights in (("short", SHORT), ("long", LONG), ("body", 0.5 * LONG)):
        np.save(tmp_path / f"{name}_map.npy", heights[::2] * np.cos(2 * np.pi * X[::2, np.newaxis]) + waves)
    for name, heights, length in (("near", SHORT, 1e-3), ("far", LONG, 2e-3)):
        columns = np.column_stack([X * length, heights * length])
        np.savetxt(tmp_path / f"{name}.csv", columns, header="x/m, z/m", delimiter=",")
    return tmp_path


def written(folder, scene, grid=FILES, **more):
    random = any("hurst" in str(surface) for surface in scene.values())
    seeded = {"seed": 4, "realisations": 2} if random else {}
    path = folder / "files.yaml"
    campaign = {"name": "files", "scene": scene, "grid": grid} | seeded | more
    path.write_text(yaml.safe_dump(json.loads(json.dumps(campaign))))  # without aliases
    return path


def at_home(folder, scene, **punch):
    """The scene with whole paths, and one of the punches."""
    found = json.loads(json.dumps(scene))
    found["roughness"] |= punch
    for surface in (found["roughness"], found["body"].get("roughness") or {}):
        if "file" in surface:
            surface["file"] = str(folder / surface["file"])
    return found


SCENES = {
    "random body": (WALL | {"body": SLAB | {"roughness": RANDOM}, "roughness": MEASURED}, 1, 4),
    "measured body": (
        WALL | {"body": SLAB | {"roughness": MEASURED | {"file": "body.npy"}}, "roughness": MEASURED},
        0,
        None,
    ),
}


@pytest.mark.long
@pytest.mark.parametrize("name", ["random body", "measured body"])
def test_each_punch_of_a_grid_has_the_numbers_of_solve(folder, name):
    scene, realisation, seed = SCENES[name]
    found = gfmd_numba.run(written(folder, scene), folder / "out", workers=0)
    assert (found["status"] == 0).all()
    assert list(found["file"].values) == FILES["file"]
    assert float(abs(found["kappa"][0] - found["kappa"][1]).min()) > 1e-3
    for case, file in enumerate(FILES["file"]):
        assert_as_solved(found, case, realisation, at_home(folder, scene, file=file), {}, seed)


@pytest.mark.long
def test_punches_of_a_grid_may_be_maps_that_rub(folder):
    files = {"file": ["short_map.npy", "long_map.npy"]}
    interface = {"hard_wall": {}, "friction": {"coefficient": 0.3}}
    body = SLAB | {"roughness": MEASURED | {"file": "body_map.npy"}}
    scene = WALL | {"body": body, "roughness": MEASURED, "interface": interface}
    found = gfmd_numba.run(written(folder, scene, files), folder / "out", workers=0)
    assert (found["status"] == 0).all()
    assert (found["dimension"] == 2).all()
    for case, file in enumerate(files["file"]):
        assert_as_solved(found, case, 0, at_home(folder, scene, file=file), {}, None)


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:.*waves as long as the cutoff")
def test_how_a_punch_is_treated_is_varied_too(folder):
    scene = WALL | {"body": SLAB | {"roughness": RANDOM}, "roughness": MEASURED | {"file": "short.npy"}}
    grid = {"cutoff": [0.2, 0.4]}
    found = gfmd_numba.run(written(folder, scene, grid, realisations=1), folder / "out", workers=0)
    assert (found["status"] == 0).all()
    for case, value in enumerate(grid["cutoff"]):
        assert_as_solved(found, case, 0, at_home(folder, scene, cutoff=value), {})
    assert f"roughness (cutoff {grid['cutoff'][1]}): " in found.attrs["processing"]


def test_each_punch_tells_its_own_period(folder):
    body = SLAB | {"roughness": RANDOM | {"roll_off": "0.5 mm", "cut_on": "0.125 mm"}}
    scene = WALL | {"body": body, "roughness": {"method": "measured"}}
    cases = plan(written(folder, scene, {"file": ["near.csv", "far.csv"]})).cases
    assert [case.scene.length for case in cases] == pytest.approx([1e-3, 2e-3], rel=1e-6)
    again = plan(written(folder, scene, {"file": ["far.csv"]})).cases
    assert again[0].problem.identity == cases[1].problem.identity


@pytest.mark.parametrize(
    ("grid", "said"),
    [
        ({"file": ["short.npy", "short_map.npy"]}, r"grid.file\[1\]: you gave "),
        ({"file": ["short.npy", "none.npy"]}, r"grid.file\[1\]: you gave "),
        (
            {"file": ["short.npy"], "points": [64, 32]},
            r"grid.points\[1\]: you gave 32 heights; gfmd allows as many heights",
        ),
        ({"file": ["short.npy", "near.csv"]}, r"grid.file\[1\]: you gave near.csv"),
    ],
)
def test_a_punch_of_a_grid_that_does_not_fit_is_said_with_its_place(folder, grid, said):
    with pytest.raises(InputError, match=r"files.yaml:\d+:\d+: " + said):
        plan(written(folder, SCENES["measured body"][0], grid))


@pytest.mark.long
def test_a_campaign_of_punches_on_rough_bodies_is_planned_and_run_by_its_commands(folder):
    path = written(folder, SCENES["measured body"][0])
    for command in (("check", path), ("plan", path), ("run", path, "-o", folder / "out", "--workers", "0")):
        done = gfmd(*command)
        assert done.exit_code == 0, done.output
