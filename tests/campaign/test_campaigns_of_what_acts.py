"""Campaigns of what acts on rough bodies and maps: each realisation is the contact that `solve` finds."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.campaign.axes import present
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.run import Choice, run
from gfmd_numba.campaign.workers import Workers
from support.campaigns import numbers
from support.realisations import assert_as_solved

ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
SLAB = {"youngs_modulus": 1e9, "poissons_ratio": 0.3, "aspect_ratio": 0.5}
OTHER = SLAB | {"youngs_modulus": 2e9, "poissons_ratio": 0.1}
FRICTION = {"hard_wall": {}, "friction": {"coefficient": 0.3}}
COHESIVE = {"work_of_adhesion": "50 mJ/m^2", "normal_length": 2e-7, "tangential_length": 3e-7}
COATING = {
    "layers": [{"height": 0.02, "youngs_modulus": 4e9, "poissons_ratio": 0.1}],
    "base": {"youngs_modulus": 1e9, "poissons_ratio": 0.4},
}
LOADED = {"length": 1e-4, "loading": {"reduced_pressure": 0.1}}
PROFILE, MAP = {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}, {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2}
TWO = {"body": SLAB | {"roughness": ROUGH}, "counter_body": OTHER | {"roughness": ROUGH}}
DRAG = [{"sliding": 2e-8}, {"sliding": 1e-8}]
SCENES = {
    "friction between two bodies": (TWO | {"interface": FRICTION}, PROFILE, {"path": DRAG}),
    "friction between two bodies at order 2": (
        TWO | {"interface": FRICTION},
        PROFILE,
        {"path": DRAG, "numerics": {"topography_order": 2}},
    ),
    "friction on a body at order 2": (
        {"body": TWO["body"], "interface": FRICTION},
        PROFILE,
        {"path": DRAG, "numerics": {"topography_order": 2}},
    ),
    "friction on a map at order 2": (
        {"dimension": 2, "body": TWO["body"], "interface": FRICTION},
        MAP,
        {"path": DRAG, "numerics": {"topography_order": 2}},
    ),
    "friction between maps": (TWO | {"dimension": 2, "interface": FRICTION}, MAP, {}),
    "maps at order 2": (
        TWO | {"dimension": 2, "interface": {"hard_wall": {}}},
        MAP,
        {"numerics": {"topography_order": 2}},
    ),
    "cohesive maps": (
        {"dimension": 2, "body": SLAB, "roughness": ROUGH, "interface": {"hard_wall": {}, "cohesive": COHESIVE}},
        MAP,
        {"path": [{"sliding": 4e-8, "sliding_y": 2e-8}]},
    ),
    "cohesive rough bodies": (TWO | {"interface": {"hard_wall": {}, "cohesive": COHESIVE}}, PROFILE, {}),
    "a cohesive law under a rough punch at order 1": (
        {
            "dimension": 2,
            "body": SLAB | {"roughness": ROUGH},
            "roughness": ROUGH,
            "interface": {"hard_wall": {}, "cohesive": COHESIVE},
        },
        MAP,
        {"path": [{"sliding": 4e-8, "sliding_y": 2e-8}], "numerics": {"topography_order": 1}},
    ),
    "hardness of a rough body": (
        {"body": SLAB | {"roughness": ROUGH}, "interface": {"hard_wall": {"hardness": "3 MPa"}}},
        PROFILE,
        {},
    ),
    "rough coating of finite hardness at order 2": (
        {"body": COATING | {"roughness": ROUGH}, "interface": {"hard_wall": {"hardness": "30 MPa"}}},
        PROFILE,
        {"numerics": {"topography_order": 2}},
    ),
}


def of(name, **more):
    scene, reference, rest = SCENES[name]
    return {"name": "acts", "seed": 4, "realisations": 2, "scene": LOADED | scene, "reference": reference} | rest | more


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    [
        "friction between two bodies at order 2",
        "friction on a map at order 2",
        "cohesive maps",
        "cohesive rough bodies",
        "a cohesive law under a rough punch at order 1",
        "hardness of a rough body",
        "rough coating of finite hardness at order 2",
    ],
)
def test_a_realisation_has_the_numbers_of_solve(tmp_path, pickled, name):
    campaign, (_, reference, more) = of(name), SCENES[name]
    found = gfmd_numba.run(campaign, tmp_path / "out", workers=0)
    assert (found["status"] == 0).all()
    assert_as_solved(found, 0, 1, campaign["scene"], more | {"discretisation": reference})


@pytest.mark.long
def test_a_stopped_run_of_dragged_bodies_is_resumed_to_the_same_numbers(tmp_path, monkeypatch):
    monkeypatch.setattr("gfmd_numba.campaign.cases._BLOCK_SAMPLES", 3 * 256)  # one realisation a block
    campaign = of("friction between two bodies", grid={"friction_coefficient": [0.1, 0.3]})
    whole = gfmd_numba.run(campaign, tmp_path / "whole", workers=0)
    run(campaign, tmp_path / "parts", Workers(0), choice=Choice(limit=3))
    resumed = gfmd_numba.run(campaign, tmp_path / "parts", workers=0)
    assert resumed.attrs["content_sha256"] == whole.attrs["content_sha256"]
    assert numbers(resumed).identical(numbers(whole))
    assert (np.diff(whole["hysteresis"].values, axis=0) != 0.0).all()  # friction, not the ensemble, decides it


def test_identity_follows_what_acts_on_rough_bodies():
    def identity(name, **more):
        return plan(of(name, **more)).problems[0].identity

    base = identity("friction between maps")
    order_2 = {"numerics": {"topography_order": 2}}
    frictionless = identity("maps at order 2", numerics={})
    assert len({base, frictionless, identity("maps at order 2", **order_2)}) == 3
    stiffer = LOADED | TWO | {"dimension": 2, "interface": {"hard_wall": {}, "friction": {"coefficient": 0.4}}}
    assert identity("friction between maps", scene=stiffer) != base
    bodies = {"body": TWO["counter_body"], "counter_body": TWO["body"]}
    exchanged = LOADED | bodies | {"interface": FRICTION}
    dragged = "friction between two bodies"
    assert identity(dragged, scene=exchanged) != identity(dragged)


@pytest.mark.parametrize("layered", ["body", "counter_body"])
def test_layers_have_no_thickness_of_one_body_in_either_place(layered):
    bodies = {"body": SLAB | {"roughness": ROUGH}, "counter_body": OTHER}
    bodies[layered] = COATING | {"roughness": ROUGH}
    campaign = of("friction between two bodies", scene=LOADED | bodies | {"interface": FRICTION})
    case = plan({key: value for key, value in campaign.items() if key != "path"}).cases[0]
    axes = {axis.name for axis in present(case.scene, case.discretisation)}
    assert axes & {"aspect_ratio", "counter_body_aspect_ratio"} == (
        {"counter_body_aspect_ratio"} if layered == "body" else {"aspect_ratio"}
    )


@pytest.mark.long
def test_a_grid_may_make_friction_infinite_at_a_higher_order(tmp_path):
    name = "friction on a body at order 2"
    file = of(name, grid={"friction_coefficient": [0.3, float("inf")]}, realisations=1)
    found = gfmd_numba.run(file, tmp_path / "out", workers=0)
    assert (found["status"] == 0).all()
    scene, reference, rest = SCENES[name]
    sticking = LOADED | scene | {"interface": {"hard_wall": {}, "friction": {"coefficient": float("inf")}}}
    alone = gfmd_numba.solve({"scene": sticking, "seed": 4, "discretisation": reference} | rest)
    (case,) = np.flatnonzero(np.isinf(found["friction_coefficient"]))
    for kept in ("kappa", "next_order", "mean_tangential_traction"):
        np.testing.assert_allclose(found[kept][case, 0], alone[kept], rtol=1e-9)
