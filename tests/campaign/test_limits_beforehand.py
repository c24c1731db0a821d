"""`check` and `plan` say before a campaign runs that its fit will print no limit, in the words of that fit."""

import importlib.util

import pytest

import gfmd_numba
from support.campaigns import SMALL, campaign
from support.command_line import gfmd, unfolded

LIMITS = "limits: {eps_c: [1/2, 1/4, 1/8], eps_f: [1/8, 1/16, 1/32]}"
FEW = SMALL.replace("realisations: 6", "realisations: 2")
REFUSED = {
    "two levels": ("limits: {eps_c: [1/2, 1/8], eps_f: [1/8]}", "exponent of eps_f needs three levels, has two"),
    "one of three at Nyquist": ("limits: {eps_c: [1, 1/2]}", "exponent of eps_c needs three levels, has two"),
    "one of two at Nyquist": (
        "limits: {eps_c: [1]}\nfit: {fixed: {eps_c: 1}}",
        "no discretisation is varied over two or more good levels",
    ),
    "always together": (
        "limits: {cross: [{eps_c: 1/2, eps_f: 1/8}]}\nfit: {fixed: {eps_c: 1, eps_f: 1}}",
        "2 cases cannot tell eps_c, eps_f apart",
    ),
}
FITTED = {
    "three levels": LIMITS,
    "two levels of a known exponent": "limits: {eps_c: [1/2]}\nfit: {fixed: {eps_c: [1, 2]}}",
    "no limits": "",
}


@pytest.mark.long
@pytest.mark.parametrize(
    ("limits", "reason"),
    [pytest.param(*REFUSED[name], id=name, marks=[pytest.mark.long] * (name != "two levels")) for name in REFUSED],
)
def test_a_limit_that_the_fit_will_refuse_is_refused_beforehand_in_its_words(tmp_path, limits, reason):
    path = campaign(tmp_path, FEW.replace(LIMITS, limits))
    for command in (["check", path], ["plan", path, "--pilot=0"]):
        said = gfmd(*command)
        assert said.exit_code == 0, said.output
        assert f"gfmd: a run will print no limit of kappa (2 groups of cases): {reason}" in unfolded(said.stderr)
    fit = gfmd_numba.fit_tfc(
        gfmd_numba.run(path, tmp_path / "out", workers=0),
        fixed=None if "fixed" in limits else {},
    )
    assert (fit["fit_status"] == "refused").all()
    assert all(message.startswith(reason) for message in fit["message"].values)


@pytest.mark.parametrize("limits", FITTED.values(), ids=FITTED)
def test_a_campaign_that_has_its_levels_is_not_warned_of(tmp_path, limits):
    path = campaign(tmp_path, FEW.replace(LIMITS, limits))
    for command in (["check", path], ["plan", path, "--pilot=0"]):
        assert "no limit" not in gfmd(*command).stderr


@pytest.mark.parametrize("installed", [True, False])
def test_check_of_a_cluster_says_whether_jobs_can_be_submitted(tmp_path, monkeypatch, installed):
    find = importlib.util.find_spec
    there = object() if installed else None
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *a: there if "jobqueue" in name else find(name, *a))
    (tmp_path / "c.yaml").write_text("cores: 4\nmemory: 8 GB\nwalltime: 2 h\njobs: {max: 10}\n")
    said = gfmd("check", tmp_path / "c.yaml")
    assert said.exit_code == 0
    assert ("dask-jobqueue, which submits the jobs, is not installed" in unfolded(said.stderr)) != installed
