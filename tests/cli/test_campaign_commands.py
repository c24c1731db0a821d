"""Commands for campaigns: plan, run, fit and plot, and what they say of runs that are not ok."""

import re

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.solvers import dynamics
from gfmd_numba.text.numbers import with_error
from support.campaigns import SMALL, TINY, campaign
from support.command_line import gfmd, unfolded


def test_plan_counts_cases_and_distinct_problems(tmp_path):
    path = campaign(tmp_path, **{"hurst: [0.3, 0.8]": "poissons_ratio: [0.2, 0.33]"})
    output = gfmd("plan", path, "--pilot=0").output
    assert "10, of which 5 distinct problems" in output
    assert "largest grid  512 nodes" in output
    assert "Poisson's ratio" in output


def test_a_campaign_is_run_and_drawn(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = campaign(tmp_path, **{"[0.3, 0.8]": "[0.8]", "eps_c: [1/2, 1/4, 1/8], ": ""})
    done = gfmd("run", path, "--workers=0")
    assert done.exit_code == 0
    assert "results  small/small.nc" in done.output
    assert (tmp_path / "small" / "small.png").stat().st_size > 10_000
    assert xr.open_dataset(tmp_path / "small" / "small.nc").sizes["case"] == 3


def test_a_fit_is_written_and_printed(results, tmp_path):
    done = gfmd("fit", results.parent, "--fixed", "eps_c=1", "--fixed", "eps_f=0.5:1", "-o", tmp_path / "fit.nc")
    assert done.exit_code == 0
    fitted = xr.open_dataset(tmp_path / "fit.nc")
    assert (fitted["fit_status"] == "ok").all()
    assert with_error(float(fitted["kappa_tfc"][0]), float(fitted["kappa_tfc_error"][0])) in done.output
    done = gfmd("fit", results.parent, "--fixed", "eps_c=1", "--fixed", "eps_f=0.5:1", "-o", tmp_path / "fit.csv")
    assert done.exit_code == 0
    table = pd.read_csv(tmp_path / "fit.csv", comment="#")
    assert table["hurst (1)"].tolist() == [0.3, 0.8]
    for name in ("kappa_tfc", "kappa_tfc_error", "kappa_tfc_low", "kappa_tfc_high"):
        np.testing.assert_array_equal(table[f"{name} (1)"], fitted[name])


@pytest.mark.long
def test_another_version_of_a_campaign_says_that_it_replaces_results(tmp_path, monkeypatch, undrawn):
    monkeypatch.chdir(tmp_path)
    first = gfmd("run", campaign(tmp_path, TINY), "--workers=0")
    again = gfmd("run", campaign(tmp_path, TINY), "--workers=0")
    changed = gfmd("run", campaign(tmp_path, TINY, **{"hurst: 0.8": "hurst: 0.7"}), "--workers=0")
    assert "tasks" not in again.stderr  # nothing was left to do
    for done, is_told in ((first, False), (again, False), (changed, True)):
        assert done.exit_code == 0
        assert ("tiny holds another version of this campaign" in unfolded(done.output)) == is_told


@pytest.mark.long
@pytest.mark.parametrize("realisations", [1, 6])
def test_a_campaign_without_limits_prints_its_means(tmp_path, realisations, undrawn):
    text = "\n".join(line for line in SMALL.splitlines() if not line.startswith("limits"))
    path = campaign(tmp_path, text, **{"realisations: 6": f"realisations: {realisations}"})
    done = gfmd("run", path, "-o", tmp_path / "out", "--workers=0")
    assert done.exit_code == 0
    assert "exponent" not in done.output
    kappa = xr.open_dataset(tmp_path / "out" / "small.nc")["kappa"]
    assert "nu = 0.33, a = inf, p* = 0.05, eps_c = 0.25, eps_f = 0.0625, eps_t = 0.5\n" in done.output
    rows = [line.split() for line in done.output.splitlines() if line.startswith("0.")]
    errors = kappa.std("realisation", ddof=1).values / realisations**0.5 if realisations > 1 else [float("nan")] * 2
    found = map(with_error, kappa.mean("realisation").values.tolist(), errors)
    assert rows == [list(row) for row in zip(["0.3", "0.8"], found, strict=True)]
    assert "nan" not in done.output
    drawn = gfmd("plot", tmp_path / "out", "-o", tmp_path / "out.png")
    assert drawn.exit_code == 0, drawn.output


def test_runs_that_do_not_converge_exit_with_3(tmp_path, undrawn):
    path = campaign(tmp_path, **{"grid:": "numerics: {max_iterations: 1}\ngrid:", "limits:": "#"})
    done = gfmd("run", path, "-o", tmp_path / "out", "--workers=0")
    assert done.exit_code == 3
    assert "12 of 12 simulations are not ok" in done.stderr


@pytest.mark.long
def test_a_campaign_says_how_many_runs_are_unstable(tmp_path, monkeypatch, undrawn):
    path = campaign(tmp_path, **{"grid:": "numerics: {solver: verlet}\ngrid:"})
    limit = dynamics.stability_limit
    monkeypatch.setattr(dynamics, "stability_limit", lambda *modes: 1.1 * limit(*modes))
    done = gfmd("run", path, "-o", tmp_path / "out", "--workers=0")
    assert done.exit_code == 3
    least = int(gfmd_numba.open_campaign(tmp_path / "out")["n_iterations"].min())
    assert (
        f"60 ended as unstable, the first after {least} iterations. Tractions grew without bound: lower numerics"
        in unfolded(done.stderr)
    )


@pytest.mark.long
def test_fit_prints_each_groups_own_reference_and_each_reason_once(results):
    done = gfmd("fit", results.parent, "--fixed", "eps_c=1", "--fixed", "eps_f=1")
    dataset = xr.open_dataset(results)
    fit = gfmd_numba.fit_tfc(dataset, fixed={"eps_c": 1.0, "eps_f": 1.0})
    kappa = dataset["kappa"].isel(case=dataset["is_reference"].values).mean("realisation")
    rows = [line for line in done.output.splitlines() if line.startswith("0.")]
    for row, reference, error in zip(rows, kappa.values, fit["reference_error"].values, strict=True):
        assert row.endswith(with_error(reference, error))
    said = gfmd("fit", results, "--fixed=eps_f=1").output.replace("\n         ", " ")  # notes are folded
    notes = [line for line in said.splitlines() if line.startswith("note")]
    assert len(notes) == len(set(notes)) < 6
    assert sum("--fixed eps_" in note and "fit: {fixed: {" in note for note in notes) == 1


@pytest.mark.long
def test_notes_name_the_group_and_the_case(tmp_path, results):
    dataset = xr.open_dataset(results).load()
    dataset["kappa"][1] = float("nan")
    dataset.to_netcdf(tmp_path / "broken.nc")
    done = gfmd("fit", tmp_path / "broken.nc", "--fixed", "eps_c=1", "--fixed", "eps_f=1")
    assert "H = 0.3: left out, no good realisation: eps_c = 1/2, eps_f = 1/16, eps_t = 1/2" in unfolded(done.output)


@pytest.mark.long
def test_picture_of_a_directory_is_named_like_that_of_a_run(results, undrawn):
    assert gfmd("plot", results.parent, "--variable=kappa_counted", "--fixed=eps_c=1", "--fixed=eps_f=1").exit_code == 0
    assert (results.parent / "small.png").exists()


@pytest.mark.long
def test_plan_says_what_is_shared_and_what_it_costs(tmp_path):
    text = SMALL.replace("grid: {", "grid: {poissons_ratio: [0.2, 0.3], aspect_ratio: [.inf, 1.5], ")
    path = tmp_path / "campaign.yaml"
    path.write_text(text)
    said = unfolded(gfmd("plan", path, "--pilot=1").output)
    assert "cases differ from another case only in poissons_ratio and aspect_ratio" in said
    assert re.search(r"CPU time +\S+ m?s, with 90 % probability below", said)
    assert re.search(r"dropped +slab of aspect ratio 1.5, .* at most \S+, below numerics.effects = 0.0001", said)
