"""Campaigns of rough elastic bodies and of two elastic bodies: each realisation is the contact that `solve` finds."""

import numpy as np
import pytest
import yaml
from pydantic import TypeAdapter

import gfmd_numba
from gfmd_numba.analysis import fit_tfc
from gfmd_numba.campaign.axes import OF_THE_SCENE, with_values
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.run import Choice, run
from gfmd_numba.campaign.shards import Finished
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.scene import InputError, Scene
from support.campaigns import numbers
from support.command_line import gfmd
from support.realisations import assert_as_solved

pytestmark = pytest.mark.usefixtures("laws_that_hold")

ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02}
STEEL = {"youngs_modulus": 210e9, "poissons_ratio": 0.3}
ALUMINIUM = {"youngs_modulus": 70e9, "poissons_ratio": 0.33, "aspect_ratio": 0.5}
WALL = {"interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.05}}
EPS = {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}
HEIGHTS = 1e-3 * np.cos(2 * np.pi * np.arange(256) / 256) + 2e-4 * np.cos(2 * np.pi * 7 * np.arange(256) / 256)
TWO = WALL | {
    "body": STEEL | {"roughness": ROUGH},
    "counter_body": ALUMINIUM | {"roughness": ROUGH | {"rms_gradient": 0.01}},
}
ALPHA = {"eps_c": 2.0, "eps_f": 1.0}
RANDOM = ROUGH | {"points": 256, "roll_off": 0.5, "cut_on": 1 / 32}
SCENES = {
    "two bodies": (TWO, {}),
    "punch on a rough body along a path": (
        WALL | {"body": ALUMINIUM | {"roughness": ROUGH}, "roughness": ROUGH},
        {"path": [{"reduced_pressure": 0.1}, {"reduced_pressure": 0.02}]},
    ),
    "adhesive rough body": (
        WALL
        | {
            "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.4, "roughness": ROUGH},
            "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-6, "range": 0.01}},
        },
        {"numerics": {"topography_order": 1}},
    ),
    "maps": (TWO | {"dimension": 2}, {}),
}


def of(scene, **more):
    """Mapping of a campaign of two realisations."""
    eps = EPS | ({"eps_c": 1 / 2, "eps_f": 1 / 8} if scene.get("dimension") == 2 else {})
    return {"name": "rough-bodies", "seed": 4, "realisations": 2, "scene": scene, "reference": eps} | more


def without_reference(campaign):
    return {key: value for key, value in campaign.items() if key != "reference"}


@pytest.mark.long
@pytest.mark.parametrize("name", SCENES)
def test_a_realisation_has_the_numbers_of_solve(tmp_path, pickled, name):
    scene, more = SCENES[name]
    campaign = of(scene, **more)
    found = gfmd_numba.run(campaign, tmp_path / "out", workers=0)
    assert (found["status"] == 0).all()
    assert_as_solved(found, 0, 1, scene, more | {"discretisation": campaign["reference"]})


@pytest.mark.long
def test_measured_surfaces_of_bodies_are_those_of_solve(tmp_path):
    np.save(tmp_path / "body.npy", HEIGHTS)
    body = ALUMINIUM | {
        "roughness": {"method": "measured", "file": "body.npy", "units": {"z": "L_x"}, "detrend": "mean"}
    }
    scene = WALL | {"body": body, "counter_body": STEEL | {"roughness": RANDOM}}
    (tmp_path / "measured.yaml").write_text(yaml.safe_dump(without_reference(of(scene))))
    found = gfmd_numba.run(tmp_path / "measured.yaml", tmp_path / "out", workers=0)
    at_home = body | {"roughness": body["roughness"] | {"file": str(tmp_path / "body.npy")}}
    assert_as_solved(found, 0, 1, scene | {"body": at_home}, {})
    assert "body.roughness: " in found.attrs["processing"]
    alone = {"name": "alone", "scene": WALL | {"body": body}, "grid": {"reduced_pressure": [0.01, 0.02]}}
    (tmp_path / "alone.yaml").write_text(yaml.safe_dump(alone))
    assert len({problem.identity for problem in plan(tmp_path / "alone.yaml").problems}) == 2


@pytest.mark.long
def test_smooth_half_spaces_under_a_rough_one_contract_to_the_rigid_punch_at_order_0(tmp_path):
    """Without friction, order 0 has the pressure of the same roughness on a punch, so that both have one limit."""
    limits = {"limits": {"eps_c": [1 / 2, 1 / 8], "eps_f": [1 / 4, 1 / 8]}, "realisations": 3}
    order = {"numerics": {"topography_order": 0}}
    elastic = WALL | {"body": STEEL | {"roughness": ROUGH}, "counter_body": STEEL}
    rigid = WALL | {"body": STEEL, "roughness": ROUGH}
    both = [
        gfmd_numba.run(of(scene, **limits, **more), tmp_path / str(i), workers=0)
        for i, (scene, more) in enumerate(((elastic, order), (rigid, {})))
    ]
    assert np.allclose(both[0]["kappa"], both[1]["kappa"], rtol=1e-9, atol=0.0)
    assert np.allclose(both[0]["mean_pressure"], both[1]["mean_pressure"] / 2, rtol=1e-12)  # E* is half
    elastic_limit, rigid_limit = (fit_tfc(each, fixed=ALPHA)["kappa_tfc"].item() for each in both)
    assert 1.5 < elastic_limit == pytest.approx(rigid_limit, rel=1e-6)


def test_identity_follows_what_decides_the_numbers():
    def identity(scene=TWO, **more):
        return plan(of(scene, **more)).problems[0].identity

    def other(name, **changes):
        return TWO | {name: TWO[name] | changes}

    base = identity()
    twice = {name: TWO[name] | {"youngs_modulus": 2 * TWO[name]["youngs_modulus"]} for name in ("body", "counter_body")}
    assert identity(TWO | twice) == base  # only their ratio counts
    assert identity(TWO | {"length": 1e-3}) == base
    for changed in (
        other("counter_body", youngs_modulus=71e9),
        other("counter_body", poissons_ratio=0.3),
        other("body", poissons_ratio=0.31),  # of a half-space: at order 2 its topography tells it
        other("body", roughness=ROUGH | {"rms_gradient": 0.03}),
        other("counter_body", roughness=ROUGH),
        TWO | {"body": TWO["counter_body"], "counter_body": TWO["body"]},
    ):
        assert identity(changed) != base
    assert len({identity(numerics={"topography_order": order}) for order in range(4)} | {base}) == 4
    assert identity(seed=5) != base


@pytest.mark.long
def test_a_stopped_run_is_resumed_to_the_same_numbers(tmp_path, monkeypatch):
    monkeypatch.setattr("gfmd_numba.campaign.cases._BLOCK_SAMPLES", 2 * 256)
    campaign = of(TWO, realisations=4, grid={"counter_body_youngs_modulus": [70e9, 110e9]})
    whole = gfmd_numba.run(campaign, tmp_path / "whole", workers=0)
    run(campaign, tmp_path / "parts", Workers(0), choice=Choice(limit=1))
    assert len(list(Finished(tmp_path / "parts"))) == 1
    resumed = gfmd_numba.run(campaign, tmp_path / "parts", workers=0)
    assert resumed.attrs["content_sha256"] == whole.attrs["content_sha256"]
    assert numbers(resumed).identical(numbers(whole))


FULL = Scene.model_validate(
    WALL
    | {
        "body": STEEL | {"roughness": ROUGH | {"rms_height": None}},
        "counter_body": ALUMINIUM | {"roughness": ROUGH},
    }
)
OF_BODIES = [axis for axis in OF_THE_SCENE if "body_" in axis.name]


@pytest.mark.parametrize("axis", OF_BODIES, ids=lambda axis: axis.name)
def test_a_value_of_a_body_stands_in_its_place_of_the_scene_alone(axis):
    value = TypeAdapter(axis.type).validate_python(0.375)
    found = with_values(FULL, {axis.place: value})
    asked, changed_to = FULL.model_dump(), found.model_dump()
    for part in axis.place[:-1]:
        asked, changed_to = asked[part], changed_to[part]
    assert changed_to == asked | {axis.place[-1]: value}
    assert axis.value(found, None) == value
    rigid = Scene.model_validate(WALL | {"body": STEEL, "roughness": ROUGH})
    assert axis.value(rigid, None) is None


@pytest.mark.long
def test_a_grid_over_the_bodies_is_run_and_named(tmp_path):
    grid = {"counter_body_youngs_modulus": ["70 GPa", 1.1e11], "body_hurst": [0.3, 0.8]}
    found = gfmd_numba.run(of(TWO, grid=grid, realisations=1), tmp_path / "out", workers=0)
    assert sorted(set(found["counter_body_youngs_modulus"].values)) == [7e10, 1.1e11]
    assert found["counter_body_youngs_modulus"].attrs["units"] == "Pa"
    assert sorted(set(found["body_hurst"].values)) == [0.3, 0.8]
    assert np.allclose(found["rms_gradient_target"], np.hypot(0.02, 0.01))
    assert len(np.unique(found["kappa"])) == 4


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"scene": WALL | {"body": STEEL, "roughness": ROUGH}, "grid": {"counter_body_youngs_modulus": [1e9]}},
            r"grid.counter_body_youngs_modulus: you gave .*; gfmd allows nothing without "
            r"scene.counter_body.youngs_modulus",
        ),
        ({"grid": {"counter_body_poissons_ratio": [0.3, 0.6]}}, r"grid.counter_body_poissons_ratio\[1\]: you gave 0.6"),
        ({"grid": {"body_rms_gradient": [-1]}}, r"grid.body_rms_gradient\[0\]: you gave -1; gfmd allows a number"),
        (
            {
                "scene": TWO | {"loading": {"displacement": 1e-3}, "body": TWO["body"] | {"aspect_ratio": 1}},
                "grid": {"counter_body_aspect_ratio": [0.5, float("inf")]},
            },
            r"grid.counter_body_aspect_ratio\[1\]: you gave inf; gfmd allows a finite aspect_ratio",
        ),
        (
            {"scene": TWO | {"counter_body": ALUMINIUM | {"aspect_ratio": 1e-4, "roughness": ROUGH}}},
            r"scene.counter_body.roughness: you gave a topography from .*; gfmd allows one within the height of the "
            r"body",
        ),
    ],
)
def test_what_a_campaign_of_bodies_cannot_be_is_said_with_its_place(changes, said):
    with pytest.raises(InputError, match=said):
        plan(of(TWO) | changes)


@pytest.mark.long
def test_a_realisation_that_reaches_through_its_body_fails_with_a_sentence(tmp_path, monkeypatch):
    monkeypatch.setattr("gfmd_numba.campaign.cases._BLOCK_SAMPLES", 256)  # one realisation a block
    surface = plan(of(TWO)).problems[0].surface
    highest = [float(abs(surface.parts[1].drawn(i)).max()) for i in range(20)]
    i = next(i for i in range(1, 20) if highest[i] > highest[0])
    thin = ALUMINIUM | {"aspect_ratio": 0.5 * (highest[0] + highest[i]), "roughness": TWO["counter_body"]["roughness"]}
    with pytest.warns(UserWarning, match=f"^crashed in 1 of {i + 1} simulations: "):
        found = gfmd_numba.run(of(TWO | {"counter_body": thin}, realisations=i + 1), tmp_path / "out", workers=0)
    assert int(found["status"][0, 0]) == 0
    assert int(found["status"][0, i]) != 0
    assert "a topography from" in found.attrs["failures"]


def test_steep_bodies_are_doubted_in_plan_and_results(tmp_path):
    steep = TWO | {"body": STEEL | {"roughness": ROUGH | {"rms_gradient": 0.05}}}
    assert plan(of(TWO)).validity == ""
    assert "an rms gradient of up to 0.05, above 0.03: " in plan(of(steep)).validity
    film = WALL | {"body": ALUMINIUM | {"aspect_ratio": 0.02, "roughness": ROUGH}}
    assert "changes its thickness" in plan(of(film, numerics={"topography_order": 0})).validity
    assert plan(of(film)).validity == ""
    (tmp_path / "steep.yaml").write_text(yaml.safe_dump(of(steep)))
    assert "above 0.03: " in gfmd("check", tmp_path / "steep.yaml").stderr.replace("\n      ", " ")


def test_memory_is_counted_for_one_realisation_at_a_time():
    many, one = (plan(of(TWO, realisations=count)).worker_bytes for count in (50, 1))
    assert many == one == (128 + 2 * 48 + 56) * 8 * 256


def test_a_campaign_of_bodies_is_loaded_without_reading_a_surface():
    campaign, _ = load_campaign(of(TWO))
    assert campaign.n_cases == 1
