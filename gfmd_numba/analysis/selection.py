"""Choice of cases from a campaign dataset: groups of equal physics, one limit, good results."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

LIMITS = ("eps_c", "eps_f", "eps_t")
GROUP = ("hurst", "poissons_ratio", "aspect_ratio", "reduced_pressure", "rms_gradient_target")


def good(dataset: xr.Dataset, variable: str) -> xr.DataArray:
    """Return the mask (case, realisation) of finite, ok results; ValueError for an unknown variable."""
    if variable not in dataset:
        raise ValueError(
            f"no variable {variable!r} in the dataset; it has {', '.join(map(str, dataset.data_vars))}"
        )
    mask: xr.DataArray = dataset[variable].transpose("case", "realisation").notnull()
    mask &= abs(dataset[variable]) < np.inf
    return mask & (dataset["status"] == 0) if "status" in dataset else mask


def groups(dataset: xr.Dataset) -> Iterator[tuple[dict[str, float], xr.Dataset]]:
    """Yield (parameters, cases) for each set of cases that differ only in discretisation, in file order."""
    physics = np.stack([dataset[name].values.astype(float) for name in GROUP], axis=-1)
    members: dict[bytes, list[int]] = {}
    for index, row in enumerate(physics):
        members.setdefault(row.tobytes(), []).append(index)  # bytes: a nan parameter still equals itself
    for indices in members.values():
        yield dict(zip(GROUP, physics[indices[0]].tolist(), strict=True)), dataset.isel(case=indices)


def reference_levels(group: xr.Dataset) -> dict[str, float]:
    """Return the discretisation of a group's reference case, or the finest levels present if it has none."""
    marked = np.flatnonzero(group["is_reference"].values)
    return {
        name: float(group[name].values[marked[0]] if marked.size else group[name].min()) for name in LIMITS
    }


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
