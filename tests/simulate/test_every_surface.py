"""Every way to make a surface is pressed, in a scene and a campaign, and is the one that `gfmd surface` makes."""

import numpy as np
import pytest
import xarray as xr
import yaml

import gfmd_numba
from gfmd_numba.scene import InputError
from support.cases import some_of

CORRELATED = {"hurst": 0.8, "correlation_length": 0.1, "rms_height": 1e-3}
TWO_LENGTHS = {"correlation_length_x": 0.05, "correlation_length_y": 0.1, "rms_height": 1e-3}
POWER_LAW = {"hurst": 0.8, "roll_off": 0.5, "cut_on": 0.125, "rms_gradient": 0.02}
SURFACES = {
    "psd": {"method": "psd", "plateau": False} | POWER_LAW,
    "psd with a height": {"method": "psd", "hurst": 0.8, "roll_off": 0.5, "cut_on": 0.125, "rms_height": 1e-3},
    "exponential": {"method": "psd", "model": "exponential"} | CORRELATED,
    "mounds": {"method": "psd", "model": "exponential", "mound_separation": 0.2} | CORRELATED,
    "k_correlation": {"method": "psd", "model": "k_correlation", "cut_on": 0.125} | CORRELATED,
    "filtered": {"method": "fourier_filter", "model": "k_correlation"} | CORRELATED,
    "midpoint": {"method": "midpoint_displacement"} | POWER_LAW,
    "addition": {"method": "successive_addition"} | POWER_LAW,
}
MAPS = {
    "anisotropic": {"method": "psd", "anisotropy": 2} | POWER_LAW,
    "two lengths": {"method": "psd", "model": "length_anisotropy", "hurst": 0.8} | TWO_LENGTHS,
    "two exponents": {"method": "psd", "model": "scaling_anisotropy", "hurst_x": 0.5, "hurst_y": 0.8} | TWO_LENGTHS,
}
CASES = [(1, name) for name in SURFACES] + [(2, name) for name in ("psd", "filtered", "midpoint", "addition", *MAPS)]
SEED = 7


def record(name):
    return (SURFACES | MAPS)[name] | {"points": 32}


def scene(dimension, name):
    return {
        "dimension": dimension,
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
        "roughness": record(name),
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05},
    }


def surface(dimension, name, realisation):
    file = {"surface": record(name), "dimension": dimension, "seed": SEED, "realisation": realisation}
    return gfmd_numba.make_surface(file)["height"].values


@pytest.mark.parametrize(("dimension", "name"), some_of(CASES, *range(0, len(CASES), 2)))
def test_it_is_pressed_as_it_is_made(dimension, name):
    file = {"scene": scene(dimension, name), "seed": SEED, "realisation": 1}
    contact = gfmd_numba.solve(file)
    assert int(contact["status"]) == 0
    assert 0 < float(contact["contact_area_fraction"]) < 1
    made = surface(dimension, name, 1)
    pressed = contact["height"].values
    np.testing.assert_allclose(
        pressed - pressed.mean(), made - made.mean(), atol=1e-12 * np.abs(made).max(), err_msg=name
    )


@pytest.mark.long
@pytest.mark.parametrize(("dimension", "name"), [(1, "addition")])
def test_a_campaign_presses_the_surfaces_of_a_scene(tmp_path, dimension, name):
    campaign = {"name": "tiny", "seed": SEED, "realisations": 2, "scene": scene(dimension, name)}
    (tmp_path / "tiny.yaml").write_text(yaml.safe_dump(campaign))
    gfmd_numba.run(tmp_path / "tiny.yaml", tmp_path / "out", 0)
    with xr.open_dataset(tmp_path / "out" / "tiny.nc") as results:
        for realisation in range(2):
            one = gfmd_numba.solve({"scene": scene(dimension, name), "seed": SEED, "realisation": realisation})
            assert float(results["kappa"].squeeze()[realisation]) == pytest.approx(float(one["kappa"]), rel=1e-9)


def test_a_surface_with_points_leaves_nothing_to_a_discretisation():
    file = {"scene": scene(1, "exponential"), "discretisation": {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 1}}
    with pytest.raises(
        InputError, match=r"discretisation: you gave .*; gfmd allows nothing, as every surface has its own"
    ):
        gfmd_numba.solve(file)
