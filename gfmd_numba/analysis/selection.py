"""Choice of cases from a campaign dataset: groups of equal physics, one limit, good results."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[np.float64]

LIMITS = ("eps_c", "eps_f", "eps_t")
GROUP = ("hurst", "poissons_ratio", "aspect_ratio", "reduced_pressure", "rms_gradient_target")


@dataclass(frozen=True)
class Group:
    """The results of one group of cases, which differ only in discretisation, as a fit takes them."""

    parameters: dict[str, float]
    values: Array  # (realisation, case)
    complete: NDArray[np.bool_]  # realisations that are good in every case
    levels: dict[str, Array]  # of the limits that are varied
    reference: dict[str, float]
    n_excluded: int
    notes: list[str]

    @property
    def n_realisations(self) -> int:
        """Number of complete realisations."""
        return int(self.complete.sum())

    @property
    def n_cases(self) -> int:
        """Number of cases."""
        return int(self.values.shape[1])

    def log_ratio(self, limit: str) -> Array:
        """Return the logarithm of a limit's levels over its reference level."""
        return np.log(self.levels[limit] / self.reference[limit])


def good(dataset: xr.Dataset, variable: str) -> xr.DataArray:
    """Return the mask (case, realisation) of finite, ok results; ValueError for an unknown variable."""
    if variable not in dataset:
        raise ValueError(f"no variable {variable!r} in the dataset; it has {', '.join(map(str, dataset.data_vars))}")
    mask: xr.DataArray = dataset[variable].transpose("case", "realisation").notnull()
    mask &= abs(dataset[variable]) < np.inf
    return mask & (dataset["status"] == 0) if "status" in dataset else mask


def ensemble_mean(cases: xr.Dataset, variable: str) -> tuple[Array, Array]:
    """Return each case's mean over good realisations and its standard error, nan where undefined."""
    usable = good(cases, variable).values
    values = cases[variable].transpose("case", "realisation").values.astype(float)
    n = usable.sum(axis=1)
    mean = np.where(n > 0, np.where(usable, values, 0).sum(axis=1) / n.clip(1), np.nan)
    squares = np.where(usable, (values - mean[:, None]) ** 2, 0).sum(axis=1)
    return mean, np.where(n > 1, np.sqrt(squares / (n - 1).clip(1) / n.clip(1)), np.nan)


def groups(dataset: xr.Dataset) -> Iterator[tuple[dict[str, float], xr.Dataset]]:
    """Yield (parameters, cases) for each set of cases that differ only in discretisation, in file order."""
    physics = np.stack([dataset[name].values.astype(float) for name in GROUP], axis=-1)
    members: dict[bytes, list[int]] = {}
    for index, row in enumerate(physics):
        members.setdefault(row.tobytes(), []).append(index)  # bytes: a nan parameter still equals itself
    for indices in members.values():
        yield dict(zip(GROUP, physics[indices[0]].tolist(), strict=True)), dataset.isel(case=indices)


def collect(dataset: xr.Dataset, variable: str, omit_nyquist: bool) -> list[Group]:
    """Return the groups, cases that mostly failed left out; ValueError for an unknown variable."""
    usable = good(dataset, variable)
    dataset = dataset.assign({variable: dataset[variable].where(usable)})
    return [_collected(parameters, cases, variable, omit_nyquist) for parameters, cases in groups(dataset)]


def _collected(parameters: dict[str, float], cases: xr.Dataset, variable: str, omit_nyquist: bool) -> Group:
    reference = reference_levels(cases)
    if omit_nyquist:
        cases = cases.isel(case=cases["eps_c"].values < 1 - 1e-9)
    values = cases[variable].transpose("realisation", "case").values.astype(float)
    present = np.isfinite(values)
    n_present, n_run = present.sum(axis=0), present.any(axis=1).sum()
    # only complete realisations are fitted: a case that mostly failed would leave hardly any
    dead, poor = n_present == 0, (n_present > 0) & (2 * n_present < n_run)
    kept = ~(dead | poor)
    notes = []
    for left_out, why in ((dead, "no good realisation"), (poor, "failed in more than half of the realisations")):
        if left_out.any():
            notes.append(f"left out, {why}: {', '.join(map(str, cases['case_id'].values[left_out]))}")
    some, complete = present[:, kept].any(axis=1), present[:, kept].all(axis=1) & kept.any()
    if some.sum() > complete.sum():
        dropped = some.sum() - complete.sum()
        notes.append(f"{dropped} of {some.sum()} realisations dropped, not good in every case")
    levels = {}
    for name in LIMITS:
        level = cases[name].values.astype(float)[kept]
        if np.unique(level).size > 1:
            levels[name] = level
        else:
            notes.append(f"{name} is not varied: kappa_tfc is not extrapolated in it")
    n_excluded = int((~present).sum())
    return Group(parameters, values[:, kept], complete, levels, reference, n_excluded, notes)


def reference_levels(group: xr.Dataset) -> dict[str, float]:
    """Return the discretisation of a group's reference case, or the finest levels present if it has none."""
    marked = np.flatnonzero(group["is_reference"].values)
    return {name: float(group[name].values[marked[0]] if marked.size else group[name].min()) for name in LIMITS}


def select_limit(dataset: xr.Dataset, limit: str) -> xr.Dataset:
    """Return one limit's cases with the reference, coarse to fine; ValueError for an unknown limit."""
    if limit not in LIMITS:
        raise ValueError(f"unknown limit {limit!r}; choose one of {', '.join(LIMITS)}")
    others = [name for name in LIMITS if name != limit]
    kept: list[str] = []
    for _, group in groups(dataset):
        reference = reference_levels(group)
        on_axis = np.all([np.isclose(group[name], reference[name], rtol=1e-9) for name in others], axis=0)
        kept.extend(group["case_id"].values[on_axis])
    chosen = dataset.isel(case=np.isin(dataset["case_id"].values, kept))
    return chosen.isel(case=np.argsort(-chosen[limit].values, kind="stable"))
