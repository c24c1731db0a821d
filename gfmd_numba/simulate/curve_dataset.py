"""What a load curve amounts to: one row a load, the mean over realisations with its standard error."""

from typing import Any

import numpy as np
import xarray as xr

from gfmd_numba.contact.dataset import CONVENTIONS, cf_attributes, load_attributes, scales, units
from gfmd_numba.scene import BoundaryFile, Document, Scene, SceneFile
from gfmd_numba.scene.quantities import REDUCED_PRESSURE
from gfmd_numba.simulate.curve import LoadCurve, by_realisation, read_curve, solve_curve
from gfmd_numba.solvers import status

_COLUMNS = (
    "reduced_pressure",
    "mean_pressure",
    "contact_area_fraction",
    "contact_area",
    "contact_length",
    "mean_gap",
    "contact_stiffness",
    "peak_pressure",
    "n_segments",
    "elastic_energy",
)
_PRESSURES = {"reduced_pressure", "mean_pressure"}  # without an error where the scene prescribes them
_METHOD = (
    "difference of two solutions: each load is approached from a load 0.1 % before it (displacements: 0.1 % of their "
    "range; at most half-way from the load before); no exact tangent"
)
_COORDINATES = {"displacement": "punch_displacement", "pressure": "prescribed_pressure"}


def load_curve(file: SceneFile | BoundaryFile, document: Document, loads: object, realisations: object) -> xr.Dataset:
    """Observables over `prescribed_load` in SI units; raises InputError. The `status` says which runs failed."""
    curve = read_curve(file, document, loads, realisations)
    return curve_dataset(curve, list(solve_curve(curve)))


def curve_dataset(curve: LoadCurve, solved: list[xr.Dataset]) -> xr.Dataset:
    """One row a load of what was solved, all or the beginning of it: columns `[prescribed_load]` in SI units.

    Several realisations give means and standard errors over those that are ok at a load, which `n_realisations` counts.
    """
    found = by_realisation(curve, solved)
    _add_derived(curve, found)
    ok = found["status"] == 0
    dataset = xr.Dataset(coords={"prescribed_load": found["prescribed_load"]})
    count = ok.sum("realisation")
    for name in (name for name in _COLUMNS if name in found):
        values = found[name].where(ok)
        dataset[name] = values.mean("realisation").assign_attrs(found[name].attrs)
        if curve.realisations > 1 and not (curve.prescribed != "displacement" and name in _PRESSURES):
            attributes = cf_attributes(f"standard error of {name} over realisations", found[name].units)
            dataset[f"{name}_standard_error"] = _standard_error(values).assign_attrs(attributes)
    dataset["n_realisations"] = count.assign_attrs(cf_attributes("realisations that are ok at this load"))
    worst = found["status"].max("realisation").astype(np.int8)
    dataset["status"] = worst.assign_attrs(
        cf_attributes("how the runs at this load ended, the worst of them") | status.flag_attributes(status.SENTENCES)
    )
    dataset["residual"] = found["residual"].max("realisation").assign_attrs(found["residual"].attrs)
    for name in ("n_iterations", "wall_time"):
        dataset[name] = found[name].sum("realisation").assign_attrs(found[name].attrs)
    dataset["prescribed_load"].attrs = load_attributes(curve.given.file.scene)[
        _COORDINATES.get(curve.prescribed, curve.prescribed)
    ]
    dataset.attrs = {
        **found.attrs,
        "Conventions": CONVENTIONS,
        "title": "load curve",
        "scene": curve.given.file.model_dump_json(),
        "prescribed": curve.prescribed,
    }
    if len(solved) < len(curve.loads) * curve.realisations:
        dataset.attrs["interrupted"] = _finished(curve, found)
    return dataset


def _standard_error(values: xr.DataArray) -> xr.DataArray:
    """Standard error of the mean over realisations; nan of one value, and of infinite ones."""
    finite = values.where(np.isfinite(values.mean("realisation")))
    count = finite.count("realisation")
    squares = ((finite - finite.mean("realisation")) ** 2).sum("realisation")
    error: xr.DataArray = (squares / (count - 1).where(count > 1) / count) ** 0.5
    return error


def _add_derived(curve: LoadCurve, found: xr.Dataset) -> None:
    """Add what the path and the size of the period make of the recorded scalars."""
    scene = curve.given.file.scene
    one = scales(scene, curve.given.surfaces.rms_gradient)["pressure"]
    found["reduced_pressure"] = (found["mean_pressure"] / one).assign_attrs(cf_attributes(REDUCED_PRESSURE))
    if scene.length is not None:
        name, unit = {1: ("contact_length", "m"), 2: ("contact_area", "m2")}[scene.dimension]
        attributes = cf_attributes(f"real {name.replace('_', ' ')} over one period", unit)
        found[name] = (found["contact_area_fraction"] * scene.length**scene.dimension).assign_attrs(attributes)
    found["contact_stiffness"].attrs = _stiffness_attributes(scene)


def _stiffness_attributes(scene: Scene) -> dict[str, Any]:
    unit = units(scene)
    per = [unit["pressure"]] if unit["pressure"] != "1" else []
    per += [f"{unit['height']}-1"] if unit["height"] != "1" else []
    long_name = "contact stiffness beyond uniform compression, -d(mean_pressure)/d(mean_gap)"
    return cf_attributes(long_name, " ".join(per) or "1") | {"comment": _METHOD}


def _finished(curve: LoadCurve, found: xr.Dataset) -> str:
    loads, realisations = found.sizes["prescribed_load"], found.sizes["realisation"]
    if curve.realisations == 1:
        return f"after {loads} of {len(curve.loads)} loads"
    if loads < len(curve.loads):
        return f"after {loads} of {len(curve.loads)} loads of the first of {curve.realisations} realisations"
    return f"after {realisations} of {curve.realisations} realisations"
