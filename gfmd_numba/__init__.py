"""Batch campaigns of Green's function molecular dynamics for rough elastic contacts."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from gfmd_numba.text.input_error import InputError, brief

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
    from dask.distributed import Client
    from numpy.typing import ArrayLike

    from gfmd_numba.campaign.file import Campaign
    from gfmd_numba.campaign.goal import Goal
    from gfmd_numba.scene import BoundaryFile, SceneFile
    from gfmd_numba.scene.surface_file import SurfaceFile

__version__ = "0.1.0"
__all__ = [
    "InputError",
    "__version__",
    "body_fields",
    "contact_conductance",
    "contact_statistics",
    "creep_curve",
    "fit_tfc",
    "friction_curve",
    "gap_percolation",
    "leakage",
    "load_curve",
    "make_surface",
    "open_campaign",
    "rounds",
    "run",
    "solve",
]


def solve(
    scene: str | Path | Mapping[str, Any] | SceneFile | BoundaryFile,
    heights: np.ndarray[Any, Any] | xr.DataArray | None = None,
) -> xr.Dataset:
    """Solve one contact, or a body loaded without a punch, and return its fields and scalars in SI units.

    `scene` is a file, a mapping of its content, or a record. `heights` `[nx]` or `[ny, nx]` are the heights of the
    rigid punch, peaks towards the body. The scene's `roughness` then holds no other surface, but it may say how the
    heights are treated. An xarray array may carry positions and units. If the scene has a length or moduli in Pa, the
    unit of a NumPy array has to stand in the scene, as `roughness: {units: {z: m}}`. In a scene without either, heights
    are in L_x. A run that fails is marked in `status`. Raises InputError for a scene that makes no sense.
    """
    from gfmd_numba import simulate
    from gfmd_numba.scene import load_scene
    from gfmd_numba.scene.scene_file import with_heights

    return simulate.solve(*load_scene(scene if heights is None else with_heights(scene, heights)))


def creep_curve(
    scene: str | Path | Mapping[str, Any] | SceneFile,
    times: Sequence[float | str],
    realisations: int = 1,
    heights: np.ndarray[Any, Any] | xr.DataArray | None = None,
) -> xr.Dataset:
    """Press a viscoelastic body by the load of its scene and return its observables over `time` in SI units.

    `times` count from when the load begins to act, in s or as text with units, like `1 min`; they rise. All else is as
    in `load_curve`. The column `time_error` has the error by the divisions of time. Raises InputError for what makes no
    sense.
    """
    from gfmd_numba.scene import load_scene
    from gfmd_numba.scene.scene_file import with_heights
    from gfmd_numba.simulate.curve import creep_curve as curve_of

    return _warned(
        curve_of(*load_scene(scene if heights is None else with_heights(scene, heights)), times, realisations)
    )


def friction_curve(
    scene: str | Path | Mapping[str, Any] | SceneFile,
    speeds: Sequence[float | str],
    realisations: int = 1,
    heights: np.ndarray[Any, Any] | xr.DataArray | None = None,
) -> xr.Dataset:
    """Slide the punch of a scene over its viscoelastic body and return its observables over `speed` in SI units.

    `speeds` are in m/s (L_x/s without a length) or text with units, like `1 mm/s`; they all rise or all fall. At each
    speed the punch has slid for ever. `hysteretic_friction` is the coefficient of friction by the losses in the body.
    All else is as in `load_curve`. Raises InputError for what makes no sense.
    """
    from gfmd_numba.scene import load_scene
    from gfmd_numba.scene.scene_file import with_heights
    from gfmd_numba.simulate.curve import friction_curve as curve_of

    return _warned(
        curve_of(*load_scene(scene if heights is None else with_heights(scene, heights)), speeds, realisations)
    )


def load_curve(
    scene: str | Path | Mapping[str, Any] | SceneFile,
    loads: Sequence[float | str],
    realisations: int = 1,
    heights: np.ndarray[Any, Any] | xr.DataArray | None = None,
) -> xr.Dataset:
    """Solve a scene at one load after another and return its observables over `prescribed_load` in SI units.

    `scene` is a file, a mapping of its content, or a record. `loads` are values of what the scene's loading prescribes,
    like reduced pressures p/(g E*) or displacements of the punch (m or L_x), or text with units, like `50 MPa`. They
    all rise or all fall, and each solution begins where the last one ended. `heights` are as in `solve`. With several
    `realisations` of random surfaces, the observables are means, whose standard errors are called `..._standard_error`.
    The contact stiffness is taken over a short step of the load before each load. A load at which a run failed is
    marked in `status`. Raises InputError for what makes no sense.
    """
    from gfmd_numba.scene import load_scene
    from gfmd_numba.scene.scene_file import with_heights
    from gfmd_numba.simulate.curve import load_curve as curve_of

    return _warned(
        curve_of(*load_scene(scene if heights is None else with_heights(scene, heights)), loads, realisations)
    )


def body_fields(
    contact: xr.Dataset | str | Path,
    z: ArrayLike | None = None,
    body: str = "body",
    x: float | None = None,
    y: float | None = None,
    planes: ArrayLike | None = None,
) -> xr.Dataset:
    """Return displacement, strain and stress over (z, x) inside the body (or `counter_body`) of a solved contact.

    `contact` is what `solve` returns, or the path of its netCDF file. `z` counts from the body's surface, is negative
    inside, and has the unit of x. Without it, there are 101 levels down to the base. Below a map the fields are those
    of the vertical section nearest to `y`, or to `x`; without either, of the section through the largest von Mises
    stress. With `planes`, heights like `z`, they are those of whole horizontal planes. Raises InputError for z outside
    the body, and for a contact that was cropped or thinned, because the tractions of a whole period are needed.
    """
    from gfmd_numba.simulate.fields import body_fields as fields_of

    return fields_of(_dataset("contact", contact, "solve"), z, body, x, y, planes)


def make_surface(surface: str | Path | Mapping[str, Any] | SurfaceFile) -> xr.Dataset:
    """Make one rough surface and return its heights (m or L_x), and its statistics with those of theory.

    `surface` is a file, a mapping of its content, or a record. Raises InputError for a description that makes no sense,
    or a measured file that cannot be used.
    """
    from gfmd_numba.scene.surface_file import load_surface
    from gfmd_numba.simulate.surface import surface_dataset

    return surface_dataset(*load_surface(surface))


def run(
    campaign: str | Path | Mapping[str, Any] | Campaign,
    output: str | Path | None = None,
    workers: int | Client | str | Path | Mapping[str, Any] = 0,
    until: Mapping[str, float] | None = None,
    budget: float | str | None = None,
) -> xr.Dataset:
    """Run or resume a campaign and return its results.

    `campaign` is a file, a mapping of its content, or a record. The output directory is by default named after the
    campaign. `workers` is the number of local worker processes; 0 works in this process. Worker processes import the
    calling script, so that the call must then stand under `if __name__ == "__main__":`. If `workers` is a dask client,
    its cluster does the work. If it is a cluster file, or a mapping of its content, jobs of a queueing system do the
    work. With `until={"kappa": 0.01}`, or such a `target` in a campaign without `realisations`, the campaign runs in
    rounds until kappa in the limit has a relative standard error of 1 %, with as many realisations and as fine levels
    as that takes. `budget` bounds the processor time (s, or text like `20min`).
    The attribute `ended` says how the rounds ended; a warning says if the error was not reached.
    Raises InputError for a campaign or arguments that make no sense.
    """
    from gfmd_numba.campaign.execution import workers_of
    from gfmd_numba.campaign.run import run as run_campaign

    goal = _goal(campaign, output, until, budget)
    if goal is None:
        results = open_campaign(run_campaign(campaign, output, workers_of(workers))[0])
    else:
        from gfmd_numba.campaign.until import run_until

        outcome = run_until(campaign, goal, output, workers_of(workers))
        results = open_campaign(outcome.results)
        if not outcome.reached:
            warnings.warn(f"{results.attrs['until']} is {outcome.rounds.ended}", stacklevel=2)
    if results.attrs.get("validity"):
        warnings.warn(results.attrs["validity"], stacklevel=2)
    return results


def rounds(
    campaign: str | Path | Mapping[str, Any] | Campaign,
    output: str | Path | None = None,
    workers: int | Client | str | Path | Mapping[str, Any] = 0,
    until: Mapping[str, float] | None = None,
    budget: float | str | None = None,
) -> Iterator[xr.Dataset]:
    """Run a campaign to a target, and yield its results after each round, before the next one begins.

    The arguments are those of `run`; `until`, or a `target` in the campaign, is needed. Leave the loop to stop with the
    results you have: the same call, or `run`, goes on from there. Raises InputError as `run` does.
    """
    from gfmd_numba.campaign.execution import workers_of
    from gfmd_numba.campaign.until import each_round

    goal = _goal(campaign, output, until, budget)
    if goal is None:
        raise InputError("until: you gave none, and no target in the campaign; gfmd allows one like {'kappa': 0.01}")
    return (open_campaign(outcome.results) for outcome in each_round(campaign, goal, output, workers_of(workers)))


def open_campaign(path: str | Path) -> xr.Dataset:
    """Open the results of a campaign, from its netCDF file or its output directory; raises InputError."""
    from gfmd_numba.campaign.results import read_results

    if not isinstance(path, str | os.PathLike):
        raise InputError(
            f"path: you gave {brief(path)}; gfmd allows a netCDF file, or the output directory of a campaign"
        )
    return read_results(Path(path))


def fit_tfc(
    dataset: xr.Dataset | str | Path,
    variable: str = "kappa",
    exponents: Literal["shared", "free"] = "shared",
    fixed: Mapping[str, float | Sequence[float]] | None = None,
    omit_nyquist: bool = True,
    step: int | None = None,
) -> xr.Dataset:
    """Extrapolate kappa of a campaign to the thermodynamic, fractal and continuum limit.

    `dataset` holds the results of the campaign, or is their path. `exponents` are shared by all groups of cases or free
    in each. `fixed` holds exponents that are known, or the ranges they lie in, like `{"eps_c": 1.0, "eps_f": (0.5,
    1.0)}`. Along a loading path every step is fitted, or the given one alone. The returned dataset is that of
    `gfmd_numba.analysis.fit_tfc`. Raises InputError for options that make no sense.
    """
    from gfmd_numba.analysis import fit_tfc as fit

    return fit(_dataset("dataset", dataset, "open_campaign"), variable, exponents, fixed, omit_nyquist, step)


def contact_statistics(dataset: xr.Dataset | str | Path) -> xr.Dataset:
    """Return distributions of pressure, gap and sizes of contacts of a solved contact, with Persson's theory.

    `dataset` is what `solve` returns, or the path of its netCDF file. Raises InputError for anything else.
    """
    from gfmd_numba.analysis import contact_statistics as statistics

    return statistics(_dataset("dataset", dataset, "solve"))


def gap_percolation(dataset: xr.Dataset | str | Path) -> xr.Dataset:
    """Channels through the gap of a map that `solve` returns, from side to side, and the largest connected gap.

    Takes the dataset or the path of its netCDF file; raises InputError for anything else.
    """
    from gfmd_numba.analysis import gap_percolation as percolation

    return percolation(_dataset("dataset", dataset, "solve"))


def leakage(dataset: xr.Dataset | str | Path) -> xr.Dataset:
    """Leakage through the gap of a map that `solve` returns, along x and y, by the Reynolds equation.

    Takes the dataset or the path of its netCDF file; raises InputError for anything else.
    """
    from gfmd_numba.analysis import leakage as leakage_of

    return _warned(leakage_of(_dataset("dataset", dataset, "solve")))


def contact_conductance(contact: xr.Dataset | str | Path) -> xr.Dataset:
    """Electrical or thermal conductance of the contact that `solve` returns, over the conductivity of the bodies.

    Takes the dataset or the path of its netCDF file; raises InputError for anything else.
    """
    from gfmd_numba.simulate.contact_conductance import contact_conductance as conductance_of

    return _warned(conductance_of(_dataset("contact", contact, "solve")))


def _goal(
    campaign: str | Path | Mapping[str, Any] | Campaign,
    output: str | Path | None,
    until: Mapping[str, float] | None,
    budget: float | str | None,
) -> Goal | None:
    """Goal that is given, or that of the campaign, if any; raises InputError for arguments of another kind."""
    from gfmd_numba.campaign.file import target_of_run
    from gfmd_numba.campaign.goal import goal_of

    if not (output is None or isinstance(output, str | os.PathLike)):
        raise InputError(f"output: you gave {output!r:.60}; gfmd allows the path of a directory")
    targets = until if until is not None else target_of_run(campaign)
    if targets is None and budget is not None:
        raise InputError("budget: you gave it without until, whose processor time it bounds; give both, or none")
    return None if targets is None else goal_of(targets, budget)


def _warned(dataset: xr.Dataset) -> xr.Dataset:
    """Dataset, whose sentences on its validity become warnings of the caller of the function that returns it."""
    for sentence in filter(None, dataset.attrs["validity"].split("\n")):
        warnings.warn(sentence, stacklevel=3)
    return dataset


def _dataset(name: str, given: xr.Dataset | str | Path, maker: str) -> xr.Dataset:
    """Dataset of a path, or as it is given; raises InputError, by the argument's name, for anything else."""
    import xarray as xr

    if isinstance(given, str | os.PathLike):
        from gfmd_numba.campaign.results import read_results

        return read_results(Path(given))
    if not isinstance(given, xr.Dataset):
        allowed = f"an xarray.Dataset, as gfmd_numba.{maker} returns, or the path of a netCDF file"
        raise InputError(f"{name}: you gave {brief(given)}; gfmd allows {allowed}")
    return given
