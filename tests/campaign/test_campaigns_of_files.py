"""Several measured files as an axis of a campaign: each is a surface, known by the name that the user wrote."""

import json

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.analysis import plot_campaign
from gfmd_numba.campaign.coordinates import meeting
from gfmd_numba.campaign.plan import plan
from gfmd_numba.cli import main
from gfmd_numba.roughness import surface_files
from gfmd_numba.scene import InputError

pytestmark = pytest.mark.usefixtures("undrawn")

FILES = {"data/a.csv": (64, 1.0), "data/b.csv": (96, 2.0), "data/c_1$.csv": (80, 1.5)}  # points, and mm
SCENE = {
    "body": {"youngs_modulus": 7e10, "poissons_ratio": 0.3},
    "interface": {"hard_wall": {}},
    "loading": {"pressure": 5e7},
    "roughness": {"method": "measured", "detrend": "mean"},
}
PRESSURES = [5e7, 1e8]


@pytest.fixture
def folder(tmp_path):
    return filled(tmp_path)


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A folder with the campaign and, below `out`, its results."""
    folder = filled(tmp_path_factory.mktemp("ran"))
    gfmd_numba.run(folder / "steel.yaml", folder / "out")
    return folder


def filled(folder):
    (folder / "data").mkdir()
    for seed, (name, (points, size)) in enumerate(FILES.items()):
        save(folder / name, points, size, seed)
    write(folder)
    return folder


def save(path, points, size, seed):
    """Write a profile of some mm, of waves in um."""
    random, x = np.random.default_rng(seed), np.arange(points) / points
    waves = [random.normal() * np.cos(2 * np.pi * (k * x + random.uniform())) / k**1.5 for k in range(1, 16)]
    np.savetxt(path, np.column_stack([size * x, 3 * sum(waves)]), delimiter=",", header="x [mm],z [um]")


def write(folder, files=tuple(FILES), **changes):
    campaign = {"name": "steel", "scene": SCENE, "grid": {"file": list(files), "pressure": PRESSURES}} | changes
    (folder / "steel.yaml").write_text(yaml.safe_dump(campaign))
    return folder / "steel.yaml"


def gfmd(*words):
    done = CliRunner().invoke(main, [str(word) for word in words])
    assert done.exit_code == 0, done.output
    return done.output


def test_each_file_is_the_contact_that_solve_finds(ran):
    found = gfmd_numba.open_campaign(ran / "out")
    assert found["file"].values.tolist() == [name for name in FILES for _ in PRESSURES]
    for case in (0, 3, 4):  # one of each file
        name = str(found["file"].values[case])
        scene = SCENE | {"roughness": SCENE["roughness"] | {"file": str(ran / name)}}
        one = gfmd_numba.solve(scene | {"loading": {"pressure": float(found["prescribed_pressure"][case])}})
        for variable in ("kappa", "mean_gap"):
            assert float(found[variable][case, 0]) == pytest.approx(float(one[variable]), rel=1e-12)
        assert one.sizes["x"] == int(found["nx"][case]) == FILES[name][0]
    assert found["mean_gap"].attrs["units"] == "m"


def test_results_hold_the_names_and_numbers_that_stand_for_them(ran):
    found = gfmd_numba.open_campaign(ran / "out")
    index = found["file_index"]
    assert index.attrs["axis"] == "physics"
    assert json.loads(index.attrs["names"]) == list(FILES)
    assert [list(FILES)[i] for i in index.values] == found["file"].values.tolist()
    of_b = found.where(found["file"] == "data/b.csv", drop=True)
    assert of_b["prescribed_pressure"].values.tolist() == PRESSURES
    told = [found.attrs, *(each.attrs for each in found.variables.values()), *(each.values for each in found.values())]
    assert str(ran) not in str(told)
    assert found.attrs["processing"].count("data/b.csv: subtracted the mean") == 1


@pytest.mark.long
def test_a_worker_and_a_second_run_change_nothing(folder, pickled, monkeypatch, tmp_path_factory):
    alone = gfmd_numba.run(folder / "steel.yaml", folder / "alone")
    gfmd("run", folder / "steel.yaml", "--workers", 0, "--limit", 2, "-o", folder / "out")
    assert gfmd("status", folder / "out") == "steel: 2 of 6 blocks done; not running\n"
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    gfmd("run", folder / "out" / "campaign.yaml", "--workers", 0, "-o", folder / "out")
    assert gfmd("status", folder / "out") == "steel: 6 of 6 blocks done; finished\n"
    gfmd("verify", folder / "out")
    assert gfmd_numba.open_campaign(folder / "out").attrs["content_sha256"] == alone.attrs["content_sha256"]


def test_a_changed_file_changes_its_own_problems_alone(folder):
    before = [case.problem.identity for case in plan(folder / "steel.yaml").cases]
    save(folder / "data/b.csv", 96, 2.0, seed=9)
    after = [case.problem.identity for case in plan(folder / "steel.yaml").cases]
    assert [old == new for old, new in zip(before, after, strict=True)] == [True, True, False, False, True, True]


@pytest.mark.long
def test_a_mapping_names_files_in_the_current_folder(folder, monkeypatch):
    from_file = [case.problem.identity for case in plan(folder / "steel.yaml").cases]
    monkeypatch.chdir(folder)
    found = gfmd_numba.run({"name": "mapped", "scene": SCENE, "grid": {"file": list(FILES), "pressure": PRESSURES}})
    assert found["case_id"].values.tolist() == from_file
    monkeypatch.chdir(folder.parent)
    assert gfmd("status", folder / "mapped") == "mapped: 6 of 6 blocks done; finished\n"


@pytest.mark.long
def test_the_terminal_and_the_figures_name_the_files(folder):
    said = gfmd("run", folder / "steel.yaml", "--workers", 0, "-o", folder / "out")
    assert all(said.count(name) == 2 for name in FILES)
    found = gfmd_numba.open_campaign(folder / "out")
    figure = plot_campaign(found)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        "data/a.csv",
        "data/b.csv",
        r"data/c_1\$.csv",
    ]
    figure.draw_without_rendering()
    panel = plot_campaign(found.isel(case=[0, 2, 4])).axes[0]
    assert [label.get_text() for label in panel.get_xticklabels()] == ["data/a.csv", "data/b.csv", r"data/c_1\$.csv"]
    for command in ("fit", "plot"):
        gfmd(command, folder / "out")


@pytest.mark.long
def test_cases_of_one_file_are_run_alone(folder):
    gfmd("run", folder / "steel.yaml", "--workers", 0, "-o", folder / "out", "--only", "file=data/b.csv")
    found = gfmd_numba.open_campaign(folder / "out")
    assert set(found["file"].values[(found["status"] == 0).values[:, 0]]) == {"data/b.csv"}
    with pytest.raises(InputError, match=r"--only: you gave file=b.csv; gfmd allows .*data/a.csv, data/b.csv"):
        meeting(plan(folder / "steel.yaml").cases, {"file": "b.csv"})


@pytest.mark.parametrize("command", ["check", "plan", "run"])
def test_a_missing_file_is_told_where_it_stands(folder, command):
    write(folder, ["data/a.csv", "data/bb.csv"])
    done = CliRunner().invoke(main, [command, str(folder / "steel.yaml")])
    assert done.exit_code == 2
    assert "grid.file[1]: you gave 'data/bb.csv'; gfmd allows an existing file, unlike" in " ".join(done.output.split())


@pytest.mark.parametrize(
    ("files", "said"),
    [
        (
            "data/a.csv",
            r"^[^:]*:[0-9]+:[0-9]+: grid.file: you gave 'data/a.csv'; gfmd allows a list of one or more file names",
        ),
        ([], r"grid.file: you gave \[\]; gfmd allows a list of one or more file names"),
        (["data/a.csv", 3], r"grid.file\[1\]: you gave 3; gfmd allows a file name"),
        ([""], r"grid.file\[0\]: you gave ''; gfmd allows a file name"),
        (["data/a.csv", "data/a.csv"], r"grid.file\[1\]: you gave .data/a.csv.; gfmd allows each value once"),
        (["data/a.csv", "words.csv"], r"grid.file\[1\]: you gave words.csv \(.*gfmd allows a table of equidistant"),
        (["data/a.csv", "flat.csv"], r"grid.file\[1\]: you gave flat.csv \(a flat surface"),
        (
            ["data/a.csv", "reduced.csv"],
            r"grid.file\[1\]: you gave reduced.csv \(.*in L_x\); .* in m, as a.csv has them",
        ),
    ],
)
def test_a_file_that_cannot_be_used_is_told_where_it_stands(folder, files, said):
    np.savetxt(folder / "flat.csv", np.column_stack([np.arange(8), np.ones(8)]), delimiter=",", header="x [mm],z [um]")
    (folder / "words.csv").write_text("no numbers\n")
    rows = np.column_stack([np.arange(8) / 8, np.sin(np.arange(8))])
    np.savetxt(folder / "reduced.csv", rows, delimiter=",", header="x [L_x],z [L_x]")
    with pytest.raises(InputError, match=said):
        plan(write(folder, grid={"file": files}))


def test_files_of_a_random_surface_are_refused(folder):
    scene = SCENE | {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1}}
    random = {"seed": 1, "realisations": 1, "reference": {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1}}
    with pytest.raises(
        InputError, match=r"grid.file: you gave .*; gfmd allows nothing, as scene.roughness with model self_"
    ):
        plan(write(folder, scene=scene, **random))


def test_a_line_load_needs_files_of_one_period(folder):
    scene = SCENE | {"loading": {"line_load": 1e4}, "length": 1e-3}
    with pytest.raises(
        InputError, match=r"grid.file\[1\]: you gave b.csv \(positions over a period of 0.002 m.*not length"
    ):
        plan(write(folder, scene=scene, grid={"file": list(FILES)}))


@pytest.mark.long
def test_profiles_and_maps_stand_in_one_campaign(folder):
    surface = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05, "points": 16, "cut_on": 1 / 4, "roll_off": 1 / 2}
    for dimension in (1, 2):
        made = gfmd_numba.make_surface({"surface": surface, "dimension": dimension})
        np.save(folder / f"{dimension}.npy", made["height"])
    scene = SCENE | {"body": {"poissons_ratio": 0.3}, "loading": {"reduced_pressure": 0.05}}
    found = gfmd_numba.run(write(folder, scene=scene, grid={"file": ["1.npy", "2.npy"]}), folder / "out")
    assert found["dimension"].values.tolist() == [1, 2]
    for case in range(2):
        one = gfmd_numba.solve(scene | {"roughness": SCENE["roughness"] | {"file": str(folder / f"{case + 1}.npy")}})
        assert float(one["kappa"]) == pytest.approx(float(found["kappa"][case, 0]), rel=1e-12)


def test_long_names_are_told_by_their_ends_within_eighty_columns(folder):
    deep = folder / "measurements-of-the-second-series-of-march" / "polished-and-worn"
    deep.mkdir(parents=True)
    for i in range(2):
        save(deep / f"{i}.csv", 64, 1.0, i)
    files = [str((deep / f"{i}.csv").relative_to(folder)) for i in range(2)]
    said = gfmd("run", write(folder, files), "--workers", 0, "-o", folder / "out")
    assert all(len(line) <= 80 for line in said.splitlines() if not line.startswith("results"))
    assert said.count("...") == 4
    assert "worn/0.csv" in said


TREATED = {"file": ["data/a.csv", "data/b.csv"], "cutoff": [5e-5, 1e-4], "points": [128, 200]}


@pytest.mark.long
def test_cutoff_and_points_are_axes_of_a_measured_surface(folder):
    found = gfmd_numba.run(write(folder, grid=TREATED), folder / "out")
    assert found["cutoff"].attrs["units"] == "m"
    assert found["kappa"].sizes["case"] == len(np.unique(found["case_id"])) == 8
    for case in range(8):
        values = {name: found[name].values[case].item() for name in TREATED}
        treated = SCENE["roughness"] | values | {"file": str(folder / values["file"])}
        one = gfmd_numba.solve(SCENE | {"roughness": treated})
        assert one.sizes["x"] == values["points"] == int(found["nx"][case])
        assert float(found["kappa"][case, 0]) == pytest.approx(float(one["kappa"]), rel=1e-12)
    assert "data/b.csv, cutoff 0.0001, points 200: resampled from" in found.attrs["processing"]


def test_a_file_is_read_once_however_many_surfaces_are_made_of_it(folder, monkeypatch):
    read = []
    whole = surface_files.read_table
    monkeypatch.setattr(surface_files, "read_table", lambda path: read.append(path.name) or whole(path))
    assert len(plan(write(folder, grid=TREATED)).problems) == 8
    assert read == ["a.csv", "b.csv"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            {"cutoff": [5e-5, 5e-3]},
            r"grid.file\[0\]: you gave a.csv \(no wave as long as cutoff = 0.005 in the period",
        ),
        ({"cutoff": [5e-8]}, r"grid.file\[0\]: you gave a.csv \(no wave shorter than cutoff = 5e-08"),
        ({"cutoff": [0.0]}, r"grid.cutoff\[0\]: you gave 0.0; gfmd allows a number from 1e-30"),
        ({"points": [128, 3]}, r"grid.points\[1\]: you gave 3; gfmd allows a whole number from 4"),
        ({"points": [128.0]}, r"grid.points\[0\]: you gave 128.0; gfmd allows a whole number from 4"),
        (
            {"points": [128, 2**36]},
            r"grid.points\[1\]: you gave 68719476736; gfmd allows a grid that fits in .* GB of memory",
        ),
        ({"file": ["data/a.csv", "words.csv"]}, r"grid.file\[1\]: you gave words.csv \("),
    ],
)
def test_a_value_of_the_treatment_that_makes_no_surface_is_told_with_its_file(folder, change, said):
    (folder / "words.csv").write_text("no numbers\n")
    with pytest.raises(InputError, match=said):
        plan(write(folder, grid=TREATED | change))


def test_a_map_too_large_for_the_memory_is_refused_before_it_is_made(folder):
    np.save(folder / "map.npy", np.random.default_rng(0).normal(size=(8, 8)))
    scene = SCENE | {"body": {"poissons_ratio": 0.3}, "loading": {"reduced_pressure": 0.05}}
    with pytest.raises(
        InputError,
        match=r"grid.file\[0\]: you gave map.npy \(1000000 x 1000000 points after resampling, not",
    ):
        plan(write(folder, scene=scene, grid={"file": ["map.npy"], "points": [16, 1_000_000]}))


def test_lengths_of_a_grid_have_units_where_the_file_tells_the_period(folder):
    in_um = plan(write(folder, grid=TREATED | {"cutoff": ["50 um", "0.1 mm"]}))
    assert [case.problem.identity for case in in_um.cases] == [
        case.problem.identity for case in plan(write(folder, grid=TREATED)).cases
    ]
    np.save(folder / "reduced.npy", np.sin(np.arange(64)) / 100)
    scene = SCENE | {"body": {"poissons_ratio": 0.3}, "loading": {"reduced_pressure": 0.05}}
    with pytest.raises(
        InputError, match=r"grid.cutoff\[1\]: you gave '0.1 mm'; gfmd allows a number without a unit, as there"
    ):
        plan(write(folder, scene=scene, grid={"file": ["reduced.npy"], "cutoff": [0.1, "0.1 mm"]}))
