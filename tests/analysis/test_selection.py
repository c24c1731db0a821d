"""What analysis takes from a dataset of cases, in closed form."""

import numpy as np
import pytest
import xarray as xr

from gfmd_numba.analysis import UnusableDataError, ensemble_mean
from gfmd_numba.analysis.selection import (
    discretisations,
    good,
    groups,
    groups_to_fit,
    has_measured_slope_law,
    joined,
    load_of,
    processor_time,
    reference_levels,
    residual_error,
    steps_of,
    values_as_text,
)
from support.synthetic_campaigns import LEVELS, REFERENCE, campaign

DIMS = ("case", "realisation")
NAN = np.nan


@pytest.mark.parametrize(
    ("values", "status", "mean", "error"),
    [
        ([1.0, 2.0, 6.0], [0, 0, 0], 3.0, np.sqrt(7.0 / 3.0)),
        ([1.0, 3.0, 90.0], [0, 0, 5], 2.0, 1.0),
        ([1.0, NAN, -1e101], [0, 0, 0], 1.0, NAN),
        ([1.0, 2.0, 3.0], [1, 1, 1], NAN, NAN),
    ],
)
def test_the_mean_is_that_of_good_realisations_and_its_error_needs_two(values, status, mean, error):
    cases = campaign(realisations=3).isel(case=[0])
    cases = cases.assign(kappa=(DIMS, [values]), status=(DIMS, [status]))
    found = ensemble_mean(cases, "kappa")
    np.testing.assert_allclose(found, [[mean], [error]])
    if not any(status):  # files of others do not tell
        np.testing.assert_allclose(ensemble_mean(cases.drop_vars("status"), "kappa"), found)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (campaign().rename(case="row"), "no results of a campaign"),
        (campaign().drop_vars("eps_c"), "no results of a campaign"),
        (campaign().drop_vars("kappa"), "no variable 'kappa' in the dataset; it has status"),
        (campaign().expand_dims(step=2), "you gave kappa at every step of a path; .* `dataset.isel"),
        (campaign().assign(kappa=("case", np.ones(10))), "no variable 'kappa' in the dataset; it has status"),
    ],
)
def test_what_has_no_such_results_is_refused(given, said):
    with pytest.raises(UnusableDataError, match=said):
        good(given, "kappa")


def test_surfaces_with_grids_of_their_own_have_no_discretisation():
    bare = campaign().drop_vars(list(LEVELS))
    assert (discretisations(bare), discretisations(campaign())) == ((), tuple(LEVELS))
    assert good(bare, "kappa").all()
    assert all(np.isnan(value) for value in reference_levels(bare).values())


def test_the_reference_is_the_finest_marked_case_or_the_finest_levels():
    dataset = campaign()
    several = dataset.assign_coords(is_reference=("case", np.isin(dataset["limit"], ["reference", "eps_f"])))
    none = dataset.assign_coords(is_reference=("case", np.zeros(dataset.sizes["case"], bool)))
    assert reference_levels(dataset) == REFERENCE
    assert reference_levels(several) == REFERENCE | {"eps_f": 1 / 4096}
    assert reference_levels(none) == {name: min(levels) for name, levels in LEVELS.items()}
    (group,) = groups_to_fit(none, "kappa", omit_nyquist=True)  # which no case has
    assert np.isnan([group.reference_mean, group.reference_error]).all()


@pytest.mark.parametrize(
    ("dims", "loads", "found"),
    [({}, [0.2, 0.2], 0.2), ({}, [0.2, 0.3], NAN), ({"path_load": [0.1, 0.1]}, [0.2, 0.2], 0.1), (None, None, NAN)],
)
def test_cases_have_a_load_if_it_is_one(dims, loads, found):
    coords = {} if loads is None else {"reduced_pressure": ("case", loads)}
    cases = xr.Dataset(coords=coords | {name: ("case", each) for name, each in (dims or {}).items()})
    np.testing.assert_equal(load_of(cases), found)


@pytest.mark.parametrize(
    ("load", "measured"), [(0.007, True), (0.3, True), (0.05, True), (0.0069, False), (0.4, False)]
)
def test_the_law_of_the_unseen_slope_was_measured_for_some_loads(load, measured):
    told = {"reduced_pressure": ("case", [load]), "has_measured_slope_law": ("case", [True])}
    assert has_measured_slope_law(xr.Dataset(coords=told)) is measured


def test_the_residual_leaves_a_share_of_each_mean_open_and_so_do_divisions_of_time():
    kappa, error = np.array([[2.0, 4.0]]), np.array([[0.02, 0.08]])
    cases = xr.Dataset({"kappa": (DIMS, kappa), "kappa_residual_error": (DIMS, error), "mean_gap": (DIMS, 5 * kappa)})
    assert residual_error(cases, "kappa") == pytest.approx([0.05])
    assert residual_error(cases, "mean_gap") == pytest.approx([0.25])
    timed = cases.assign(time_error=(DIMS, np.full((1, 2), 0.01)))
    assert residual_error(timed, "kappa") == pytest.approx([0.08])
    assert np.isnan(residual_error(cases.drop_vars("kappa_residual_error"), "kappa")).all()


def test_problems_take_their_time_once():
    cases = xr.Dataset({"case_seconds": ("case", [1.0, 2.0, 2.0])}, {"case_id": ("case", ["a", "b", "b"])})
    assert processor_time(cases) == {"cpu_seconds": 3.0}
    assert processor_time(cases.drop_vars("case_seconds")) == {}


def test_numbers_of_names_are_told_by_them():
    names = xr.DataArray([0.0, 1.0], attrs={"names": '["wall", "steel"]'})
    assert values_as_text(names, names.values) == ["wall", "steel"]
    assert values_as_text(xr.DataArray([0.5]), [0.5, 1 / 3]) == ["0.5", "0.333333"]


AREA = [0.1, NAN, 0.4]


def path(**more):
    """A path of three steps, the second of which failed."""
    one = campaign(realisations=2)
    shape = (*DIMS, "step")
    n, steps = one.sizes["case"], np.arange(3.0)
    kappa = ("case", "realisation", "step"), one["kappa"].values[..., None] + steps
    area = (shape, np.broadcast_to(AREA, (n, 2, 3)))
    whole = one.assign(kappa=kappa, pull_off_pressure=one["kappa"], contact_area_fraction=area)
    return whole.assign_coords(step_load=(("case", "step"), np.tile([2.0, 1.0, 4.0], (n, 1)))).assign(more)


def test_a_variable_has_its_steps_or_stands_once_at_the_largest_contact():
    steps = steps_of(path(), "kappa")
    assert [float(step["kappa"][0, 0] - steps[0]["kappa"][0, 0]) for step in steps] == [0.0, 1.0, 2.0]
    assert [step["path_step"].values[0] for step in steps] == [0, 1, 2]
    assert [step["path_load"].values[0] for step in steps] == pytest.approx([0.007, 0.0035, 0.014])
    (last,) = steps_of(path(), "kappa", 2)
    assert last.identical(steps[2])
    (whole,) = steps_of(path(), "pull_off_pressure")
    assert float(whole["contact_area_fraction"][0, 0]) == 0.4
    assert "path_step" not in whole.coords
    (unknown,) = steps_of(path().drop_vars("contact_area_fraction"), "pull_off_pressure")
    assert unknown["kappa"].values.tolist() == steps[0]["kappa"].values.tolist()
    (single,) = steps_of(campaign(), "kappa")
    assert single.identical(campaign())


@pytest.mark.parametrize(
    ("given", "variable", "step", "said"),
    [
        (path(), "kappa", 3, "step: you gave 3; gfmd allows a step from 0 to 2"),
        (path(), "kappa", -1, "step: you gave -1; gfmd allows a step from 0 to 2"),
        (path(), "kappa", True, "step: you gave true; gfmd allows a step from 0 to 2"),
        (path(), "pull_off_pressure", 0, "gfmd allows nothing, as pull_off_pressure has no steps"),
        (campaign(), "kappa", 0, "gfmd allows nothing, as kappa has no steps"),
    ],
)
def test_a_step_that_there_is_not_is_refused(given, variable, step, said):
    with pytest.raises(UnusableDataError, match=said):
        steps_of(given, variable, step)


def test_a_path_that_begins_without_a_load_has_none_at_its_steps():
    begun = path().assign_coords(step_load=(("case", "step"), np.tile([0.0, 1.0, 4.0], (10, 1))))
    assert all(np.isnan(step["path_load"]).all() for step in steps_of(begun, "kappa"))


def test_fits_are_joined_with_groups_numbered_through():
    fits = [xr.Dataset({"a": ("group", [value])}, {"group": [0]}) for value in (1.0, 2.0)]
    assert joined(fits)["a"].values.tolist() == [1.0, 2.0]
    assert joined(fits)["group"].values.tolist() == [0, 1]


def test_a_group_is_what_differs_in_discretisation_alone_also_where_a_parameter_is_not_known():
    dataset = campaign((0.3, 0.8)).assign_coords(rms_gradient_target=campaign((0.3, 0.8))["rms_gradient_target"] * NAN)
    dataset["rms_gradient_target"].attrs = campaign()["rms_gradient_target"].attrs
    assert [cases.sizes["case"] for _, cases in groups(dataset)] == [10, 10]


def test_a_group_knows_its_surfaces_and_says_numbers_in_its_unit():
    dataset = campaign(realisations=5)
    dataset["kappa"].attrs["units"] = "m"
    asked = np.full(dataset.sizes["case"], 5)
    asked[3] = 2
    dataset["kappa"][3, 2:] = NAN
    (group,) = groups_to_fit(dataset.assign_coords(realisations=("case", asked)), "kappa", omit_nyquist=True)
    assert (group.n_realisations, group.n_cases, group.complete.tolist()) == (2, 10, [True] * 5)
    assert group.shown(2.5e-6) == "2.5 µm"
    fewer = group.without("eps_f", 1 / 256)
    assert (fewer.n_cases, set(fewer.levels["eps_f"])) == (9, set(LEVELS["eps_f"]) - {1 / 256})
    assert fewer.log_ratio("eps_f").max() == pytest.approx(np.log(2.0))
    for level in LEVELS["eps_c"][1:]:
        fewer = fewer.without("eps_c", level)
    assert set(fewer.levels) == {"eps_f", "eps_t"}
