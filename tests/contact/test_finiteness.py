"""Nothing that is not finite is ever ok: extreme values are refused where they stand, results are looked at last."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.run import run
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.contact import boundary_values, solution
from gfmd_numba.contact.evaluation import finite_status
from gfmd_numba.scene import InputError, load_scene
from gfmd_numba.solvers.status import Status
from support.campaigns import campaign
from support.faulty_files import CAMPAIGN, complaint

SCENE = """\
length: 1e-4
body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: 1}
roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
interface: {hard_wall: {}}
loading: {reduced_pressure: 0.05}
discretisation: {eps_c: 1/4, eps_f: 1/8, eps_t: 1}
"""
KEYS = ["rms_gradient: 0.01", "reduced_pressure: 0.05", "length: 1e-4", "youngs_modulus: 70e9"]
EXTREME = ["1e300", "1e-300", "1.7e308", "5e-324"]


@pytest.mark.parametrize("value", EXTREME)
@pytest.mark.parametrize(
    "key", ["rms_gradient: 0.01", "reduced_pressure: 0.05", "length: 1e-4", "youngs_modulus: 70e9"]
)
def test_an_extreme_value_is_refused_where_it_stands(tmp_path, key, value):
    name = key.partition(":")[0]
    said = complaint(tmp_path, load_scene, SCENE.replace(key, f"{name}: {value}"))
    assert f"{name}: you gave {float(value)!r}; gfmd allows a number from 1e-30 to 1e+30" in said
    with pytest.raises(InputError, match=name):
        gfmd_numba.solve(tmp_path / "bad.yaml")


@pytest.mark.parametrize("value", EXTREME)
@pytest.mark.parametrize("key", ["rms_gradient", "reduced_pressure"])
def test_an_extreme_value_of_a_campaign_is_refused_where_it_stands(tmp_path, key, value):
    text = CAMPAIGN.replace("grid: {", f"grid: {{{key}: [0.01, {value}], ")
    assert f"grid.{key}[1]: you gave " in complaint(tmp_path, load_campaign, text)


@pytest.mark.parametrize("value", ["1.8e308", "1.7e308", "1e31", "1e-13"])
def test_a_slab_taller_than_any_is_refused(tmp_path, value):
    text = SCENE.replace("aspect_ratio: 1", f"aspect_ratio: {value}").replace(
        "reduced_pressure: 0.05", "displacement: 0"
    )
    assert "aspect_ratio: you gave " in complaint(tmp_path, load_scene, text)


@pytest.mark.parametrize("value", ["1e-160", "1e-320", "5e-324"])
@pytest.mark.parametrize("dimension", [1, 2])
def test_a_grid_beyond_the_range_of_numbers_is_refused(tmp_path, dimension, value):
    text = SCENE.replace("eps_f: 1/8", f"eps_f: {value}") + f"dimension: {dimension}\n"
    assert "discretisation.eps_f: you gave " in complaint(tmp_path, load_scene, text)


@pytest.mark.parametrize("value", ['"2D"', '"2"', "two", "3", "[2]", "true", ".nan"])
def test_a_dimension_is_one_of_two_numbers(tmp_path, value):
    said = complaint(tmp_path, load_scene, SCENE + f"dimension: {value}\n")
    assert "gfmd allows one of 1, 2" in said
    assert said.endswith("did you mean 2 without quotes?") == (value == '"2"')


@pytest.mark.parametrize("height", [1e308, -1e308, 1e200, np.inf])
@pytest.mark.parametrize("place", ["roughness", "body", "counter_body"])
def test_heights_beyond_all_measure_are_refused(tmp_path, place, height):
    heights = np.sin(np.arange(32.0))
    heights[[3, 17]] = height, -height
    np.save(tmp_path / "p.npy", heights)
    rough = {"method": "measured", "file": str(tmp_path / "p.npy")}
    body = {"poissons_ratio": 0.3, "youngs_modulus": 1.0}
    scene = {"body": body, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.1}}
    scene |= {"roughness": rough} if place == "roughness" else {place: body | {"roughness": rough}}
    with pytest.raises(InputError, match=r"roughness.file: you gave p.npy \(height"):
        gfmd_numba.solve(scene)


def test_a_body_too_smooth_for_its_numbers_is_refused(tmp_path):
    np.save(tmp_path / "p.npy", 1e-200 * np.sin(np.arange(32.0)))
    rough = {"method": "measured", "file": str(tmp_path / "p.npy")}
    scene = {"interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.1}}
    mapped = {"body": {"poissons_ratio": 0.3}, "roughness": rough}
    for bodies in (mapped, {"body": {"poissons_ratio": 0.3, "roughness": rough}}):
        with pytest.raises(InputError, match=r"heights that differ by .* at most"):
            gfmd_numba.solve(scene | bodies)


def test_the_last_look_finds_what_is_not_finite():
    status = np.array([0, 0, 0, 1, 0], dtype=np.int8)
    pressure = np.ones((5, 4))
    pressure[1, 2], pressure[3, 0] = np.inf, np.nan
    kappa = np.array([np.nan, 1.0, -np.inf, 1.0, 1.0])
    found = finite_status({"status": status, "pressure": pressure, "kappa": kappa, "mean_gap": np.arange(5.0)})
    assert found.tolist() == [0, Status.nonfinite, Status.nonfinite, 1, 0]
    assert found.dtype == np.int8
    assert finite_status({"status": np.int8(0), "residual": np.float64("nan")}) == Status.nonfinite


def _solve_with(monkeypatch, field, value):
    solve = solution.solve

    def spoiled(*arguments, **named):
        solved = solve(*arguments, **named)
        values = getattr(solved.equilibrium, field).copy()
        values.flat[0] = value
        return replace(solved, equilibrium=replace(solved.equilibrium, **{field: values}))

    monkeypatch.setattr(solution, "solve", spoiled)
    monkeypatch.setattr("gfmd_numba.contact.load_path.solve", spoiled)


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("field", ["pressure", "displacement"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_spoiled_contact_is_not_ok(tmp_path, monkeypatch, field, value, dimension):
    _solve_with(monkeypatch, field, value)
    (tmp_path / "s.yaml").write_text(SCENE + f"dimension: {dimension}\n")
    with np.errstate(all="ignore"), pytest.warns(UserWarning, match="^nonfinite: A traction was no finite number"):
        found = gfmd_numba.solve(tmp_path / "s.yaml")
    assert int(found["status"]) == Status.nonfinite
    assert np.isnan(found["kappa"])


@pytest.mark.filterwarnings("ignore:nonfinite:UserWarning")
def test_a_spoiled_rough_body_is_not_ok(monkeypatch):
    _solve_with(monkeypatch, "pressure", np.nan)
    rough = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
    scene = {"interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.1}}
    scene |= {"body": {"poissons_ratio": 0.3, "roughness": rough}}
    with np.errstate(all="ignore"):
        found = gfmd_numba.solve({"scene": scene, "discretisation": {"eps_c": 0.25, "eps_f": 0.125, "eps_t": 1}})
    assert int(found["status"]) == Status.nonfinite


@pytest.mark.filterwarnings("ignore:nonfinite:UserWarning")
def test_a_spoiled_loaded_body_is_not_ok(monkeypatch):
    deform = boundary_values.deform
    monkeypatch.setattr(
        boundary_values,
        "deform",
        lambda *a: replace(found := deform(*a), displacement=np.full_like(found.displacement, np.inf)),
    )
    body = {"poissons_ratio": 0.3, "aspect_ratio": 1.0}
    found = gfmd_numba.solve({"scene": {"body": body, "boundary": {"normal_traction": 0.1}}, "points": 16})
    assert int(found["status"]) == Status.nonfinite


def test_a_spoiled_path_of_a_campaign_ends_where_it_is_spoiled(tmp_path, monkeypatch):
    _solve_with(monkeypatch, "displacement", np.nan)
    scene = {"body": {"poissons_ratio": 0.3, "aspect_ratio": 1.0}, "loading": {"reduced_pressure": 0.1}}
    scene |= {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}}
    scene |= {"interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}}}
    file = {"name": "spoiled", "seed": 1, "realisations": 1, "scene": scene, "path": [{"sliding": 1e-4}]}
    with np.errstate(all="ignore"), pytest.warns(UserWarning, match="^nonfinite in 1 of 1 simulations"):
        found = gfmd_numba.run(file | {"reference": {"eps_c": 0.25, "eps_f": 0.125, "eps_t": 1}}, tmp_path / "out")
    assert (found["status"] == Status.nonfinite).all()
    assert found["energy_lost"].isnull().all()
    assert found["hysteresis"].isnull().all()


def test_a_spoiled_case_of_a_campaign_is_not_ok(tmp_path, monkeypatch):
    _solve_with(monkeypatch, "pressure", np.inf)
    with np.errstate(all="ignore"):
        results = run(campaign(tmp_path), tmp_path / "out", Workers(0))[0]
    with xr.open_dataset(results) as dataset:
        spoiled = dataset["status"] == Status.nonfinite
        assert spoiled.any()
        assert not np.isfinite(dataset["kappa"].where(spoiled)).any()


def test_fields_that_are_not_finite_are_refused(tmp_path):
    (tmp_path / "s.yaml").write_text(SCENE)
    found = gfmd_numba.solve(tmp_path / "s.yaml")
    found["pressure"][3] = np.inf
    with (
        pytest.raises(InputError, match="contact: you gave a contact whose fields are not finite"),
        np.errstate(all="ignore"),
    ):
        gfmd_numba.body_fields(found)
