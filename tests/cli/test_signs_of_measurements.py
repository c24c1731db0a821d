"""Whoever reads a spoilt measurement says so: check, plan and surface name form and spikes."""

from copy import deepcopy

import numpy as np
import pytest
import xarray as xr
import yaml
from click.testing import CliRunner

from gfmd_numba.cli import main

pytestmark = pytest.mark.usefixtures("undrawn")

SCENE = {
    "body": {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3},
    "interface": {"hard_wall": {}},
    "loading": {"pressure": "10 MPa"},
}
ROUGH = {"method": "measured", "file": "p.csv", "detrend": "tilt", "periodic": "mirror"}
FORM, SPIKES = "mm (convex) makes up", "2 heights in spikes, the first at index 77"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A rough shaft of 50 mm radius with two spikes, in p.csv of the working directory."""
    monkeypatch.chdir(tmp_path)
    x = np.arange(512) * 4e-3  # mm
    z = np.random.default_rng(0).normal(size=512).cumsum() * 0.02 - 1e3 * (x - 1.0) ** 2 / 2 / 50.0
    z[[77, 300]] += 5.0
    np.savetxt("p.csv", np.column_stack([x, z]), delimiter=",", header="x [mm],z [um]", comments="")


def told(command, file, content, *more):
    with open(file, "w", encoding="utf-8") as opened:
        yaml.safe_dump(content, opened)
    done = CliRunner().invoke(main, [command, file, *more])
    assert done.exit_code == 0, done.output
    return " ".join(done.stderr.replace("gfmd:", "").split())


@pytest.mark.parametrize(
    ("command", "content"),
    [
        ("check", {"scene": SCENE | {"roughness": ROUGH}}),
        (
            "check",
            {
                "scene": SCENE
                | {
                    "roughness": ROUGH,
                    "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-6, "range": 1e-5}},
                }
            },
        ),
        ("check", {"surface": ROUGH}),
        ("check", {"scene": {"body": SCENE["body"] | {"roughness": ROUGH}, "boundary": {"normal_traction": 0.0}}}),
        ("check", {"name": "p", "scene": SCENE | {"roughness": ROUGH}, "grid": {"pressure": ["1 MPa", "2 MPa"]}}),
    ],
)
@pytest.mark.usefixtures("folder")
def test_check_names_form_and_spikes_wherever_a_measurement_stands(command, content):
    said = told(command, "f.yaml", content)
    assert FORM in said
    assert SPIKES in said
    assert "check the units" not in said


@pytest.mark.usefixtures("folder")
def test_plan_names_form_and_spikes():
    content = {"name": "p", "scene": SCENE | {"roughness": ROUGH}, "grid": {"pressure": ["1 MPa", "2 MPa"]}}
    said = told("plan", "f.yaml", content, "--pilot", "0")
    assert FORM in said
    assert SPIKES in said


@pytest.mark.usefixtures("folder")
def test_a_surface_without_spikes_says_where_they_were():
    cured = {"surface": ROUGH | {"despike": True, "detrend": "curvature"}}
    told("surface", "f.yaml", cured, "-o", "s.nc")
    with xr.open_dataset("s.nc") as found:
        assert found.attrs["validity"] == ""
        done = "interpolated 2 heights in spikes linearly, of 512, at index 77; 300"
        assert done in found.attrs["processing"]
        assert float(np.ptp(found["height"].values)) < 4e-6


@pytest.mark.long
@pytest.mark.usefixtures("folder")
def test_contacts_and_their_length_are_those_of_the_field_that_was_mirrored():
    scene = SCENE | {"roughness": ROUGH | {"despike": True, "detrend": "curvature", "cutoff": "40 um"}}
    told("curve", "f.yaml", {"scene": scene}, "--loads", "3,10,100MPa", "-o", "c.nc")
    solved = CliRunner().invoke(main, ["solve", "f.yaml", "-o", "s.nc"])
    with xr.open_dataset("c.nc") as curve, xr.open_dataset("s.nc") as contact:
        at = curve.sel(prescribed_load=10e6)
        assert float(at["n_segments"]) == int(contact["n_segments"]) / 2
        field = (at["contact_area_fraction"] * 512 * 4e-6).item()
        assert float(at["contact_length"]) == pytest.approx(field)
        assert "note a profile stands for ridges without end along y" in " ".join(solved.stdout.split())


@pytest.mark.long
@pytest.mark.usefixtures("folder")
def test_a_campaign_of_measured_profiles_tells_that_they_are_ridges():
    scene = SCENE | {"roughness": ROUGH | {"despike": True, "detrend": "curvature", "cutoff": "40 um"}}
    with open("c.yaml", "w", encoding="utf-8") as opened:
        yaml.safe_dump({"name": "c", "scene": scene, "grid": {"pressure": ["10 MPa", "20 MPa"]}}, opened)
    done = CliRunner().invoke(main, ["run", "c.yaml", "--workers", "0", "-o", "out"])
    assert done.exit_code == 0, done.output
    assert " ".join(done.stdout.split()).count("note a profile stands for ridges without end along y") == 1


@pytest.mark.usefixtures("folder")
def test_under_a_line_load_on_the_period_the_contact_is_that_of_the_period():
    scene = SCENE | {"roughness": ROUGH | {"despike": True, "detrend": "curvature", "cutoff": "40 um"}}
    told("curve", "f.yaml", {"scene": scene}, "--loads", "10, 40 kN/m", "-o", "c.nc")
    with xr.open_dataset("c.nc") as curve:
        np.testing.assert_allclose(curve["contact_length"], curve["contact_area_fraction"] * 1024 * 4e-6)


@pytest.mark.usefixtures("folder")
def test_bodies_with_the_same_heights_are_told():
    rough = ROUGH | {"despike": True, "detrend": "curvature", "cutoff": "40 um"}
    body = SCENE["body"] | {"roughness": rough}
    said = told("check", "f.yaml", {"scene": SCENE | {"body": body, "counter_body": deepcopy(body)}})
    assert "counter_body: both bodies have the same heights" in said
    grid = {"pressure": ["1 MPa", "2 MPa"]}
    two = SCENE | {"body": body, "counter_body": deepcopy(body)}
    said = told("check", "f.yaml", {"name": "p", "scene": two, "grid": grid})
    assert "counter_body.roughness: both bodies have the same heights" in said
    other = SCENE["body"] | {"roughness": rough | {"cutoff": "44 um"}}
    assert "same heights" in told("check", "f.yaml", {"scene": SCENE | {"body": body, "counter_body": other}})
    np.savetxt("q.csv", np.flipud(np.loadtxt("p.csv", delimiter=",", skiprows=1)[:, 1:]), header="z [um]", comments="")
    other["roughness"] |= {"file": "q.csv", "spacing": "4 um"}
    assert "same heights" not in told("check", "f.yaml", {"scene": SCENE | {"body": body, "counter_body": other}})
