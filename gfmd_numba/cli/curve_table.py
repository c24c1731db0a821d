"""A load curve as a table: its columns by name and unit for a file, and what of it a terminal shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gfmd_numba.cli.columns import print_table
from gfmd_numba.cli.quantities import column, unit

if TYPE_CHECKING:
    import xarray as xr


def columns(dataset: xr.Dataset) -> dict[str, list[object]]:
    """Columns of the table as in the netCDF file, by name and unit."""
    view = _named(dataset)
    names = [str(name) for name in ("prescribed_load", *dataset.data_vars)]
    units = {
        name: unit(view, _prescribed(dataset) if name == "prescribed_load" else name.removesuffix("_standard_error"))
        for name in names
    }
    return {f"{name} ({units[name] or '1'})": dataset[name].values.tolist() for name in names}


def _prescribed(dataset: xr.Dataset) -> str:
    """Name of the variable that the loading prescribes."""
    given = str(dataset.attrs["prescribed"])
    return {"displacement": "punch_displacement", "pressure": "prescribed_pressure"}.get(given, given)


def _named(dataset: xr.Dataset) -> xr.Dataset:
    """Dataset whose load has the name of what is prescribed."""
    return dataset.assign({_prescribed(dataset): dataset["prescribed_load"]})


def show(dataset: xr.Dataset) -> None:
    """Print the curve, one line a load."""
    view, load = _named(dataset), _prescribed(dataset)
    same = {load, "mean_pressure"} if load == "prescribed_pressure" else {load}
    shown = [name for name in _SHOWN if name in view and name not in same]
    values = dict(column(view, name) for name in shown)
    states = dataset["status"].attrs["flag_meanings"].split()
    if dataset["status"].any():
        values["status"] = [states[int(status)] for status in dataset["status"]]
    if int(dataset["n_realisations"].max()) > 1:
        values["surfaces"] = [str(int(count)) for count in dataset["n_realisations"]]
    heading, loads = column(view, load)
    print_table("load curve", {heading: loads}, values)


_SHOWN = (
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
