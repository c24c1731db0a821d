"""Scenes whose body flows inside: units, what they write, what they refuse, and what campaigns make of them."""

import copy

import numpy as np
import pytest
import yaml

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.cli import terminal
from gfmd_numba.contact import plastic_flow
from gfmd_numba.scene import InputError
from support.command_line import gfmd, refused

pytestmark = pytest.mark.usefixtures("undrawn")

FLOWS = {
    "scene": {
        "length": "1 mm",
        "body": {
            "youngs_modulus": "200 GPa",
            "poissons_ratio": 0.3,
            "plasticity": {"yield_stress": "400 MPa", "hardening": "2 GPa", "sublayers": 12, "increments": 4},
        },
        "form": {"radius": "10 mm", "points": 64},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": "200 MPa"},
    },
    "path": [{"pressure": "1 kPa"}],
}


def changed(*keys, **values):
    """The file with other values at a place; None removes one."""
    found = copy.deepcopy(FLOWS)
    place = found
    for key in keys:
        place = place[key]
    place |= values
    for name in [name for name, value in values.items() if value is None]:
        del place[name]
    return found


def test_a_dent_stays_in_the_units_of_the_file_and_is_that_of_a_scene_without_units():
    found = gfmd_numba.solve(FLOWS)
    assert found["residual_displacement"].units == found["depth"].units == "m"
    assert found["von_mises_stress"].units == found["stress_x"].units == "Pa"
    assert found["equivalent_plastic_strain"].dims == ("step", "depth", "x")
    assert (found["flow_residual"] <= 1e-6).all()
    np.testing.assert_allclose(found["largest_von_mises"][0], 4e8, rtol=0.05)
    np.testing.assert_array_equal(found["residual_displacement"][0], found["residual_displacement"][1])
    modulus = 200e9 / 0.91
    bare = changed("scene", length=None, form={"radius": 10.0, "points": 64}, loading={"pressure": 200e6 / modulus})
    bare["scene"]["body"] = {
        "poissons_ratio": 0.3,
        "plasticity": {"yield_stress": 400e6 / modulus, "hardening": 2e9 / modulus, "sublayers": 12, "increments": 4},
    }
    bare["scene"]["loading"] = {"pressure": 200e6 / modulus}
    with pytest.raises(InputError, match="pressure"):  # in Pa, which needs moduli
        gfmd_numba.solve(bare)
    micro = changed("scene", length="1 um", form={"radius": "10 um", "points": 64})
    smaller = gfmd_numba.solve(micro)
    for name in ("pressure", "equivalent_plastic_strain", "von_mises_stress"):
        np.testing.assert_allclose(smaller[name], found[name], rtol=1e-9, atol=1e-9 * float(found[name].max()))
    np.testing.assert_allclose(1e3 * smaller["depth"], found["depth"], rtol=1e-9)


def test_voce_hardening_lies_between_the_yield_and_the_saturation_stress():
    def stress(**plasticity):
        own = {"yield_stress": "400 MPa", "sublayers": 12, "increments": 4} | plasticity
        return float(gfmd_numba.solve(changed("scene", "body", plasticity=own))["largest_von_mises"][0])

    voce = stress(saturation_stress="600 MPa", saturation_strain=0.002)
    assert 450e6 < voce < 600e6


def test_a_flow_that_comes_to_no_rest_says_so_and_what_to_do(tmp_path, monkeypatch):
    monkeypatch.setattr(plastic_flow, "_LOOPS", 2)
    (tmp_path / "s.yaml").write_text(yaml.safe_dump(FLOWS))
    done = gfmd("solve", tmp_path / "s.yaml", "-o", tmp_path / "c.nc")
    assert done.exit_code == 3
    said = " ".join(done.stderr.split())
    assert "the run ended as flows_on after 4 iterations in step 0 of 1" in said
    assert "The plastic flow inside the body did not come to rest" in said
    assert "press less" in said


def doubts(**plasticity):
    own = FLOWS["scene"]["body"]["plasticity"] | plasticity
    return gfmd_numba.solve(changed("scene", "body", plasticity=own) | {"path": []}).attrs["validity"]


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_layers_sublayers_and_increments_that_are_too_few_are_told():
    assert "lowest sublayer" in doubts(depth="50 um")
    assert "sublayers deep" in doubts(depth="0.9 mm", sublayers=4)
    assert "unknown error" in doubts(increments=1)
    assert doubts() == ""


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_the_depth_that_is_found_holds_what_flows_far_beyond_first_yield():
    """Here flow is 1.25 times as deep as an elastic body would yield."""
    plasticity = {"yield_stress": "40 MPa", "sublayers": 24, "increments": 1}
    file = changed("scene", "body", plasticity=plasticity) | {"path": []}
    file["scene"] |= {"loading": {"pressure": "15 MPa"}, "form": {"radius": "5 mm", "points": 64}}
    assert "lowest sublayer" not in gfmd_numba.solve(file).attrs["validity"]


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_plastic_strain_that_is_not_small_is_told():
    scene = copy.deepcopy(FLOWS["scene"]) | {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.5}}
    del scene["form"]
    scene["loading"] = {"pressure": "150 MPa"}
    scene["body"]["plasticity"] |= {"sublayers": 8, "increments": 2}
    eps = {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1}
    found = gfmd_numba.solve({"scene": scene, "discretisation": eps})
    strain = float(found["largest_plastic_strain"])
    assert strain > 0.1
    assert f"the largest plastic strain is {strain:.2g}, where" in found.attrs["validity"]


REFUSED = {
    "saturation alone": (
        changed("scene", "body", plasticity={"yield_stress": "1 GPa", "saturation_stress": "2 GPa"}),
        "saturation_strain",
    ),
    "saturation below yield": (
        changed(
            "scene",
            "body",
            plasticity={"yield_stress": "1 GPa", "saturation_stress": "1 GPa", "saturation_strain": 0.1},
        ),
        "a stress above the yield_stress",
    ),
    "friction": (changed("scene", "interface", friction={"coefficient": 0.3}), "no friction with plasticity"),
    "hardness": (changed("scene", interface={"hard_wall": {"hardness": "1 GPa"}}), "a hard_wall without hardness"),
    "slab": (changed("scene", "body", aspect_ratio=1.0), "a half-space of one material"),
    "window": (changed("scene", periodic=False), "true with plasticity"),
    "wear": (changed("scene", "interface", wear={"rate": 1e-12}), "no wear with plasticity"),  # not: nothing slides
    "load": (changed("scene", loading={"pressure": "701 MPa"}), "at which the body yields at all depths"),
}


def test_what_is_advised_goes_with_plastic_flow():
    file = changed("scene", loading={"displacement": "1 um"}) | {"path": [{"sliding": "1 um"}]}
    with pytest.raises(InputError) as error:
        gfmd_numba.solve(file)
    depth, sliding = str(error.value).splitlines()
    assert "gfmd needs a pressure or another load in place of loading.displacement, as" in depth
    assert sliding.endswith("gfmd allows nothing")
    del file["scene"]["body"]["plasticity"]
    with pytest.raises(InputError) as error:
        gfmd_numba.solve(file)
    depth, sliding = str(error.value).splitlines()
    assert "gfmd needs a finite aspect_ratio, periodic false, or a pressure or another load in place" in depth
    assert sliding.endswith("gfmd allows nothing without friction, a cohesive law or wear")


@pytest.mark.parametrize("name", REFUSED)
def test_what_does_not_go_with_plastic_flow_is_refused(name):
    file, told = REFUSED[name]
    with pytest.raises(InputError, match=told):
        gfmd_numba.solve(file)


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"scene": FLOWS["scene"] | {"loading": {"pressure": "701 MPa"}}}, "scene.loading.pressure"),
        ({"path": [{"pressure": "701 MPa"}]}, "path[0].pressure"),
    ],
)
def test_check_knows_the_pressure_at_which_a_body_flows_at_all_depths(change, place, tmp_path):
    (tmp_path / "flows.yaml").write_text(yaml.safe_dump(FLOWS | change))
    assert f"{place}: you gave '701 MPa'; gfmd allows below 700 MPa" in refused("check", tmp_path / "flows.yaml")


@pytest.mark.long
def test_increments_say_how_far_they_are(tmp_path, monkeypatch):
    """Of each of two steps there are 4, and 2 that tell their error."""
    monkeypatch.setattr(terminal, "_PATIENCE", 0.0)
    (tmp_path / "flows.yaml").write_text(yaml.safe_dump(FLOWS))
    said = gfmd("solve", tmp_path / "flows.yaml", "-o", tmp_path / "flows.nc").stderr.splitlines()
    shares = [line for line in said if line.startswith("busy     solving, ")]
    done = ((17, 0), (33, 0), (50, 1), (67, 1), (83, 1), (100, 2))
    assert shares[-6:] == [f"busy     solving, {share}% done ({steps} of 2)" for share, steps in done]


def test_a_grid_may_not_yield_at_all_depths_either(tmp_path):
    campaign = {"name": "yield", "scene": FLOWS["scene"] | {"loading": {"pressure": "600 MPa"}}}
    (tmp_path / "grid.yaml").write_text(yaml.safe_dump(campaign | {"grid": {"yield_stress": ["300 MPa", "400 MPa"]}}))
    assert "gfmd allows below 525 MPa" in refused("check", tmp_path / "grid.yaml")


def test_fields_below_a_body_that_flows_are_refused():
    with pytest.raises(InputError, match="a body that flows inside"):
        gfmd_numba.body_fields(gfmd_numba.solve(changed("scene", loading={"pressure": "150 MPa"})))


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_campaigns_vary_the_yield_stress(tmp_path):
    plasticity = FLOWS["scene"]["body"]["plasticity"] | {"sublayers": 8, "increments": 2}
    scene = changed("scene", "body", plasticity=plasticity)["scene"] | {"loading": {"pressure": "150 MPa"}}
    campaign = {"name": "yield", "scene": scene, "grid": {"yield_stress": ["300 MPa", "500 MPa"]}}
    load_campaign(campaign)
    found = gfmd_numba.run(campaign, tmp_path / "out")
    np.testing.assert_allclose(found["yield_stress"], [3e8, 5e8])
    volume = found["plastic_volume"].values.ravel()
    assert volume[0] > volume[1] > 0.0
    assert found["peak_pressure"].values.ravel()[0] < found["peak_pressure"].values.ravel()[1]
