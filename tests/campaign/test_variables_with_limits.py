"""Which variables may be targets: those that have a limit, by the table of observables and the scaling of a scene."""

from pathlib import Path

import pytest

import gfmd_numba
from gfmd_numba.campaign import goal
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.goal import Goal
from gfmd_numba.campaign.run import run_until
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.contact.observables import LIMITED, OBSERVABLES, PATH_OBSERVABLES
from gfmd_numba.scene import InputError
from gfmd_numba.theory.exponent_ranges import exponent_ranges
from support import synthetic_campaigns as synthetic
from support.campaigns import campaign
from support.command_line import refused

SCENE = {
    "body": {"poissons_ratio": 0.3, "aspect_ratio": float("inf"), "youngs_modulus": 1e9},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"pressure": 5e5},
}
BY_HEIGHT = SCENE | {
    "roughness": {"method": "psd", "hurst": 0.8, "rms_height": 1e-5},
    "loading": {"pressure": 6e3},
}
LEVELS = {
    "reference": {"eps_c": 1 / 2, "eps_f": 1 / 64, "eps_t": 1 / 2},
    "limits": {"eps_c": [1 / 4], "eps_f": [1 / 4, 1 / 16]},
}
HARD = {"interface": {"hard_wall": {"hardness": 3e6}}}
RUBBER = {"body": {"poissons_ratio": 0.5, "youngs_modulus": 1e9, "relaxation": [{"modulus": 3e9, "time": 1.0}]}}
SLIDING = RUBBER | {"length": 1e-3, "loading": {"pressure": 6e3, "speed": 1e-4}}
DRAGGED = {
    "body": {"poissons_ratio": 0.5, "aspect_ratio": 1.0, "youngs_modulus": 1e9},
    "interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}},
}
DRAG = {"path": [{"sliding": 1e-6}]}


def loaded(scene, variable, **file):
    return load_campaign({"name": "limits", "seed": 1, "scene": scene, "target": {variable: 0.05}} | file)[0]


@pytest.mark.parametrize("name", [name for name in OBSERVABLES | PATH_OBSERVABLES if name not in LIMITED])
def test_what_has_no_limit_is_refused_with_the_reason(name):
    why = rf"{name} has no limit, because \w"
    with pytest.raises(InputError, match=rf"target: you gave .*; {why}"):
        loaded(SCENE, name)
    with pytest.raises(InputError, match=rf"until: you gave '{name}'; gfmd allows one of kappa, .*; {why}"):
        gfmd_numba.run({}, until={name: 0.05})


@pytest.mark.parametrize("given", ["gap", "mean_gab"])
def test_the_nearest_variable_is_told(given):
    with pytest.raises(InputError, match=r"until: .*; did you mean 'mean_gap'\?"):
        gfmd_numba.run({}, until={given: 0.05})
    with pytest.raises(InputError, match=r"target: .*; did you mean 'mean_gap'\?"):
        loaded(SCENE, given)


def test_the_command_tells_the_reason(tmp_path):
    assert "mean_segment_length has no limit, because" in refused(
        "run", campaign(tmp_path), "-o", tmp_path / "out", "--until=mean_segment_length=5%"
    )


@pytest.mark.parametrize(
    ("scene", "variable", "told"),
    [
        (SCENE, "mean_gap", "with a fixed rms_gradient the heights vanish as eps_f and eps_t go to 0; give"),
        (BY_HEIGHT, "mean_gap", "the roughness becomes ever steeper as eps_t goes to 0; give a reference"),
        (BY_HEIGHT, "contact_area_fraction", r"the gradient g grows without bound .* p / \(g E\*\) falls to 0"),
        (BY_HEIGHT, "rms_gradient_contact", "the gradient g grows without bound"),
        (BY_HEIGHT | HARD, "kappa", "the gradient g grows without bound"),
        (BY_HEIGHT, "kappa", r"p / \(g E\*\) falls to 0"),
        (
            BY_HEIGHT | {"loading": {"reduced_pressure": 0.05}},
            "mean_gap",
            "with a fixed rms_height and reduced_pressure the pressure grows",
        ),
    ],
)
def test_what_vanishes_or_grows_in_a_scene_is_refused_with_the_reason(scene, variable, told):
    with pytest.raises(InputError, match=rf"target.{variable}: .*; {variable} has none, because .*{told}"):
        loaded(scene, variable)


@pytest.mark.parametrize(
    ("scene", "variable", "file"),
    [
        (SLIDING, "hysteretic_friction", {}),
        (DRAGGED, "stick_fraction", DRAG),
        (HARD, "energy_lost", {"path": [{"pressure": 6e5}]}),
    ],
)
def test_what_follows_the_heights_vanishes_at_a_fixed_gradient(scene, variable, file):
    with pytest.raises(InputError, match=rf"{variable} has none, because with a fixed rms_gradient the heights vanish"):
        loaded(SCENE | scene, variable, **file)


@pytest.mark.parametrize(
    ("scene", "variable", "file"),
    [
        (SCENE, "rms_gradient_contact", {}),
        (SCENE, "contact_area_fraction", {}),
        (SCENE | HARD, "plastic_area_fraction", {}),
        (BY_HEIGHT, "mean_gap", LEVELS),
        (BY_HEIGHT, "elastic_energy", LEVELS),
        (BY_HEIGHT | SLIDING, "hysteretic_friction", LEVELS),
        (BY_HEIGHT | DRAGGED, "stick_fraction", LEVELS | DRAG),
        (SCENE | DRAGGED, "energy_lost", DRAG),
        (BY_HEIGHT | {"loading": {"reduced_pressure": 0.05}}, "contact_area_fraction", {}),
        (SCENE, "mean_gap", {**LEVELS, "limits": {"eps_c": [1 / 4, 1 / 8]}}),
    ],
)
def test_what_has_a_limit_in_a_scene_is_a_target(scene, variable, file):
    assert loaded(scene, variable, **file).fit.variable == variable


def test_the_page_tells_what_has_a_limit():
    page = (Path(__file__).parents[2] / "docs" / "limit.md").read_text()
    told = page.split("## Which variables have a limit")[1].split("## ")[0]
    variants = ("kappa_", "contact_area_fraction_counted", "mean_tangential_traction_y")
    assert [name for name in LIMITED if f"`{name}`" not in told and not name.startswith(variants)] == []


@pytest.mark.parametrize("variable", ["peak_pressure", "mean_segment_length"])
def test_what_never_has_a_limit_is_fitted_nowhere(variable):
    with pytest.raises(InputError, match=rf"variable: you gave '{variable}'; .*{variable} has no limit, because"):
        gfmd_numba.fit_tfc(synthetic.campaign(), variable=variable)


def test_what_the_contacts_do_not_have_is_refused():
    with pytest.raises(InputError, match=r"target.plastic_area_fraction: .* this needs a hardness of the hard_wall"):
        loaded(SCENE, "plastic_area_fraction")
    with pytest.raises(InputError, match=r"target.stick_fraction: .* as this campaign has no path"):
        loaded(SCENE, "stick_fraction")
    with pytest.raises(InputError, match=r"target.stick_fraction: .* nodes stick or slip where there is friction"):
        loaded(SCENE, "stick_fraction", path=[{"pressure": 6e5}])


def test_levels_that_are_chosen_take_the_ranges_of_the_variable():
    for variable, of_a_law in (("contact_area_fraction_counted", {"eps_f": None}), ("rms_gradient_contact", {})):
        fixed = loaded(SCENE, variable).fit.fixed
        expected = {**exponent_ranges(variable, 1, 0.8), **of_a_law}
        assert {name: getattr(fixed, name) for name in expected} == expected
    assert exponent_ranges("kappa", 1, 0.8)["eps_c"] == (2.0, 3.0)


@pytest.mark.long
def test_a_limit_of_zero_is_never_reached(tmp_path):
    """The hardness is far above all pressures: nothing yields."""
    scene = SCENE | {"interface": {"hard_wall": {"hardness": 1e12}}}
    file = {"name": "zero", "seed": 1, "scene": scene} | LEVELS
    outcome = run_until(file, Goal(targets={"plastic_area_fraction": 0.05}), tmp_path / "out", Workers(0))
    assert "not reached: it is 0 in all realisations of a case" in outcome.rounds.ended


@pytest.mark.long
def test_a_mean_gap_reaches_its_target(tmp_path):
    """At a fixed rms height, where contacts of a finite ratio of the wavelengths have a gap."""
    known = {"fit": {"exponents": "free", "fixed": {"eps_c": [1.5, 4], "eps_f": [0.4, 2]}}}
    file = {"name": "gap", "seed": 1, "scene": BY_HEIGHT} | LEVELS | known
    outcome = run_until(file, Goal(targets={"mean_gap": 0.05}), tmp_path / "out", Workers(0))
    assert outcome.reached
    mean = gfmd_numba.open_campaign(outcome.results)["mean_gap"].mean().item()
    assert 0.5e-5 < mean < 2e-5  # about the rms height


@pytest.mark.long
def test_a_limit_that_vanishes_is_never_reached(tmp_path, monkeypatch):
    """The mean gap at a fixed rms gradient, were it not refused beforehand."""
    monkeypatch.setattr(goal.observables, "unheld", lambda *given: "")
    known = {"fit": {"exponents": "free", "fixed": {"eps_c": [1.5, 4], "eps_f": [0.15, 2]}}}
    scene = SCENE | {"roughness": {"method": "psd", "hurst": 0.3, "rms_gradient": 0.01}}
    file = {"name": "gap", "seed": 1, "scene": scene} | LEVELS | known
    outcome = run_until(file, Goal(targets={"mean_gap": 0.05}), tmp_path / "out", Workers(0))
    assert not outcome.reached
    reasons = ("the limit of mean_gap is 0 within two standard errors", "no law of the limits describes the means")
    assert outcome.rounds.ended.startswith(tuple(f"not reached: {reason}" for reason in reasons))
