"""Campaigns vary the lengths of a form, alone or under a roughness, and have limits with one."""

import numpy as np
import pytest
import textbook

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.scene import InputError

BODY = {"youngs_modulus": "1 GPa", "poissons_ratio": 0.0}
PSD = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
LEVELS = {"reference": {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 4}, "limits": {"eps_f": [1 / 4], "eps_t": [1 / 2]}}


def campaign(form, roughness=None, grid=None, loading=None, **others):
    scene = {
        "body": BODY,
        "form": form,
        "interface": {"hard_wall": {}},
        "loading": loading or {"line_load": "1 N/mm"},
        "length": "1 mm",
    }
    scene |= {} if roughness is None else {"roughness": roughness}
    return {"name": "forms", "scene": scene, "grid": grid or {}} | others


def test_radius_and_load_of_a_cylinder_vary(tmp_path):
    grid = {"radius": ["2 mm", "4 mm"], "line_load": ["1 N/mm", "2 N/mm"]}
    found = gfmd_numba.run(campaign({"radius": "1 mm", "points": 512}, grid=grid), tmp_path)
    assert found.sizes["case"] == 4
    assert found["radius"].units == found["contact_radius"].units == "m"
    for load, radius, width in zip(found["line_load"], found["radius"], found["contact_radius"][:, 0], strict=True):
        exact = textbook.hertz_line_half_width(float(load) / 1e-3 / 1e9, float(radius) / 1e-3)
        assert float(width) == pytest.approx(1e-3 * exact, rel=2e-2)


@pytest.mark.long
@pytest.mark.parametrize(
    ("form", "grid", "levels"),
    [
        ({"slope": 0.01}, {"slope": [0.01, 0.02]}, LEVELS),
        (
            {"width": "0.1 mm", "edge_radius": "5 mm"},
            {"width": ["0.1 mm", "0.2 mm"], "edge_radius": ["5 mm", "20 mm"]},
            {"reference": LEVELS["reference"]},
        ),
    ],
    ids=["slope", "width and edge"],
)
def test_every_length_is_an_axis_and_leaves_the_gradient_to_the_roughness(tmp_path, form, grid, levels):
    file = campaign(form, PSD, grid, {"reduced_pressure": 0.05}, seed=1, realisations=2, **levels)
    found = gfmd_numba.run(file, tmp_path)
    assert found.sizes == {"case": 6 if "limits" in levels else 4, "realisation": 2}
    assert (found["status"] == 0).all()
    np.testing.assert_allclose(found["rms_gradient"], 0.01, rtol=1e-9)
    np.testing.assert_allclose(found["reduced_pressure"], 0.05)
    for axis in grid:
        first, second = (found["contact_radius"].where(found[axis] == value).mean() for value in np.unique(found[axis]))
        assert float(first) != float(second)


def test_the_files_of_a_grid_have_a_form_too(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(1)
    for name in ("one", "other"):
        np.savetxt(f"{name}.csv", 1e-2 * np.cumsum(rng.standard_normal(64)), header="height (um)")
    rough = {"method": "measured", "detrend": "tilt", "periodic": "mirror", "spacing": "7.8125 um"}
    grid = {"file": ["one.csv", "other.csv"], "radius": ["2 mm", "4 mm"]}
    found = gfmd_numba.run(campaign({"radius": "2 mm"}, rough, grid), "out")
    assert found.sizes["case"] == 4
    assert (found["status"] == 0).all()
    gradients = found["rms_gradient"][:, 0].values.reshape(2, 2)
    np.testing.assert_allclose(gradients[:, 0], gradients[:, 1], rtol=1e-9)
    assert len(np.unique(found["peak_pressure"])) == 4


@pytest.mark.parametrize(
    ("grid", "told"),
    [
        ({"radius": ["2 mm", "0.4 mm"]}, r"grid\.radius\[1\]: .* more than half the period, 0\.0005"),
        ({"slope": [0.1]}, r"grid\.slope\[0\]: .* exactly one of radius, slope and width"),
        ({"radius_y": ["2 mm"]}, r"grid\.radius_y.* nothing with dimension 1"),
    ],
)
def test_a_value_that_makes_no_form_is_refused(grid, told):
    with pytest.raises(InputError, match=told):
        load_campaign(campaign({"radius": "2 mm", "points": 64}, grid=grid))


def test_a_seed_of_a_form_alone_is_refused():
    with pytest.raises(InputError, match="seed: you gave 1; gfmd allows nothing, as no surface is random"):
        load_campaign(campaign({"radius": "2 mm", "points": 64}, seed=1))
