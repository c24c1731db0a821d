"""What a dataset has to be, and what is said of one that is something else."""

import json

import numpy as np
import pytest
import xarray as xr

from gfmd_numba.analysis import UnusableDataError
from gfmd_numba.analysis.forms import CAMPAIGN, DatasetForm, check_fields, goes_around
from gfmd_numba.scene import InputError
from support.synthetic_campaigns import campaign

NAN, INF = np.nan, np.inf
BUT_ONE = np.array(["a", 3], dtype=object)


@pytest.mark.parametrize(
    ("kind", "values", "fault"),
    [
        ("whole", [1, -2], ""),
        ("whole", [True, False], ""),
        ("whole", [1.0, 2.0], "is no whole number"),
        ("numbers", [NAN, INF], ""),
        ("numbers", [1e101, 1.0], ""),
        ("numbers", ["a", "b"], "is no real number"),
        ("numbers", [1j, 1.0], "is no real number"),
        ("finite", [-1.0, 1e100], ""),
        ("finite", [1, 2], ""),
        ("finite", [], ""),
        ("finite", [1.0, NAN], "is not finite"),
        ("finite", [1e101, 1.0], "has a number beyond 1e+100"),
        ("finite", [1.0, -1e101], "has a number beyond 1e+100"),
        ("positive", [0.1, 2.0], ""),
        ("positive", [1.0, 0.0], "is not above 0"),
        ("positive", [1.0, NAN], "is not finite"),
        ("rising", [0.0, 1.0], ""),
        ("rising", [0.0, 2.0, 1.0], "does not rise"),
        ("rising", [1.0, 1.0], "does not rise"),
        ("rising", [0.0, INF], "is not finite"),
        ("rising", 1.0, ""),
        ("texts", ["a", "b"], ""),
        ("texts", BUT_ONE, "is no text"),
        ("flags", [True, False], ""),
        ("flags", [1, 0], "is neither true nor false"),
    ],
)
def test_values_are_of_their_kind(kind, values, fault):
    given = xr.Dataset({"a": (("x",) * np.ndim(values), np.array(values))})
    told(DatasetForm("thing", "a maker", {"a": f"[x] {kind}"}), given, fault and f"a {fault}")


def told(form, given, fault):
    if not fault:
        return form.checked(given, "thing")
    with pytest.raises(UnusableDataError) as refused:
        form.checked(given, "thing")
    assert str(refused.value).startswith(f"you gave a dataset in which {fault}")
    assert str(refused.value).endswith("; gfmd allows a maker")
    return None


@pytest.mark.parametrize(
    ("form", "dims", "others", "found"),
    [
        ("case [step]", "case step", "", "case step"),
        ("case [step]", "step case", "", "case step"),
        ("case [step]", "case", "step", "case"),
        ("case [step]", "step", "", "a is over (step), not over (case, step)"),
        ("case", "case x", "", "a is over (case, x), not over (case)"),
        ("y? x", "x", "", "x"),
        ("y? x", "x", "y", "a is over (x), not over (y, x)"),
        ("y? x", "x y", "", "y x"),
        ("...", "c b", "", "c b"),
        ("... x", "x b c", "", "b c x"),
        ("... x", "b", "", "a is over (b), not over (b, x)"),
    ],
)
def test_dims_are_those_of_the_form_and_come_in_its_order(form, dims, others, found):
    given = xr.Dataset({"a": (tuple(dims.split()), np.ones((1,) * len(dims.split())))})
    given = given.assign({f"other_{dim}": (dim, [1.0]) for dim in others.split()})
    checked = told(DatasetForm("thing", "a maker", {"a": f"{form} numbers"}), given, found if "over" in found else "")
    assert checked is None or checked["a"].dims == tuple(found.split())


def named(*names):
    return {"names": json.dumps(names)}


@pytest.mark.parametrize(
    ("attributes", "fault"),
    [
        ({"units": "m", "long_name": "length", "rank": 3, "label": r"$\lambda$"}, ""),
        ({"units": 3}, "has units 3"),
        ({"axis": None}, "has axis an empty value"),
        ({"rank": -1}, "has rank -1"),
        (named("one", "two"), ""),
        (named("one"), "has names that are not those of its values"),
        ({"names": json.dumps("ab")}, "has names that are not those of its values"),
        (named("one", 2), "has names that are not those of its values"),
        ({"names": "one, two"}, "has names that are not those of its values"),
        ({"names": 3}, "has names that are not those of its values"),
    ],
)
@pytest.mark.filterwarnings("error")
def test_attributes_that_are_read_are_of_their_kind(attributes, fault):
    told(DatasetForm("thing", "a maker", {}), xr.Dataset({"a": ("x", [0, 1], attributes)}), fault and f"a {fault}")


def test_numbers_of_names_are_not_below_0():
    given = xr.Dataset({"a": ("x", [0, -1], named("one", "two"))})
    told(DatasetForm("thing", "a maker", {}), given, "a has names that are not those of its values")


def test_what_is_needed_is_there_what_else_is_there_has_its_form_and_the_rest_is_free():
    needed, others = {"a": "x numbers", "of_*": "x whole"}, {"b_*": "x finite", "a": "x texts"}
    form = DatasetForm("thing", "a maker", {"a": needed["a"]}, others, ("title",), {"x": 2, "y": 1}, axes_over="x")
    whole = xr.Dataset({"a": ("x", [1.0, NAN]), "free": ("z", ["any"])}, attrs={"title": "one"})
    for given, fault in (
        (whole, ""),
        (whole.isel(x=[0]), "x has 1 values"),
        (whole.assign(b_1=("x", [1.0, NAN])), "b_1 is not finite"),
        (whole.assign(b=("x", [1.0, NAN])), ""),
        (whole.assign_attrs(title=3), "the attribute title is 3"),
        (whole.drop_attrs(), "the attribute title is an empty value"),
        (whole.assign_coords(load=("z", [1.0], {"axis": "physics"})), "load is over (z), not over (x)"),
        (whole.assign_coords(load=("x", [1.0, 2.0], {"axis": "physics"})), ""),
        (whole.assign_coords(load=("z", [1.0])), ""),
    ):
        told(form, given, fault)
    with pytest.raises(UnusableDataError, match=r"^you gave no thing; gfmd allows a maker$"):
        form.checked(whole.drop_vars("a"), "thing")
    with pytest.raises(InputError, match=r"^given: you gave 3; gfmd allows an xarray.Dataset, a maker$"):
        form.checked(3, "given")


def test_results_of_a_campaign_are_of_its_form():
    assert CAMPAIGN.checked(campaign(), "results").equals(campaign())


def contact(shape=(4, 4), **more):
    """A contact made up of a profile or a map."""
    dims = ("y", "x")[-len(shape) :]
    fields = {name: (dims, np.ones(shape)) for name in ("height", "pressure", "gap")}
    coords = {dim: (dim, np.arange(n), {"points_per_period": n}) for dim, n in zip(dims, shape, strict=True)}
    return xr.Dataset(fields | {"mean_pressure": 1.0, "status": 0}, coords).assign(more)


NEEDED = ("pressure", "gap", "mean_pressure")
MAP, PROFILE = contact(), contact((4,))
STEPS = MAP.expand_dims(step=2)
ALTERED, OF_A_MAP = "altered results; .* leaves of a contact$", "altered results; .* leaves of a map's contact$"


@pytest.mark.parametrize(
    ("given", "options", "found"),
    [
        (MAP, {}, ["y", "x"]),
        (MAP, {"maps_only": True}, ["y", "x"]),
        (PROFILE, {}, ["x"]),
        (STEPS, {}, ["y", "x"]),
        (PROFILE, {"maps_only": True}, "the contact of a profile, in which no channel leads around"),
        (MAP.drop_vars("gap"), {}, "no results of a contact; "),
        (MAP.drop_vars("mean_pressure"), {"maps_only": True}, "no results of a map's contact; "),
        (MAP.drop_vars("height"), {}, ["y", "x"]),
        (contact((3, 4)), {}, ALTERED),
        (contact((4, 3)), {"maps_only": True}, OF_A_MAP),
        (MAP.assign(gap=MAP["gap"].isel(y=0)), {}, ALTERED),
        (MAP.assign(gap=STEPS["gap"]), {}, ALTERED),
        (MAP.assign(mean_pressure=("x", np.ones(4))), {}, ALTERED),
        (MAP.assign(mean_pressure=STEPS["mean_pressure"]), {}, ALTERED),
        (MAP.assign(mean_pressure="high"), {}, ALTERED),
        (MAP.assign(pressure=MAP["pressure"].astype(str)), {}, ALTERED),
        (STEPS.isel(step=[]), {}, ALTERED),
        (STEPS.assign(status=("step", [0, 1])), {}, "a run that is not ok"),
        (MAP.assign(gap=MAP["gap"].where(MAP["x"] > 0)), {}, "fields that are not finite; .* leaves of a contact$"),
        (MAP.assign(mean_pressure=NAN), {}, ["y", "x"]),
        (contact((6, 6)).isel(x=slice(4)), {}, "4 of the 6 nodes along x; gfmd allows all nodes of the period"),
        (contact((6, 6)).isel(y=slice(4)), {}, "4 of the 6 nodes along y; "),
        (MAP.drop_vars("y"), {}, "4 of the unknown nodes along y; "),
        (contact((6,)).isel(x=slice(4)), {}, "4 of the 6 nodes along x; "),
    ],
)
def test_fields_are_those_of_a_solved_contact(given, options, found):
    if isinstance(found, list):
        assert check_fields(given, NEEDED, **options) == found
    else:
        with pytest.raises(UnusableDataError, match=f"^you gave {found}"):
            check_fields(given, NEEDED, **options)


def test_a_window_has_ends_and_a_period_has_none():
    window = PROFILE.copy()
    window["x"].attrs = {"points_per_window": 4}
    assert [goes_around(given) for given in (window, PROFILE, MAP)] == [(False,), (True,), (True, True)]
