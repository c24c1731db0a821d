"""Cross levels of a campaign: several discretisations differ from the reference at once, on the same surfaces."""

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.analysis import plot_campaign, select_limit
from gfmd_numba.campaign.cases import groups
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.plan import plan
from gfmd_numba.cli import main
from support.campaigns import SMALL, campaign
from support.faulty_files import CAMPAIGN, WHOLE, assert_complaint

pytestmark = pytest.mark.usefixtures("undrawn")

CROSS = "cross: [{eps_c: 1/2, eps_f: 1/8}, {eps_f: 1/32, eps_t: 1}]"
WITH_CROSS = {"1/16, 1/32]}": f"1/16, 1/32], {CROSS}}}"}
AXES = ("eps_c", "eps_f", "eps_t")


@pytest.fixture(scope="module")
def crossed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("crossed")
    return gfmd_numba.run(campaign(folder, **WITH_CROSS), folder / "out")


def test_a_cross_level_differs_from_the_reference_in_several_discretisations(tmp_path):
    planned = plan(campaign(tmp_path, **WITH_CROSS))
    assert len(planned.cases) == planned.campaign.n_cases == 2 * 7
    for group in groups(planned.cases):
        levels = [(case.limit, *case.discretisation.model_dump().values()) for case in group[5:]]
        assert levels == [("cross", 1 / 2, 1 / 8, 1 / 2), ("cross", 1 / 4, 1 / 32, 1)]


@pytest.mark.long
def test_cross_levels_change_no_other_case(finished, crossed):
    others = crossed.isel(case=crossed["limit"].values != "cross")
    np.testing.assert_array_equal(others["case_id"], finished["case_id"])
    np.testing.assert_array_equal(others["kappa"], finished["kappa"])


def test_a_cross_case_is_what_a_reference_at_its_discretisation_is(tmp_path, crossed):
    """It has the same surfaces, too: realisation by realisation."""
    text = SMALL.replace("eps_c: 1/4, eps_f: 1/16, eps_t: 1/2", "eps_c: 1/4, eps_f: 1/32, eps_t: 1")
    text = text.replace("limits: {eps_c: [1/2, 1/4, 1/8], eps_f: [1/8, 1/16, 1/32]}", "")
    alone = gfmd_numba.run(campaign(tmp_path, text), tmp_path / "alone")
    second = crossed.isel(case=np.flatnonzero(crossed["limit"].values == "cross")[1::2])
    np.testing.assert_array_equal(second["kappa"], alone["kappa"])
    np.testing.assert_array_equal(second["case_id"], alone["case_id"])


@pytest.mark.parametrize(
    ("given", "counts"), [("cross: [0, 3]", [3]), ("cross: 2", [2, 2]), ("eps_c: 1", [6, 6]), ("cross: [0, 0]", [])]
)
def test_a_cross_level_may_have_realisations_of_its_own_and_none(tmp_path, given, counts):
    changes = WITH_CROSS | {"realisations: 6": f"realisations: {{reference: 6, {given}}}"}
    planned = plan(campaign(tmp_path, **changes))
    for group in groups(planned.cases):
        assert [case.realisations for case in group if case.limit == "cross"] == counts


def test_a_cross_case_is_on_no_axis(crossed):
    for limit, levels in {"eps_c": [1 / 2, 1 / 4, 1 / 8], "eps_f": [1 / 8, 1 / 16, 1 / 32], "eps_t": [1 / 2]}.items():
        assert np.unique(select_limit(crossed, limit)[limit])[::-1].tolist() == levels
        assert "cross" not in select_limit(crossed, limit)["limit"]
    panels = [panel.get_title() for panel in plot_campaign(crossed).axes]
    assert panels == ["Continuum limit", "Fractal limit"]


@pytest.mark.long
def test_a_campaign_with_nothing_but_cross_levels_shows_its_means(tmp_path):
    text = SMALL.replace("eps_c: [1/2, 1/4, 1/8], eps_f: [1/8, 1/16, 1/32]", CROSS)
    path = campaign(tmp_path, text, **{"realisations: 6": "realisations: 2"})
    ran = CliRunner().invoke(main, ["run", str(path), "-o", str(tmp_path / "out"), "--workers=0"])
    assert ran.exit_code == 0, ran.output
    assert "kappa, mean of the realisations" in ran.output
    (panel,) = plot_campaign(gfmd_numba.open_campaign(tmp_path / "out" / "small.nc")).axes
    assert [len(container.lines[0].get_xdata()) for container in panel.containers] == [2]  # the references


def test_cross_cases_are_chosen_planned_checked_and_watched(tmp_path):
    path, out = campaign(tmp_path, **WITH_CROSS | {"[0.3, 0.8]": "[0.8]"}), tmp_path / "out"
    checked = CliRunner().invoke(main, ["check", str(path)])
    assert "a campaign of 7 cases x 6 realisations" in checked.output
    planned = CliRunner().invoke(main, ["plan", str(path), "--pilot=0"])
    assert planned.exit_code == 0, planned.output
    assert "cases         7, of which 7 distinct problems" in planned.output
    ran = CliRunner().invoke(main, ["run", str(path), "-o", str(out), "--workers=0", "--only=limit=cross"])
    assert ran.exit_code == 0, ran.output
    assert "30 of the 42 simulations of the whole campaign have not run yet" in ran.output
    said = CliRunner().invoke(main, ["status", str(out)])
    assert "2 of 7" in said.output
    results = gfmd_numba.open_campaign(out / "small.nc")
    done = results["kappa"].notnull().all("realisation").values
    assert set(results["limit"].values[done]) == {"cross"}
    assert done.sum() == 2


def test_a_mapping_may_have_cross_levels(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = campaign(tmp_path, **WITH_CROSS)
    first = load_campaign(path)[0]
    assert load_campaign(first)[0] == first
    assert load_campaign(yaml.safe_load(load_campaign(first)[1].text))[0] == first


FAULTS = {
    "one discretisation": (
        "cross: [{eps_f: 1/64}]",
        "bad.yaml:10:57: limits.cross[0]: you gave {'eps_f': 0.015625}; gfmd allows a mapping of two or more of "
        "eps_c, eps_f",
    ),
    "no discretisation": (
        "cross: [{}]",
        "bad.yaml:10:57: limits.cross[0]: you gave {}; gfmd allows a mapping of two or more of eps_c, eps_f, eps_t",
    ),
    "none left by nothing": (
        "cross: [{eps_c: 1, eps_f: null}]",
        "bad.yaml:10:57: limits.cross[0]: you gave {'eps_c': 1, 'eps_f': None}; gfmd allows a mapping of two or more "
        "of",
    ),
    "no list": (
        "cross: {eps_c: 1, eps_f: 1/64}",
        "bad.yaml:10:56: limits.cross: you gave {'eps_c': 1, 'eps_f': 0.015625}; gfmd allows a list of one or more "
        "mapp",
    ),
    "an empty list": (
        "cross: []",
        "bad.yaml:10:56: limits.cross: you gave []; gfmd allows a list of one or more mappings of 'eps_c', ",
    ),
    "no mapping": (
        "cross: [1/2]",
        "bad.yaml:10:57: limits.cross[0]: you gave 0.5; gfmd allows a mapping of 'eps_c', 'eps_f', 'eps_t'",
    ),
    "an unknown discretisation": (
        "cross: [{eps_c: 1, eps_x: 1}]",
        "bad.yaml:10:68: limits.cross[0].eps_x: you gave an unknown key; gfmd allows one of 'eps_c', 'eps_f', 'eps_t'",
    ),
    "a value above 1": (
        "cross: [{eps_c: 1, eps_f: 2}]",
        "bad.yaml:10:75: limits.cross[0].eps_f: you gave 2; gfmd allows a number above 0 and at most 1",
    ),
    "a value of the reference": (
        "cross: [{eps_c: 1, eps_t: 1}, {eps_c: 1/4, eps_f: 1/1024}]",
        "bad.yaml:10:99: limits.cross[1].eps_f: you gave 0.0009765625; gfmd allows a value other than the reference's",
    ),
    "a level twice": (
        "cross: [{eps_c: 1, eps_t: 1}, {eps_t: 1, eps_c: 1, eps_f: null}]",
        "bad.yaml:10:79: limits.cross[1]: you gave {'eps_c': 1, 'eps_f': None, 'eps_t': 1}; gfmd allows each value "
        "once",
    ),
    "waves that are not whole": (
        "cross: [{eps_c: 1, eps_t: 1}, {eps_f: 1/64, eps_t: 0.3}]",
        f"bad.yaml:10:100: limits.cross[1].eps_t: you gave 0.3; gfmd allows {WHOLE}eps_c = 0.5 and eps_f = 0.015625; "
        "did",
    ),
    "waves that are not whole, with a reference of whole ones": (
        "cross: [{eps_c: 1/4, eps_f: 2/5, eps_t: 1/3}]",
        f"bad.yaml:10:77: limits.cross[0].eps_f: you gave 0.4; gfmd allows {WHOLE}eps_c = 0.25 and eps_t = 0.333333; "
        "did",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_bad_cross_level_is_refused_where_it_is_wrong(tmp_path, name):
    given, expected = FAULTS[name]
    assert_complaint(tmp_path, load_campaign, CAMPAIGN, ("1/2, 1/4]}", f"1/2, 1/4], {given}}}"), expected)


def test_an_axis_of_the_grid_is_in_no_cross_level(tmp_path):
    change = ("[1, 1/2, 1/4]}\ngrid: {", "[1, 1/2, 1/4], cross: [{eps_t: 1, eps_f: 1/64}]}\ngrid: {eps_f: [1/32], ")
    expected = "bad.yaml:11:15: grid.eps_f: you gave [0.03125]; gfmd allows eps_f in either limits or grid, not in both"
    assert_complaint(tmp_path, load_campaign, CAMPAIGN, change, expected)


def test_realisations_of_cross_levels_are_as_many_as_these(tmp_path):
    change = ("realisations: 30", "realisations: {reference: 30, cross: [3, 2]}")
    expected = (
        "bad.yaml:3:38: realisations.cross: you gave [3, 2]; gfmd allows 0 numbers, as limits.cross has so many levels"
    )
    assert_complaint(tmp_path, load_campaign, CAMPAIGN, change, expected)


@pytest.mark.parametrize(
    "extra", ["limits: {cross: [{eps_c: 1, eps_f: 1/64}]}", "realisations: {reference: 1, cross: 3}"]
)
def test_surfaces_with_points_of_their_own_have_no_cross_levels(tmp_path, extra):
    own = "rms_gradient: 0.01, points: 64, roll_off: 0.5, cut_on: 0.125}"
    text = CAMPAIGN.replace("rms_gradient: 0.01}", own)
    kept = [line for line in text.splitlines() if not line.startswith(("reference", "limits", "realisations"))]
    good = "\n".join(["realisations: 3", *kept]) + "\n"
    name = extra.partition(":")[0]
    change = ("realisations: 3\n", f"{extra}\n" + "realisations: 3\n" * (name == "limits"))
    message = assert_complaint(tmp_path, load_campaign, good, change, "bad.yaml:1:")
    assert f"{name}.cross: you gave" in message
    assert "gfmd allows nothing, as the surface has points and lengths of its own" in message
