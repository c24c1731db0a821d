"""Choice of cases from a campaign dataset: groups of equal physics, one limit, one step of a path, good results."""

import json
import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf, isnan, nan
from typing import Annotated, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gfmd_numba.analysis.arguments import Limit, Variable, checked
from gfmd_numba.analysis.forms import CAMPAIGN, LARGEST, UnusableDataError
from gfmd_numba.arrays import Reals
from gfmd_numba.text.input_error import brief
from gfmd_numba.text.numbers import si_prefix, with_error
from gfmd_numba.text.printable import printable
from gfmd_numba.theory.exponent_ranges import possible_values


def has_names(parameter: xr.DataArray) -> bool:
    """Whether the values of a parameter are numbers of names, which its attribute `names` lists."""
    return "names" in parameter.attrs


def without_formula(name: str) -> str:
    """Return a name that no text of a figure takes for a formula."""
    return name.replace("$", r"\$")


def values_as_text(parameter: xr.DataArray, values: Iterable[float]) -> list[str]:
    """Return each value of a parameter as text: the name that it stands for, or the number with six digits."""
    names = json.loads(parameter.attrs["names"]) if has_names(parameter) else None
    return [f"{value:g}" if names is None else printable(names[int(value)]) for value in values]


# Reduced pressures at which the limits by the law of the unseen slope were measured. Its k_c was, from 0.001 on, but at
# 1/eps_t = 8, where it is not that of long periods yet: at p* = 0.003 limits are up to 9 % too small
_MEASURED_LOADS = (0.007, 0.3)
PATH_LOAD = "path_load"  # coordinate of the reduced pressure at one step of a path


def residual_error(cases: xr.Dataset, variable: str) -> Reals:
    """Return what residual and divisions of time leave open of each case's mean, in proportion to kappa for others."""
    if not {"kappa", "kappa_residual_error"} <= set(map(str, cases.variables)):
        return np.full(cases.sizes["case"], nan)
    share = cases["kappa_residual_error"] / cases["kappa"]
    if "time_error" in cases:
        share = share + cases["time_error"]
    return np.asarray((share * cases[variable]).mean("realisation").values)


def processor_time(dataset: xr.Dataset) -> dict[str, float]:
    """Return the attribute cpu_seconds: what all cases took, in s, each problem once; none if the dataset has none."""
    if "case_seconds" not in dataset:
        return {}
    _, first = np.unique(dataset["case_id"].values, return_index=True)
    return {"cpu_seconds": float(dataset["case_seconds"].values[first].sum())}


def dimension_of(cases: xr.Dataset) -> int:
    """Return 1 for profiles, as those of files that do not tell, and 2 for maps."""
    return int(cases["dimension"].values[0]) if "dimension" in cases else 1


def has_measured_slope_law(cases: xr.Dataset) -> bool:
    """Return whether the law of the unseen slope was measured for contacts of this kind and load; no if not known."""
    told = "has_measured_slope_law" in cases and bool(cases["has_measured_slope_law"].values.all())
    return told and not is_light(load_of(cases)) and round(load_of(cases), 9) <= _MEASURED_LOADS[1]


def is_light(load: Any) -> Any:
    """Whether a reduced pressure is below those at which the law of the unseen slope was measured; no if not known."""
    return np.round(load, 9) < _MEASURED_LOADS[0]


def load_of(cases: xr.Dataset) -> float:
    """Return the reduced pressure of cases, at a step of a path that step's; nan if it differs or is not known."""
    for name in (PATH_LOAD, "reduced_pressure"):
        if name in cases.coords:
            loads = cases[name].values.astype(float)
            return float(loads[0]) if np.allclose(loads, loads[0], rtol=1e-9, atol=0.0) else nan
    return nan


LIMITS = ("eps_c", "eps_f", "eps_t")
CROSS = "cross"  # in `limit` of a case that differs from the reference in several of them

# across a contact. On profiles the corrected area is 4 % off with 1.8 nodes a stretch and 1 % with 3 (README); on maps
# 12 % with 2.7 nodes a patch, 2 to 7 % with 5 and 2 % with 8 (H = 0.3 and 0.8, p* = 1e-4 to 0.05)
FEWEST_NODES = 2
# Stretches or patches of contact in a period: with fewer, on average, the highest hill bears nearly all of the load,
# and corrections in eps_t are not those of many hills, where less than this share of the surface touches
FEWEST_STRETCHES, _MOSTLY_CLOSED = 3, 0.5

# what a fit reads in addition to its variable and the coordinates
_READ = (
    "kappa",
    "kappa_residual_error",
    "time_error",
    "contact_area_fraction_counted",
    "n_segments",
    "case_seconds",
    "nx",
    "dimension",
    "status",
)


@dataclass(frozen=True)
class Group:
    """The results of one group of cases, which differ only in discretisation, as a fit takes them."""

    variable: str
    unit: str  # of the variable
    parameters: dict[str, float]
    cases: NDArray[np.intp]  # where its cases stand in the dataset
    values: Reals  # (realisation, case)
    complete: NDArray[np.bool_]  # realisations that are good in every case asked of them
    asked: NDArray[np.bool_]  # (realisation, case)
    levels: dict[str, Reals]  # of the limits that are varied
    reference: dict[str, float]  # its discretisation, nan where surfaces have grids of their own
    reference_mean: float
    reference_error: float
    n_excluded: int
    n_stretches: float  # of contact in a period on average, where there are most; nan if not known, or mostly closed
    stretches: Reals  # of contact in a period on average (case), nan likewise
    residual_error: Reals  # of each case's mean by the solver's residual, nan if the dataset does not tell
    seconds: float  # of processor time that its cases took, nan likewise
    dimension: int  # of its surfaces
    load: float  # reduced pressure p / (g E*), nan if it is not the same in all cases or not known
    thinnest_layer: float  # height of the thinnest layer of the bodies over the period, inf for half-spaces
    has_measured_slope_law: bool  # whether the law of the unseen slope was measured for such contacts
    notes: list[str]

    @property
    def n_realisations(self) -> int:
        """Number of complete realisations of the case that has fewest."""
        return int(self.asked[self.complete].sum(axis=0).min(initial=len(self.complete)))

    @property
    def has_thin_layers(self) -> bool:
        """Whether layers stay thinner than the longest wave of the power law, because eps_t is not varied."""
        return "eps_t" not in self.levels and self.reference["eps_t"] > self.thinnest_layer * (1.0 + 1e-9)

    @property
    def n_cases(self) -> int:
        """Number of cases."""
        return int(self.values.shape[1])

    @property
    def possible(self) -> tuple[float, float]:
        """Least and largest value that the variable can have, infinite if they are not known."""
        found = self.values[np.isfinite(self.values)]
        if (found < 0.0).any() and (found > 0.0).any():
            return -inf, inf
        return possible_values(self.variable, -1.0 if (found < 0.0).any() else 1.0)

    def shown(self, value: float) -> str:
        """Return a number in the unit of the variable for a sentence."""
        factor, unit = si_prefix(abs(value), self.unit)
        number = with_error(factor * value, nan, digits=2)
        return number if unit == "1" else f"{number} {unit}"

    def log_ratio(self, limit: str) -> Reals:
        """Return the logarithm of a limit's levels over its reference level."""
        return np.log(self.levels[limit] / self.reference[limit])

    def without(self, limit: str, level: float) -> "Group":
        """Return the same group without the cases at one level of a limit."""
        kept = ~np.isclose(self.levels[limit], level, rtol=1e-9)
        values, asked = self.values[:, kept], self.asked[:, kept]
        levels = {name: each[kept] for name, each in self.levels.items()}
        return replace(
            self,
            cases=self.cases[kept],
            values=values,
            asked=asked,
            complete=_complete(values, asked),
            levels={name: each for name, each in levels.items() if np.unique(each).size > 1},
            residual_error=self.residual_error[kept],
            stretches=self.stretches[kept],
        )


def axes(dataset: xr.Dataset, kind: str = "physics") -> tuple[str, ...]:
    """Return the names of the coordinates whose attribute `axis` says that they are physics, or discretisations.

    They come in the order of their attribute `rank`, as a file does not keep its variables in order.
    """
    told = {str(name): dataset.variables[name].attrs for name in dataset.coords}
    found = [name for name, each in told.items() if each.get("axis") == kind]
    return tuple(sorted(found, key=lambda name: int(told[name].get("rank", len(found)))))


def discretisations(dataset: xr.Dataset) -> tuple[str, ...]:
    """Return the discretisations that a dataset has: none if its surfaces have grids and lengths of their own."""
    return tuple(name for name in LIMITS if name in dataset.variables)


def good(dataset: xr.Dataset, variable: str) -> xr.DataArray:
    """Return the mask (case, realisation) of finite, ok results; UnusableDataError without such a variable."""
    if not {"case", "realisation"} <= set(dataset.dims) or 0 < len(discretisations(dataset)) < len(LIMITS):
        raise UnusableDataError("you gave no results of a campaign; gfmd allows what a finished `gfmd run` leaves")
    if not axes(dataset):
        raise UnusableDataError(
            "you gave results whose coordinates do not say, by the attribute `axis`, which of them are physics; "
            "gfmd allows what a finished `gfmd run` of this version leaves"
        )
    present = dataset.variables
    if variable not in present or set(present[variable].dims) != {"case", "realisation"}:
        if variable in present and "step" in present[variable].dims:
            raise UnusableDataError(
                f"you gave {variable} at every step of a path; gfmd allows one step, like `dataset.isel(step=-1)`"
            )
        others = [str(name) for name, one in dataset.data_vars.items() if set(one.dims) == {"case", "realisation"}]
        raise UnusableDataError(f"no variable {variable!r} in the dataset; it has {', '.join(others)}")
    values = _values(dataset, variable)
    mask = abs(values) < LARGEST  # and no nan
    if "status" in present:
        mask &= _values(dataset, "status") == 0
    return xr.DataArray(mask, dims=("case", "realisation"))


def _values(dataset: xr.Dataset, variable: str) -> NDArray[Any]:
    """Return the values (case, realisation) of a variable."""
    return np.asarray(dataset.variables[variable].transpose("case", "realisation").values)


@checked
def ensemble_mean(cases: Annotated[xr.Dataset, CAMPAIGN], variable: Variable) -> tuple[Reals, Reals]:
    """Return each case's mean over good realisations and its standard error, nan where undefined."""
    return means(cases, variable)


def means(cases: xr.Dataset, variable: str) -> tuple[Reals, Reals]:
    """Return what `ensemble_mean` does, of a dataset whose form is known."""
    values = np.where(good(cases, variable).values, _values(cases, variable).astype(float), np.nan)
    count = np.isfinite(values).sum(axis=1)
    with warnings.catch_warnings(action="ignore", category=RuntimeWarning):  # of cases without any
        return np.nanmean(values, axis=1), np.nanstd(values, axis=1, ddof=1) / count**0.5


def groups(dataset: xr.Dataset) -> Iterator[tuple[dict[str, float], xr.Dataset]]:
    """Yield (parameters, cases) for each set of cases that differ only in discretisation, in file order."""
    names = axes(dataset)
    physics = table(dataset, names)
    members: dict[bytes, list[int]] = {}
    for index, row in enumerate(physics):
        members.setdefault(row.tobytes(), []).append(index)  # bytes: a nan parameter still equals itself
    for indices in members.values():
        yield dict(zip(names, physics[indices[0]].tolist(), strict=True)), dataset.isel(case=indices)


def table(dataset: xr.Dataset, names: Sequence[str]) -> Reals:
    """Return the values (case, name) of parameters."""
    columns = [dataset.variables[name].values.astype(float) for name in names]
    return np.stack(columns, axis=-1) if columns else np.empty((dataset.sizes["case"], 0))


def key(parameters: dict[str, float]) -> tuple[float, ...]:
    """Return a group's parameters for use in a dictionary, where nan is found only if it is the same object."""
    return tuple(nan if isnan(value) else value for value in parameters.values())


def fractions(levels: Reals) -> str:
    """Return levels from coarse to fine, written as fractions."""
    return ", ".join(str(Fraction(float(level)).limit_denominator(10**6)) for level in np.unique(levels)[::-1])


def groups_to_fit(dataset: xr.Dataset, variable: str, omit_nyquist: bool) -> list[Group]:
    """Return the groups, cases that mostly failed left out; UnusableDataError without such a variable."""
    usable = good(dataset, variable)
    read = [name for name in _READ if name in dataset.data_vars]  # all others would be copied for each group
    dataset = dataset[read].assign({variable: dataset[variable].where(usable)})
    dataset = dataset.assign_coords(_position=("case", np.arange(dataset.sizes["case"])))
    told = table(dataset, (*axes(dataset), *axes(dataset, "discretisation")))
    problems: dict[bytes, str] = {}
    for row, identity in zip(told, dataset["case_id"].values.astype(str).tolist(), strict=True):
        if problems.setdefault(row.tobytes(), identity) != identity:  # their physics would be pooled
            raise UnusableDataError(
                "you gave different problems at the same discretisation, which no coordinate with the attribute `axis` "
                "tells apart; gfmd allows what a finished `gfmd run` leaves, its coordinates with their attributes"
            )
    return [_collected(parameters, cases, variable, omit_nyquist) for parameters, cases in groups(dataset)]


def _collected(parameters: dict[str, float], cases: xr.Dataset, variable: str, omit_nyquist: bool) -> Group:
    reference = reference_levels(cases)
    mean, error = _at(cases, reference, variable)
    notes = []
    if omit_nyquist and at_nyquist(reference["eps_c"]):
        notes.append("eps_c = 1 is fitted as well, as the reference stands there: roughness at Nyquist is not resolved")
    elif omit_nyquist and discretisations(cases):
        cases = cases.isel(case=~at_nyquist(cases["eps_c"].values))
    values = cases[variable].transpose("realisation", "case").values.astype(float)
    present, asked = np.isfinite(values), _asked(cases)
    n_present, n_run = present.sum(axis=0), (asked & present.any(axis=1, keepdims=True)).sum(axis=0)
    n_excluded = int((asked & ~present).sum())
    # only complete realisations are fitted: a case that mostly failed would leave hardly any
    dead, poor = n_present == 0, (n_present > 0) & (2 * n_present < n_run)
    kept = ~(dead | poor)
    for left_out, why in ((dead, "no good realisation"), (poor, "good in less than half of the realisations")):
        if left_out.any():
            names = [_named(cases.isel(case=index)) for index in np.flatnonzero(left_out)]
            notes.append(f"left out, {why}: {'; '.join(names)}")
    told = cases["status"].attrs if "status" in cases else {}
    endings = dict(zip(told.get("flag_meanings", "").split(), told.get("flag_values", ()), strict=True))
    if "unfinished" in endings and (waiting := int((cases["status"] == endings["unfinished"]).sum())):
        notes.append(f"{waiting} of {int(asked.sum())} simulations have not run yet: `gfmd run` resumes")
    values, present, asked = values[:, kept], present[:, kept], asked[:, kept]
    some, complete = present.any(axis=1), _complete(values, asked)
    if some.sum() > complete.sum():
        dropped = some.sum() - complete.sum()
        notes.append(f"{dropped} of {some.sum()} realisations dropped, not good in every case")
    stretches = _stretches(cases, variable)
    levels = {}
    for name in discretisations(cases):
        level = cases[name].values.astype(float)[kept]
        if np.unique(level).size > 1:
            levels[name] = level
        else:
            notes.append(f"{name} is not varied: {variable}_tfc is not extrapolated in it")
    notes += _unresolved(cases)
    return Group(
        variable=variable,
        unit=cases[variable].attrs.get("units", "1"),
        parameters=parameters,
        cases=cases["_position"].values[kept],
        values=values,
        complete=complete,
        asked=asked,
        levels=levels,
        reference=reference,
        reference_mean=mean,
        reference_error=error,
        n_excluded=n_excluded,
        n_stretches=float(np.fmax.reduce(stretches)),
        stretches=stretches[kept],
        residual_error=residual_error(cases, variable)[kept],
        seconds=float(cases["case_seconds"].values[kept].sum()) if "case_seconds" in cases else nan,
        dimension=dimension_of(cases),
        load=load_of(cases),
        thinnest_layer=float(cases["thinnest_layer"].values.min()) if "thinnest_layer" in cases else inf,
        has_measured_slope_law=has_measured_slope_law(cases),
        notes=notes,
    )


def _unresolved(cases: xr.Dataset) -> list[str]:
    """Return a note if the grid does not resolve the stretches or patches of contact where they have most."""
    if not {"contact_area_fraction_counted", "n_segments", "nx"} <= set(map(str, cases.variables)):
        return []
    dimension = dimension_of(cases)
    counted = (cases["contact_area_fraction_counted"] * cases["nx"] ** dimension).sum("realisation").values
    segments = cases["n_segments"].sum("realisation").values
    # full contact has neither, and no edges to resolve
    found = np.divide(counted, segments, out=np.where(counted > 0, np.inf, 0.0), where=segments > 0)
    nodes, fewest = float(found.max(initial=0.0)) or np.inf, FEWEST_NODES**dimension
    if nodes >= fewest:
        return []
    stretches = {1: "stretches", 2: "patches"}[dimension]
    finer = "a finer eps_c" if discretisations(cases) else "more points"
    return [
        f"{stretches} of contact have {nodes:.2g} nodes on average where they have most, fewer than {fewest}: "
        f"the area is that of the grid, not of the surface; take {finer} or a higher pressure"
    ]


def _stretches(cases: xr.Dataset, variable: str) -> Reals:
    """Return the mean number of stretches of contact (case); nan if not known, or mostly closed in one of the cases."""
    if not {"contact_area_fraction_counted", "n_segments"} <= set(map(str, cases.variables)):
        return np.full(cases.sizes["case"], nan)
    there = cases[["contact_area_fraction_counted", "n_segments"]].where(cases[variable].notnull()).mean("realisation")
    closed = (there["contact_area_fraction_counted"] > _MOSTLY_CLOSED).any()
    return np.full(cases.sizes["case"], nan) if closed else np.asarray(there["n_segments"].values)


def _complete(values: Reals, asked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the realisations (realisation) with values (realisation, case) wherever they were asked for one."""
    present = np.isfinite(values)
    return np.asarray((present | ~asked).all(axis=1) & present.any(axis=1))


def _asked(cases: xr.Dataset) -> NDArray[np.bool_]:
    """Return which cases were asked of which realisations (realisation, case)."""
    shape = cases.sizes["realisation"], cases.sizes["case"]
    if "realisations" not in cases.coords:
        return np.ones(shape, dtype=bool)
    return np.asarray(np.arange(shape[0])[:, None] < cases["realisations"].values)


def _named(case: xr.Dataset) -> str:
    return ", ".join(f"{name} = {fractions(case[name].values)}" for name in discretisations(case)) or "the only case"


def at_nyquist(eps_c: Any) -> Any:
    """Whether the roughness goes up to the Nyquist wave number, where no grid resolves it."""
    return eps_c >= 1 - 1e-9


def reference_levels(group: xr.Dataset) -> dict[str, float]:
    """Return the discretisation of a group's finest reference case, or the finest levels present if it has none.

    It is nan where surfaces have grids of their own.
    """
    if not discretisations(group):
        return dict.fromkeys(LIMITS, nan)
    levels = {name: group.variables[name].values.astype(float) for name in LIMITS}
    marked = np.flatnonzero(group.variables["is_reference"].values)
    if not marked.size:
        return {name: float(level.min()) for name, level in levels.items()}
    finest = marked[np.prod([level[marked] for level in levels.values()], axis=0).argmin()]
    return {name: float(level[finest]) for name, level in levels.items()}


def _at(group: xr.Dataset, levels: dict[str, float], variable: str) -> tuple[float, float]:
    """Return mean and standard error of a group's case at a discretisation, nan if there is none."""
    there = np.ones(group.sizes["case"], dtype=bool)
    for name in discretisations(group):
        there &= np.isclose(group.variables[name].values, levels[name], rtol=1e-9)
    if not there.any():
        return nan, nan
    mean, error = means(group.isel(case=there), variable)
    return float(mean[0]), float(error[0])


@checked
def select_limit(dataset: Annotated[xr.Dataset, CAMPAIGN], limit: Limit) -> xr.Dataset:
    """Return one limit's cases with the reference, coarse to fine; InputError for an unknown limit."""
    others = [name for name in LIMITS if name != limit]
    kept: list[str] = []
    for _, group in groups(dataset):
        reference = reference_levels(group)
        on_axis = np.logical_and.reduce(
            [np.isclose(group.variables[name].values, reference[name], rtol=1e-9) for name in others]
        )
        kept.extend(group["case_id"].values[on_axis])
    chosen = dataset.isel(case=np.isin(dataset["case_id"].values, kept))
    return chosen.isel(case=np.argsort(-chosen[limit].values, kind="stable"))


_PATH_STEP = {
    "long_name": "step of the path, from the first loading",
    "units": "1",
    "symbol": "step",
    "label": "step of the path",
    "axis": "physics",
    "rank": 1000,  # the last of all
}


def steps_of(dataset: xr.Dataset, variable: str, step: int | None = None) -> list[xr.Dataset]:
    """Datasets `(case, realisation)` in which a variable of a path stands: one for each step, told by `path_step`.

    With `step` that one alone. What is known of the path as a whole stands once, with the contact of the step with
    the largest area. A dataset without a path stands for itself. UnusableDataError for a step that there is not.
    """
    along = {"case", "step"} <= set(dataset.dims)
    at_steps = along and variable in dataset and "step" in dataset[variable].dims
    if step is not None and not (at_steps and type(step) is int and 0 <= step < dataset.sizes["step"]):
        steps = f"a step from 0 to {dataset.sizes['step'] - 1}" if at_steps else f"nothing, as {variable} has no steps"
        raise UnusableDataError(f"step: you gave {brief(step)}; gfmd allows {steps}")
    if not along:
        return [dataset]
    if at_steps:
        return [_at_step(dataset, each) for each in (range(dataset.sizes["step"]) if step is None else [step])]
    largest = 0
    if "contact_area_fraction" in dataset:
        area = dataset["contact_area_fraction"]
        area = area.mean(set(area.dims) - {"step"})
        largest = int(np.nan_to_num(area).argmax())
    return [_at_step(dataset, largest).drop_vars("path_step")]


def joined(fits: Sequence[xr.Dataset]) -> xr.Dataset:
    """Return one fit with the groups of several."""
    whole = xr.concat(
        fits,
        "group",
        data_vars="minimal",
        coords="minimal",
        compat="override",
        join="override",
        combine_attrs="override",
    )
    return whole.assign_coords(group=("group", np.arange(whole.sizes["group"]), fits[0]["group"].attrs))


def _at_step(dataset: xr.Dataset, step: int) -> xr.Dataset:
    one = dataset.isel(step=step).drop_vars("step", errors="ignore")
    if {"step_load", "reduced_pressure"} <= set(dataset.variables):  # which is that of the first load
        first = dataset["step_load"].isel(step=0).values
        share = np.divide(one["step_load"].values, first, out=np.full(len(first), np.nan), where=first != 0.0)
        one = one.assign_coords({PATH_LOAD: ("case", one["reduced_pressure"].values * share)})
    return one.assign_coords(path_step=("case", np.full(one.sizes["case"], step), _PATH_STEP))
