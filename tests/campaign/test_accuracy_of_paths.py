"""What `gfmd accuracy` measures along a loading path: the worst step, what the path has as a whole, and its steps."""

from itertools import pairwise

import numpy as np
import pytest
import yaml

import gfmd_numba
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.work_precision import Study, study_of
from support.command_line import gfmd

LOADS = [0.02, 0.1, 0.05]
SCENE = {
    "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": LOADS[0]},
}
LOADED = {
    "name": "loaded",
    "seed": 1,
    "realisations": 2,
    "scene": SCENE,
    "reference": {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2},
    "path": [{"reduced_pressure": load} for load in LOADS[1:]],
}
DRAGGED = LOADED | {
    "scene": SCENE | {"interface": {"hard_wall": {}, "friction": {"coefficient": 0.1}}},
    "path": [{"sliding": 4e-4}, {"sliding": -4e-4}],
}
TENSION = LOADED | {
    "scene": SCENE
    | {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.25},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1e-4, "range": 4e-3}},
        "loading": {"displacement": -1e-3},
    },
    "path": [{"displacement": -1e-3 - 7.5e-4 * step} for step in range(1, 3)],  # short: nothing seems to be lost
}


def under(load):
    """The campaign under one of the loads alone."""
    alone = {key: value for key, value in LOADED.items() if key != "path"}
    return alone | {"scene": SCENE | {"loading": {"reduced_pressure": load}}}


@pytest.mark.long
@pytest.mark.parametrize("study", ["eps_c", "surfaces"])  # all eps are varied alike
def test_the_error_of_a_path_is_that_of_the_load_where_it_is_largest(study):
    """A contact without friction and adhesion does not remember how it was loaded."""
    whole, *each = (
        [
            point.error
            for point in (
                study_of(plan(campaign), 3).sampling()
                if study == "surfaces"
                else study_of(plan(campaign), 3).discretisation(study)
            )
        ]
        for campaign in (LOADED, *map(under, LOADS))
    )
    assert len(whole) >= 2
    assert whole == pytest.approx(np.max(each, axis=0).tolist(), abs=1e-6)


@pytest.mark.long
def test_dividing_a_step_is_walking_the_path_in_so_many(tmp_path):
    """The study against campaigns whose files have the shorter steps."""
    points = list(study_of(plan(DRAGGED), 2).load_steps())
    assert [point.setting for point in points] == [1, 2, 4]
    means = {}
    for number in (1, 2, 4, 8):
        ends = [0.0, 4e-4, -4e-4]
        way = [a + (b - a) * i / number for a, b in pairwise(ends) for i in range(1, number + 1)]
        found = gfmd_numba.run(DRAGGED | {"path": [{"sliding": s} for s in way]}, tmp_path / str(number))
        means[number] = float(found["hysteresis"].mean())
    for point in points:
        assert point.hysteresis_error == pytest.approx(abs(means[point.setting] / means[8] - 1.0), rel=1e-4)
    assert points[0].hysteresis_error > 3 * points[2].hysteresis_error


def test_the_steps_of_a_path_without_memory_are_not_divided():
    assert list(study_of(plan(LOADED), 2).load_steps()) == []


@pytest.mark.long
def test_under_tension_the_error_is_that_of_the_contact_area():
    points = list(study_of(plan(TENSION), 2).discretisation("eps_c"))
    assert {point.variable for point in points} == {"contact_area_fraction"}
    assert {point.curve for point in points} == {"counted", "corrected on average"}
    assert all(np.isfinite(point.error) for point in points)
    assert np.isnan([point.hysteresis_error for point in points]).all()  # nothing is lost that has an error
    assert all(point.error > 0 for point in study_of(plan(TENSION), 2).sampling())


@pytest.mark.long
def test_the_command_prints_and_draws_what_a_path_is_off_by(tmp_path, monkeypatch):
    monkeypatch.setattr(Study, "solvers", lambda study: iter(()))  # the longest study, and one of many tests
    monkeypatch.setattr(Study, "axes", ("eps_c",))  # one of three alike
    monkeypatch.chdir(tmp_path)  # a path longer than a line is never folded
    coarse = DRAGGED | {"reference": {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2}}
    (tmp_path / "dragged.yaml").write_text(yaml.safe_dump(coarse))
    done = gfmd("accuracy", "dragged.yaml", "-o", "a.nc", "--realisations", "2")
    assert done.exit_code == 0, done.output
    assert "what accuracy costs: load steps" in done.output
    assert "hysteresis" in done.output
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert (tmp_path / "a.png").stat().st_size > 10_000
