"""Scenes whose bodies creep or whose punch wears: their units, what they refuse, and what campaigns make of them."""

import copy

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.contact import time_steps
from gfmd_numba.scene import InputError
from support.viscoelastic import compliance

CREEP = {
    "scene": {
        "length": "1 mm",
        "body": {"youngs_modulus": "3 MPa", "poissons_ratio": 0.5, "relaxation": [{"modulus": "9 MPa", "time": "1 s"}]},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1},
        "interface": {"hard_wall": {}},
        "loading": {"pressure": "20 kPa"},
    },
    "path": [{"duration": "6 s"}, {"duration": "1 min", "pressure": "10 kPa"}],
    "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2},
    "seed": 1,
}
PAIR = copy.deepcopy(CREEP)
PAIR["scene"]["counter_body"] = PAIR["scene"]["body"] | {"youngs_modulus": "1 MPa"}
PAIR["scene"]["counter_body"]["roughness"] = PAIR["scene"].pop("roughness")
WEAR = copy.deepcopy(CREEP)
del WEAR["scene"]["body"]["relaxation"]
WEAR["scene"]["interface"]["wear"] = {"rate": "1e-8 m^2/N"}
WEAR["path"] = [{"sliding": "5 mm"}]


def changed(file, *keys, **values):
    """The same file with other values at a place; `None` removes one."""
    found = copy.deepcopy(file)
    place = found
    for key in keys:
        place = place[key]
    for name, value in values.items():
        place[name] = value
        if value is None:
            del place[name]
    return found


@pytest.mark.long
def test_times_are_in_seconds_and_only_their_ratios_count():
    quick = CREEP | {"numerics": {"time_tolerance": 0.05}}
    found = gfmd_numba.solve(quick)
    assert found["time"].units == "s"
    np.testing.assert_allclose(found["time"], [0.0, 6.0, 66.0])
    slow = changed(quick, path=[{"duration": 360.0}, {"duration": 3600.0, "pressure": "10 kPa"}])
    slow["scene"]["body"]["relaxation"] = [{"modulus": "9 MPa", "time": "1 min"}]
    others = gfmd_numba.solve(slow)
    for name in ("pressure", "gap", "displacement", "energy_lost", "time_error"):
        np.testing.assert_array_equal(found[name], others[name])
    bare = changed(quick, "scene", length=None, loading={"reduced_pressure": 0.02 / 4.0 / 0.1})
    bare["scene"]["body"] = {"poissons_ratio": 0.5, "relaxation": [{"modulus": 3.0, "time": 1.0}]}
    bare["path"] = [{"duration": 6.0}, {"duration": 60.0, "reduced_pressure": 0.01 / 4.0 / 0.1}]
    ratios = gfmd_numba.solve(bare)
    np.testing.assert_allclose(found["contact_area_fraction"], ratios["contact_area_fraction"], rtol=1e-12)


REFUSED = {
    "duration of elastic bodies": (
        changed(WEAR, path=[{"duration": 1.0, "sliding": "1 mm"}]),
        "path[0].duration: you gave 1.0; gfmd allows nothing without a relaxation of the body",
    ),
    "duration of the first load": (
        changed(WEAR, "scene", loading={"pressure": "20 kPa", "duration": 1.0}),
        "scene.loading.duration: you gave 1.0; gfmd allows nothing without a relaxation of the body",
    ),
    "tolerance of elastic bodies": (
        changed(WEAR, "scene", "interface", wear=None) | {"numerics": {"time_tolerance": 1e-3}, "path": []},
        "numerics.time_tolerance: you gave 0.001; gfmd allows nothing without a relaxation of the body or wear, as",
    ),
    "wear without a way": (changed(WEAR, path=[{"pressure": "10 kPa"}]), "scene.interface.wear: you gave"),
    "wear with friction that drags a half-space along": (
        changed(WEAR, "scene", "interface", friction={"coefficient": 0.3}),
        "path[0].sliding: you gave '5 mm'; gfmd allows nothing without a finite aspect_ratio",
    ),
    "wear of nodes that stick": (
        changed(changed(WEAR, "scene", "interface", friction={"coefficient": np.inf}), "scene", "body", aspect_ratio=1),
        "scene.interface.wear: you gave ... gfmd allows nothing with an infinite coefficient of friction",
    ),
    "a speed with friction": (
        changed(changed(CREEP, "scene", "loading", speed="1 mm/s"), "scene", "interface", friction={"coefficient": 0.3})
        | {"path": []},
        "scene.interface.friction: you gave ... gfmd allows no friction with a sliding speed",
    ),
    "friction that drags a half-space along": (
        changed(
            changed(CREEP, "scene", "interface", friction={"coefficient": 0.3}),
            path=[{"sliding": "1 um", "duration": 1.0}],
        ),
        "path[0].sliding: you gave '1 um'; gfmd allows nothing without a finite aspect_ratio",
    ),
    "creep of two bodies that give way differently": (
        changed(PAIR, "scene", "counter_body", aspect_ratio=0.3),
        "scene.counter_body: you gave ... gfmd allows a counter_body that gives way as the body does",
    ),
    "creep of two bodies that rub": (
        changed(PAIR, "scene", "interface", friction={"coefficient": 0.3}),
        "scene.counter_body: you gave ... gfmd allows a counter_body that gives way as the body does",
    ),
    "slopes of bodies that creep": (
        PAIR | {"numerics": {"topography_order": 1}},
        "numerics.topography_order: you gave 1; gfmd allows 0, or nothing, with a viscoelastic body",
    ),
    "a rough body that slides": (
        changed(PAIR, path=[{"sliding": "1 mm", "duration": 1.0}]),
        "path[0].sliding: you gave '1 mm'; gfmd allows no sliding over a viscoelastic body, or a rigid punch on one",
    ),
    "two bodies at a speed": (
        changed(PAIR, "scene", "loading", speed="1 mm/s") | {"path": []},
        "scene.counter_body: you gave ... gfmd allows a rigid punch on one smooth body with a sliding speed",
    ),
    "a speed with adhesion": (
        changed(
            changed(CREEP, "scene", "loading", speed="1 mm/s"),
            "scene",
            "interface",
            exponential={"work_of_adhesion": "1 mJ/m^2", "range": "10 um"},
        )
        | {"path": []},
        "scene.interface.exponential: you gave ... gfmd allows a hard_wall alone with a sliding speed",
    ),
    "a way with adhesion": (
        changed(
            changed(CREEP, path=[{"sliding": "1 mm", "duration": 1.0}]),
            "scene",
            "interface",
            exponential={"work_of_adhesion": "1 mJ/m^2", "range": "10 um"},
        ),
        "path[0].sliding: you gave '1 mm'; gfmd allows no sliding over a viscoelastic body, or a hard_wall alone",
    ),
    "a speed later on": (
        changed(CREEP, path=[{"speed": "1 mm/s"}]),
        "path[0].speed: you gave '1 mm/s'; gfmd allows a speed where the loading has one",
    ),
    "a speed and a duration": (
        changed(CREEP, "scene", "loading", speed="1 mm/s", duration="1 s") | {"path": []},
        "scene.loading.duration: you gave '1 s'; gfmd allows nothing with a sliding speed",
    ),
    "a speed and a way": (
        changed(changed(CREEP, path=[{"sliding": "1 mm"}]), "scene", "loading", speed="1 mm/s"),
        "path[0].sliding: you gave '1 mm'; gfmd allows nothing with a sliding speed",
    ),
    "a speed over elastic bodies": (
        changed(changed(WEAR, "scene", "loading", speed="1 mm/s"), "scene", "interface", wear=None) | {"path": []},
        "scene.loading.speed: you gave '1 mm/s'; gfmd allows nothing without a relaxation of the body",
    ),
    "a speed without a period": (
        changed(CREEP, "scene", periodic=False, loading={"pressure": "20 kPa", "speed": "1 mm/s"}) | {"path": []},
        "scene.periodic: you gave false; gfmd allows true with a sliding speed, whose wake may be longer",
    ),
    "a solver of symmetric problems": (
        changed(CREEP, "scene", "loading", speed="1 mm/s") | {"path": [], "numerics": {"solver": "active_set_newton"}},
        "numerics.solver: you gave 'active_set_newton'; gfmd allows 'sliding_newton' or 'auto' with a sliding speed",
    ),
    "a time of nothing": (
        changed(CREEP, path=[{"duration": 0.0}]),
        "path[0].duration: you gave 0.0; gfmd allows a number from 1e-30 to 1e+30",
    ),
    "a time in another unit": (changed(CREEP, path=[{"duration": "6 m"}]), "path[0].duration: you gave '6 m'"),
    "no branch": (changed(CREEP, "scene", "body", relaxation=[]), "scene.body.relaxation: you gave"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_does_not_go_together_is_refused_where_it_stands(name):
    file, said = REFUSED[name]
    with pytest.raises(InputError) as refused:
        gfmd_numba.solve(file)
    start, _, end = said.partition(" ... ")
    assert str(refused.value).startswith(start)
    assert end in str(refused.value)
    assert "\n" not in str(refused.value)  # and nowhere else


@pytest.mark.long
def test_a_path_of_a_campaign_takes_time_as_that_of_a_scene_does(tmp_path):
    campaign = {key: CREEP[key] for key in ("scene", "path", "seed")}
    campaign |= {"name": "creep", "realisations": 2, "reference": CREEP["discretisation"]}
    results = gfmd_numba.run(campaign, tmp_path / "creep")
    alone = gfmd_numba.solve(CREEP)
    for name in ("contact_area_fraction", "mean_gap", "energy_lost", "time_error"):
        np.testing.assert_array_equal(results[name][0, 0], alone[name])
    np.testing.assert_array_equal(results["step_time"][0], alone["time"])


@pytest.mark.long
def test_the_limit_of_a_contact_that_has_crept_is_the_elastic_one_of_the_creep_compliance(tmp_path):
    """Lee and Radok, of each of its discretisations and so of what these tend to."""
    fixed = {"eps_c": 2.0, "eps_f": 0.7}
    campaign = {key: CREEP[key] for key in ("scene", "seed")} | {"path": CREEP["path"][:1], "name": "creep"}
    campaign |= {"realisations": 2, "reference": CREEP["discretisation"], "fit": {"fixed": fixed}}
    campaign |= {"limits": {"eps_c": [1], "eps_f": [1 / 4]}, "numerics": {"time_tolerance": 1e-2}}
    found = gfmd_numba.fit_tfc(gfmd_numba.run(campaign, tmp_path / "creep"), "kappa", fixed=fixed, step=1)
    softer = compliance(((3.0, 1.0),), 6.0)
    elastic = changed(campaign, "scene", "body", relaxation=None) | {"numerics": {}}
    elastic["scene"]["loading"] = {"pressure": softer * 20e3}
    del elastic["path"]
    expected = gfmd_numba.fit_tfc(gfmd_numba.run(elastic, tmp_path / "elastic"), "kappa", fixed=fixed)
    assert float(found["kappa_tfc"][0]) == pytest.approx(softer * float(expected["kappa_tfc"][0]), rel=5e-3)
    budget = float(found["error_budget"].sel(source="residual")[0] / found["kappa_tfc"][0])
    assert 5e-4 < budget < 5e-2  # what the divisions of time leave open


@pytest.mark.long
def test_the_limit_of_what_has_worn_off_is_that_of_archard(tmp_path):
    fixed = {"eps_c": 2.0}
    campaign = {key: WEAR[key] for key in ("scene", "path", "seed")} | {"name": "wear", "realisations": 3}
    campaign |= {"reference": CREEP["discretisation"], "limits": {"eps_c": [1 / 2, 1 / 8]}}
    campaign |= {"numerics": {"time_tolerance": 0.1}}
    results = gfmd_numba.run(campaign | {"fit": {"fixed": fixed, "variable": "mean_worn_depth"}}, tmp_path / "wear")
    found = gfmd_numba.fit_tfc(results, "mean_worn_depth", fixed=fixed, step=1)
    assert float(found["mean_worn_depth_tfc"][0]) == pytest.approx(1e-8 * 20e3 * 5e-3, rel=1e-8, abs=0.0)


@pytest.mark.long
def test_a_campaign_slides_at_one_speed_after_another(tmp_path):
    scene = changed(CREEP["scene"], "loading", speed="1 mm/s")
    campaign = {"name": "friction", "seed": 1, "realisations": 2, "scene": scene, "reference": CREEP["discretisation"]}
    results = gfmd_numba.run(campaign | {"grid": {"speed": ["1 um/s", 1e-3]}}, tmp_path / "friction")
    assert results["speed"].units == "m s-1"
    np.testing.assert_array_equal(results["speed"], [1e-6, 1e-3])
    alone = {key: CREEP[key] for key in ("discretisation", "seed")} | {"scene": scene}
    for name in ("hysteretic_friction", "hysteretic_friction_error", "contact_area_fraction"):
        np.testing.assert_array_equal(results[name][1, 0], gfmd_numba.solve(alone)[name])
    assert "time_error" not in results


def test_one_load_may_take_time_without_a_path():
    alone = {key: value for key, value in changed(CREEP, "scene", "loading", duration="2 s").items() if key != "path"}
    alone["numerics"] = {"time_tolerance": 0.1}
    found = gfmd_numba.solve(alone)
    first = gfmd_numba.solve(alone | {"path": [{"duration": "1 s"}]}).isel(step=0)
    assert float(found["time"]) == 2.0
    for name in ("pressure", "gap"):
        np.testing.assert_allclose(found[name], first[name], atol=2e-2 * float(abs(found[name]).max()))


def test_what_the_divisions_do_not_reach_is_said(monkeypatch):
    monkeypatch.setattr(time_steps, "HALVINGS", 1)
    with pytest.warns(UserWarning, match="the divisions of steps leave an error of"):
        found = gfmd_numba.solve(CREEP)
    assert float(found["time_error"].max()) > 1e-3


def test_fields_inside_a_creeping_body_are_refused():
    with pytest.raises(InputError, match="viscoelastic body"):
        gfmd_numba.body_fields(gfmd_numba.solve(CREEP | {"path": []}), z=[-1e-5])


TIMES = [0.5, "4 s", "1 min"]


def test_a_creep_curve_is_the_path_of_its_times_and_a_mean_over_surfaces():
    alone = {key: value for key, value in CREEP.items() if key != "path"} | {"numerics": {"time_tolerance": 0.05}}
    curve = gfmd_numba.load_curve(alone, times=TIMES, realisations=2)
    np.testing.assert_allclose(curve["time"], [0.5, 4.0, 60.0])
    assert curve["time"].units == "s"
    assert curve.attrs["title"] == "creep curve"
    dwells = [{"duration": each} for each in (0.5, 3.5, 56.0)]
    paths = [gfmd_numba.solve(alone | {"path": dwells, "realisation": i}) for i in range(2)]
    for name in ("contact_area_fraction", "mean_gap", "peak_pressure"):
        means = 0.5 * sum(each[name].values[1:] for each in paths)
        np.testing.assert_allclose(curve[name], means, rtol=1e-12)
    assert (curve["n_realisations"] == 2).all()
    assert "contact_stiffness" not in curve
    assert {"time_error", "mean_gap_standard_error"} <= set(curve)


@pytest.mark.parametrize(
    ("file", "times", "said"),
    [
        (CREEP, TIMES, "path: you gave a path of 2 steps; gfmd allows no path"),
        ({key: WEAR[key] for key in WEAR if key != "path"}, TIMES, "gfmd allows nothing without a relaxation"),
        ({key: CREEP[key] for key in CREEP if key != "path"}, [2.0, 1.0], "times[1]: you gave 1.0; gfmd allows times"),
        ({key: CREEP[key] for key in CREEP if key != "path"}, [1.0, 1.0], "times[1]: you gave 1.0; gfmd allows times"),
        (
            {key: CREEP[key] for key in CREEP if key != "path"},
            [0.0, 1.0],
            "times[0]: you gave 0.0; gfmd allows a number",
        ),
        ({key: CREEP[key] for key in CREEP if key != "path"}, ["1 m"], "times[0]: you gave '1 m'; gfmd allows"),
        (
            {key: value for key, value in changed(CREEP, "scene", "loading", duration=2.0).items() if key != "path"},
            [1.0],
            "times[0]: you gave 1.0; gfmd allows times after the duration of the loading, 2 s",
        ),
    ],
)
def test_times_that_make_no_sense_are_refused(file, times, said):
    if "wear" in file["scene"]["interface"]:
        file = changed(file, "scene", "interface", wear=None)
    with pytest.raises(InputError) as refused:
        gfmd_numba.load_curve(file, times=times)
    assert said in str(refused.value)


def test_loads_one_after_another_need_an_elastic_body():
    alone = {key: value for key, value in CREEP.items() if key != "path"}
    with pytest.raises(InputError, match=r"loads: you gave .*; gfmd allows times, or speeds, for a viscoelastic body"):
        gfmd_numba.load_curve(alone, [0.01, 0.02])
