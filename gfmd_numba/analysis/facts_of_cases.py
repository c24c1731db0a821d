"""Facts that a campaign's file holds of its cases, and what stands for those that older files lack."""

from math import inf, nan

import numpy as np
import xarray as xr

from gfmd_numba.arrays import Reals

PATH_LOAD = "path_load"  # coordinate of the reduced pressure at one step of a path


def residual_error(cases: xr.Dataset, variable: str) -> Reals:
    """Return what the solver's residual leaves open of each case's mean, in proportion to kappa for other variables."""
    if not {"kappa", "kappa_residual_error"} <= set(map(str, cases.variables)):
        return np.full(cases.sizes["case"], nan)
    share = cases["kappa_residual_error"] / cases["kappa"]
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


def thinnest_layer_of(cases: xr.Dataset) -> float:
    """Return the height of the thinnest layer of the bodies over the period, inf for half-spaces."""
    return float(cases["thinnest_layer"].values.min()) if "thinnest_layer" in cases else inf


def load_of(cases: xr.Dataset) -> float:
    """Return the reduced pressure of cases, at a step of a path that step's; nan if it differs or is not known."""
    for name in (PATH_LOAD, "reduced_pressure"):
        if name in cases.coords:
            loads = cases[name].values.astype(float)
            return float(loads[0]) if np.allclose(loads, loads[0], rtol=1e-9, atol=0.0) else nan
    return nan


def nodes_per_segment(cases: xr.Dataset, dimension: int) -> float:
    """Return the mean number of nodes in a stretch or patch of contact, of the case that has most; inf if unknown."""
    if not {"contact_area_fraction_counted", "n_segments", "nx"} <= set(map(str, cases.variables)):
        return np.inf
    nodes = (cases["contact_area_fraction_counted"] * cases["nx"] ** dimension).sum("realisation").values
    segments = cases["n_segments"].sum("realisation").values
    # full contact has neither, and no edges to resolve
    found = np.divide(nodes, segments, out=np.where(nodes > 0, np.inf, 0.0), where=segments > 0)
    return float(found.max(initial=0.0)) or np.inf
