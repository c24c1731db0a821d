"""What `gfmd accuracy` measures of rough elastic bodies: their surfaces refined like any other, and their orders."""

import numpy as np
import pytest
import yaml

import gfmd_numba
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.work_precision import Study, study_of
from gfmd_numba.scene import InputError
from support.command_line import gfmd
from support.rough_bodies import BODY, ROUGH, rough

EPS = {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}
SCENE = {"interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.02}}
BODIES = {"body": rough(rms_gradient=0.02), "counter_body": BODY | {"youngs_modulus": 2.0, "roughness": ROUGH}}


def of(scene, order=0, **more):
    """Mapping of a campaign of these parts of a scene."""
    whole = {"name": "rough", "seed": 3, "realisations": 2, "scene": SCENE | scene, "reference": EPS}
    return whole | ({"numerics": {"topography_order": order}} if "roughness" in scene["body"] else {}) | more


@pytest.mark.parametrize(
    ("axis", "dimension"),
    [pytest.param("eps_c", 1, marks=pytest.mark.long), pytest.param("eps_f", 2, marks=pytest.mark.long), ("eps_t", 1)],
)
def test_at_order_0_the_errors_are_those_of_the_rigid_punch_with_the_same_roughness(axis, dimension):
    """Half-spaces, which the flat bodies are: pressed into each other they are a rigid punch on one body."""
    eps = EPS if dimension == 1 else EPS | {"eps_c": 1 / 2, "eps_f": 1 / 4}
    half_space = {"poissons_ratio": 0.33, "youngs_modulus": 1.0}
    scenes = {"body": half_space | {"roughness": ROUGH}}, {"body": half_space, "roughness": ROUGH}
    body, punch = (
        [
            (point.curve, point.setting, point.error)
            for point in study_of(plan(of(scene | {"dimension": dimension}, reference=eps)), 3).discretisation(axis)
        ]
        for scene in scenes
    )
    assert len(body) >= 3
    for mine, its in zip(body, punch, strict=True):
        assert mine[:2] == its[:2]
        assert mine[2] == pytest.approx(its[2], abs=1e-5)


def test_a_level_is_the_one_of_a_campaign_with_that_limit():
    study = study_of(plan(of(BODIES, 2)), 2)
    limited = plan(of(BODIES, 2, limits={"eps_f": [1 / 16]}))
    known = {case.discretisation.eps_f: case.problem for case in limited.cases}
    finer = study.case.discretisation.model_copy(update={"eps_f": 1 / 16})
    assert study._at(finer).identity == known[1 / 16].identity != known[1 / 8].identity


@pytest.mark.long
def test_what_the_next_order_adds_is_told_of_every_order():
    points = list(study_of(plan(of(BODIES, 2)), 2).orders())
    assert [point.setting for point in points] == [0, 1, 2]
    for point in points:
        files = [of(BODIES, int(point.setting)) | {"realisation": i} for i in range(2)]
        left_out = ("name", "realisations", "reference")
        solved = [
            gfmd_numba.solve({k: v for k, v in file.items() if k not in left_out} | {"discretisation": EPS})
            for file in files
        ]
        assert point.next_order == pytest.approx(np.mean([float(each["next_order"]) for each in solved]), rel=1e-4)
    assert points[0].next_order > 5 * points[1].next_order > 25 * points[2].next_order


def test_orders_are_not_studied_where_order_0_is_all_or_another_body():
    layers = [{"height": 0.25, "youngs_modulus": modulus, "poissons_ratio": 0.3} for modulus in (1.0, 2.0)]
    coated = {"body": {"layers": layers, "base": "rigid", "roughness": ROUGH}}
    assert list(study_of(plan(of(coated)), 2).orders()) == []
    assert list(study_of(plan(of({"body": {"poissons_ratio": 0.3}, "roughness": ROUGH})), 2).orders()) == []


@pytest.mark.long
def test_the_command_prints_the_error_of_the_order_and_that_of_the_grid(tmp_path, monkeypatch):
    monkeypatch.setattr(Study, "solvers", lambda study: iter(()))  # the longest study, and one of many tests
    monkeypatch.setattr(Study, "axes", ("eps_f",))  # one of three alike
    monkeypatch.chdir(tmp_path)  # a path longer than a line is never folded
    (tmp_path / "rough.yaml").write_text(yaml.safe_dump(of({"body": rough(rms_gradient=0.02)}, 2)))
    done = gfmd("accuracy", "rough.yaml", "-o", "a.nc", "--realisations", "2")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "a.png").stat().st_size > 10_000
    assert "topography order" in done.output
    assert max(map(len, done.stdout.splitlines())) <= 80
    header = done.stdout.split("costs: eps_f")[1].splitlines()[3:6]
    assert [" ".join(line.split()) for line in header] == [
        "order",
        "relative error processor",
        "setting error (L_x) time transforms",
    ]


def test_measured_surfaces_of_bodies_are_refused_as_those_of_a_punch_are(tmp_path):
    np.save(tmp_path / "h.npy", 1e-3 * np.cos(2 * np.pi * np.arange(64) / 64))
    measured = {"method": "measured", "file": str(tmp_path / "h.npy"), "units": {"z": "L_x"}}
    campaign = {
        key: value for key, value in of({"body": BODY | {"roughness": measured}}).items() if key in ("name", "scene")
    }
    with pytest.raises(InputError, match=r"scene.body.roughness.method: .*a random surface for `gfmd accuracy`"):
        study_of(plan(campaign))
