"""One meaning of p / (g E*): g is what the scene asks for, wherever the roughness lies."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.campaign.file import Campaign
from gfmd_numba.scene import SceneFile

GRADIENT, LOAD = 0.01, 0.05
ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": GRADIENT}
BODY = {"youngs_modulus": 2.0, "poissons_ratio": 0.3, "aspect_ratio": 0.5}
MODULUS = 2.0 / (1 - 0.3**2)
COUNTER = BODY | {"youngs_modulus": 1e12}
# at eps_c = 1 the wave at Nyquist has but its real part: the surface is not as steep as asked for
AT_NYQUIST = {"eps_c": 1, "eps_f": 1 / 4, "eps_t": 1 / 2}


def solve(discretisation=AT_NYQUIST, **parts):
    """Contact of these parts, its topographies to order 0, at which they are the same problem as a rough punch."""
    scene = {"body": BODY, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": LOAD}} | parts
    rough = [scene[name] for name in ("body", "counter_body") if "roughness" in scene.get(name, {})]
    numerics = {"residual": 1e-10} | ({"topography_order": 0} if rough else {})
    file = {"scene": scene, "numerics": numerics}
    surfaces = [*(record["roughness"] for record in rough), scene.get("roughness", {})]
    if any(surface.get("method", "measured") != "measured" for surface in surfaces):
        file["seed"] = 11
    return gfmd_numba.solve(file | ({} if discretisation is None else {"discretisation": discretisation}))


PLACES = {
    "punch": {"roughness": ROUGH},
    "body": {"body": BODY | {"roughness": ROUGH}},
    "counter body": {"counter_body": COUNTER | {"roughness": ROUGH}},
}


@pytest.mark.parametrize("eps_c", [1, 1 / 2])
def test_random_roughness_is_pressed_alike_wherever_it_lies(eps_c):
    found = {name: solve(AT_NYQUIST | {"eps_c": eps_c}, **parts) for name, parts in PLACES.items()}
    steep = float(found["punch"]["rms_gradient"]) / GRADIENT
    assert (abs(steep - 1) > 0.01) == (eps_c == 1)
    for name, contact in found.items():
        assert float(contact["mean_pressure"]) == pytest.approx(LOAD * GRADIENT * MODULUS, rel=1e-8), name
        np.testing.assert_allclose(contact["pressure"], found["punch"]["pressure"], atol=1e-8, err_msg=name)
        for measure in ("kappa", "rms_gradient", "mean_gap", "full_contact_rms_pressure"):
            assert float(contact[measure]) == pytest.approx(float(found["punch"][measure]), rel=1e-6), (name, measure)


def test_a_map_is_pressed_by_the_gradient_asked_for():
    contact = solve(dimension=2, roughness=ROUGH)
    assert abs(float(contact["rms_gradient"]) / GRADIENT - 1) > 0.001
    assert float(contact["mean_pressure"]) == pytest.approx(LOAD * GRADIENT * MODULUS, rel=1e-8)


def test_gradients_of_two_random_surfaces_add_up_in_squares():
    """The surfaces are independent: what their slopes have in common is chance, and differs with the seed."""
    other = ROUGH | {"rms_gradient": 0.02, "hurst": 0.5}
    asked = np.hypot(0.01, 0.02)
    for parts in (
        {"body": BODY | {"roughness": ROUGH}, "roughness": other},
        {"body": BODY | {"roughness": ROUGH}, "counter_body": COUNTER | {"roughness": other}},
    ):
        contact = solve(AT_NYQUIST | {"eps_c": 1 / 2}, **parts)
        assert float(contact["mean_pressure"]) == pytest.approx(LOAD * asked * MODULUS, rel=1e-8)
        assert abs(float(contact["rms_gradient"]) / asked - 1) > 1e-3
        assert float(contact["rms_gradient_target"]) == pytest.approx(asked)


@pytest.fixture
def measured(tmp_path):
    def write(name, heights):
        np.save(tmp_path / name, heights)
        return {"method": "measured", "file": str(tmp_path / name), "units": {"z": "L_x"}}

    return write


def test_measured_heights_count_by_the_gradient_of_their_sum(measured):
    wave = 1e-3 * np.cos(2 * np.pi * np.arange(64) / 64)
    punch = solve(None, roughness=measured("sum.npy", 3 * wave))
    both = solve(None, body=BODY | {"roughness": measured("one.npy", wave)}, roughness=measured("two.npy", 2 * wave))
    gradient = np.sqrt(2) * np.pi * 3e-3
    for contact in (punch, both):
        assert float(contact["mean_pressure"]) == pytest.approx(LOAD * gradient * MODULUS, rel=1e-8)
        assert float(contact["rms_gradient_target"]) == pytest.approx(gradient)
    np.testing.assert_allclose(both["pressure"], punch["pressure"], atol=1e-8)


def test_a_measured_wave_and_a_random_surface_add_up_in_squares(measured):
    nx = 32
    wave = measured("wave.npy", 1e-3 * np.cos(2 * np.pi * np.arange(nx) / nx))
    asked = np.hypot(GRADIENT, np.sqrt(2) * np.pi * 1e-3)
    discretisation = AT_NYQUIST | {"eps_c": 1 / 2}
    for parts in (
        {"body": BODY | {"roughness": wave}, "roughness": ROUGH},
        {"body": BODY | {"roughness": ROUGH}, "roughness": wave},
    ):
        contact = solve(discretisation, **parts)
        assert float(contact["mean_pressure"]) == pytest.approx(LOAD * asked * MODULUS, rel=1e-8)


def test_the_meaning_stands_in_schema_and_file(tmp_path):
    meaning = "g is the rms gradient asked for"
    for record, at in ((SceneFile, "Loading"), (SceneFile, "Step"), (Campaign, "Grid")):
        description = record.model_json_schema()["$defs"][at]["properties"]["reduced_pressure"]["description"]
        assert meaning in description, at
    path = gfmd_numba.solve(
        {
            "scene": {
                "body": BODY,
                "roughness": ROUGH,
                "interface": {"hard_wall": {}},
                "loading": {"reduced_pressure": LOAD},
            },
            "discretisation": AT_NYQUIST,
            "path": [{"reduced_pressure": 0.1}],
        }
    )
    assert meaning in path["reduced_pressure"].long_name
    assert path["reduced_pressure"].units == "1"
    (tmp_path / "small.yaml").write_text(CAMPAIGN)
    campaign = gfmd_numba.run(tmp_path / "small.yaml", tmp_path / "out")
    for dataset in (campaign, xr.open_dataset(tmp_path / "out" / "small.nc")):
        assert meaning in dataset["reduced_pressure"].long_name
        assert dataset["rms_gradient_target"].units == "1"


CAMPAIGN = """
name: small
seed: 1
realisations: 1
scene:
  body: {poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
reference: {eps_c: 1/2, eps_f: 1/8, eps_t: 1/2}
"""
