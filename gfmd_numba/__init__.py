"""Batch campaigns of Green's function molecular dynamics for rough elastic contacts."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr
    from dask.distributed import Client
    from numpy.typing import ArrayLike

    from gfmd_numba.scene import BoundaryFile, SceneFile

__all__ = ["body_fields", "contact_statistics", "fit_tfc", "make_surface", "open_campaign", "run", "solve"]


def solve(scene: str | Path | Mapping[str, Any] | SceneFile | BoundaryFile) -> xr.Dataset:
    """Solve one contact or loaded body: a file, mapping or record in, fields over x and scalars out (SI units)."""
    from gfmd_numba.scene import BoundaryFile, SceneFile, has_no_punch

    if isinstance(scene, BoundaryFile) or (not isinstance(scene, SceneFile) and has_no_punch(scene)):
        from gfmd_numba.simulate.loaded_body import solve_loaded

        return solve_loaded(scene)
    from gfmd_numba.simulate.contact import solve_scene

    return solve_scene(scene)


def body_fields(contact: xr.Dataset, z: ArrayLike | None = None, body: str = "body") -> xr.Dataset:
    """Displacement, strain and stress over (z, x) inside the body (or `counter_body`) of a solved contact.

    z counts from its surface, negative inside; without z, 101 levels down to the base. Raises InputError for z outside.
    """
    from gfmd_numba.simulate.fields import body_fields as fields_of

    _check_dataset("contact", contact, "solve")
    return fields_of(contact, z, body)


def make_surface(source: str | Path | Mapping[str, Any]) -> xr.Dataset:
    """Make one rough surface: a surface file or mapping in, heights and statistics beside theory out (m or L_x)."""
    from gfmd_numba.simulate.surface import surface_dataset

    return surface_dataset(source)


def run(
    campaign: str | Path | Mapping[str, Any], output: str | Path | None = None, workers: int | Client = 0
) -> xr.Dataset:
    """Run or resume a campaign, a file or a mapping of its keys, and open its results; raises InputError.

    The output directory is by default named after the campaign. `workers` above 0 are local processes; as they import
    the calling script, the call must then stand under `if __name__ == "__main__":`. A dask client has its cluster do
    the work.
    """
    from gfmd_numba.campaign.execution import workers_of
    from gfmd_numba.campaign.run import run as run_campaign
    from gfmd_numba.scene import InputError

    if not (output is None or isinstance(output, str | PathLike)):
        raise InputError(f"output: given {output!r:.60}; allowed: the path of a directory")
    results = open_campaign(run_campaign(campaign, output, workers_of(workers))[0])
    if results.attrs.get("validity"):
        warnings.warn(results.attrs["validity"], stacklevel=2)
    return results


def open_campaign(path: str | Path) -> xr.Dataset:
    """Results of a campaign, from its netCDF file or its output directory; raises InputError."""
    import os

    from gfmd_numba.campaign.results import read_results
    from gfmd_numba.scene.document import InputError, brief

    if not isinstance(path, str | os.PathLike):
        raise InputError(f"path: given {brief(path)}; allowed: a netCDF file, or the output directory of a campaign")
    return read_results(Path(path))


def fit_tfc(dataset: xr.Dataset, **options: Any) -> xr.Dataset:
    """Fit kappa to its thermodynamic-fractal-continuum limit; options as in `gfmd_numba.analysis.fit_tfc`."""
    from gfmd_numba.analysis import fit_tfc as fit

    _check_dataset("dataset", dataset, "open_campaign")
    return fit(dataset, **options)


def contact_statistics(dataset: xr.Dataset) -> xr.Dataset:
    """Distributions of pressure, gap and segment length of what `solve` returns, beside Persson's theory."""
    from gfmd_numba.analysis import contact_statistics as statistics

    _check_dataset("dataset", dataset, "solve")
    return statistics(dataset)


def _check_dataset(name: str, given: object, maker: str) -> None:
    """Raise InputError, by the argument's name, unless a dataset is given."""
    import xarray as xr

    from gfmd_numba.scene.document import InputError, brief

    if not isinstance(given, xr.Dataset):
        raise InputError(f"{name}: given {brief(given)}; allowed: an xarray.Dataset, as gfmd_numba.{maker} returns")
