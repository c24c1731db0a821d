"""Batch campaigns of Green's function molecular dynamics for rough elastic contacts.

Numbers in parentheses, like (4.2), are equations of the thesis that the method comes from; `docs/errata.md` names it
and corrects some of them.
"""

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
    from gfmd_numba.scene import SceneFile
    from gfmd_numba.scene.surface_file import SurfaceFile

__version__ = "0.1.0"
__all__ = [
    "InputError",
    "__version__",
    "body_fields",
    "contact_conductance",
    "contact_statistics",
    "fit_tfc",
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
    scene: str | Path | Mapping[str, Any] | SceneFile, heights: np.ndarray[Any, Any] | xr.DataArray | None = None
) -> xr.Dataset:
    """Solve one contact, or a body loaded without a punch.

    Parameters
    ----------
    scene
        A file, a mapping of its content, or a record.
    heights
        Heights of the rigid punch, `[nx]` or `[ny, nx]`, peaks towards the body, if no surface of the scene is used.
        The scene's `roughness` may say how they are treated. An xarray array may carry positions and units. If the
        scene has a length or moduli in Pa, the unit of a NumPy array has to stand in the scene, as
        `roughness: {units: {z: m}}`. In a scene without either, heights are in L_x.

    Returns
    -------
    xarray.Dataset
        Fields over x (and y) and scalars, in SI units. A run that fails is marked in `status`, and warned of.

    Raises
    ------
    InputError
        The scene makes no sense.

    Examples
    --------
    >>> scene = {
    ...     "dimension": 2,
    ...     "body": {"poissons_ratio": 0.3, "aspect_ratio": 1},
    ...     "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05},
    ...     "interface": {"hard_wall": {}},
    ...     "loading": {"reduced_pressure": 0.05},
    ... }
    >>> levels = {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2}
    >>> contact = gfmd_numba.solve({"scene": scene, "discretisation": levels})
    >>> contact["pressure"].sizes["x"], round(contact["contact_area_fraction"].item(), 3)
    (64, 0.108)
    """
    from gfmd_numba import simulate
    from gfmd_numba.scene import load_scene

    file, document = load_scene(scene, heights)
    return _warned(simulate.solve(file, document))


def load_curve(
    scene: str | Path | Mapping[str, Any] | SceneFile,
    loads: Sequence[float | str] | None = None,
    realisations: int = 1,
    heights: np.ndarray[Any, Any] | xr.DataArray | None = None,
    times: Sequence[float | str] | None = None,
    speeds: Sequence[float | str] | None = None,
) -> xr.Dataset:
    """Solve a scene at one load after another, or a viscoelastic body at one time or sliding speed after another.

    Parameters
    ----------
    scene
        A file, a mapping of its content, or a record.
    loads
        Values of what the scene's loading prescribes, like reduced pressures p/(g E*) or displacements of the punch (m
        or L_x), or text with units, like `50 MPa`. They all rise or all fall, and each solution begins where the last
        one ended.
    realisations
        With several random surfaces, observables are means with standard errors `..._standard_error`.
    heights
        As in `solve`.
    times
        In place of loads, rising times since the load of the scene began to act, in s or text with units, like `1 min`.
    speeds
        In place of loads, sliding speeds in m/s (L_x/s without a length) or text with units, like `1 mm/s`, which all
        rise or all fall. At each speed the punch has slid for ever.

    Returns
    -------
    xarray.Dataset
        Observables over `prescribed_load`, `time` or `speed` in SI units. The contact stiffness is taken over a short
        step before each load, below the first of falling ones; over times, `time_error` is the error by the divisions
        of steps; over speeds, `hysteretic_friction` is the coefficient of friction by the losses in the body. A load at
        which a run failed is marked in `status`.

    Raises
    ------
    InputError
        The scene or the loads make no sense.

    Examples
    --------
    >>> curve = gfmd_numba.load_curve({"scene": scene, "discretisation": levels}, [0.05, 0.1])
    >>> curve["contact_area_fraction"].values.round(3)
    array([0.108, 0.202])
    >>> rubber = {"poissons_ratio": 0.5, "relaxation": [{"modulus": 3.0, "time": "1 s"}]}
    >>> seal = {"scene": {**scene, "dimension": 1, "body": rubber}, "discretisation": levels}
    >>> gfmd_numba.load_curve(seal, times=["0.1 s", "10 s"])["contact_area_fraction"].values.round(3)
    array([0.041, 0.148])
    >>> gfmd_numba.load_curve(seal, speeds=[0.01, 1.0])["hysteretic_friction"].values.round(4)
    array([0.0164, 0.001 ])
    """
    from gfmd_numba.scene import load_scene
    from gfmd_numba.simulate.curve import curve_of

    file, document = load_scene(scene, heights)
    return _warned(curve_of(file, document, {"loads": loads, "times": times, "speeds": speeds}, realisations))


def body_fields(
    contact: xr.Dataset | str | Path,
    z: ArrayLike | None = None,
    body: str = "body",
    x: float | None = None,
    y: float | None = None,
    planes: ArrayLike | None = None,
) -> xr.Dataset:
    """Find displacement, strain and stress inside the body of a solved contact.

    Parameters
    ----------
    contact
        What `solve` returns, or the path of its netCDF file.
    z
        Heights below the body's surface, negative inside, in the unit of x. Left out: 101 levels down to the base.
    body
        `body` or `counter_body`.
    x, y
        The vertical section below a map; left out: the one through the largest von Mises stress.
    planes
        Heights, like `z`, of whole horizontal planes below a map, in place of a section.

    Returns
    -------
    xarray.Dataset
        Fields over (z, x), (z, y), or the planes.

    Raises
    ------
    InputError
        z lies outside the body, or the contact was cropped or thinned.

    Examples
    --------
    >>> fields = gfmd_numba.body_fields(contact, z=[-0.1, 0.0])
    >>> fields["von_mises"].dims, fields["peak_von_mises"].values.round(3)
    (('z', 'x'), array([0.016, 0.017]))
    """
    from gfmd_numba.simulate.fields import body_fields as fields_of

    return fields_of(_dataset("contact", contact, "solve"), z, body, x, y, planes)


def make_surface(surface: str | Path | Mapping[str, Any] | SurfaceFile) -> xr.Dataset:
    """Make one rough surface.

    Parameters
    ----------
    surface
        A file, a mapping of its content, or a record.

    Returns
    -------
    xarray.Dataset
        Heights (m or L_x), and their statistics with those of theory.

    Raises
    ------
    InputError
        The description makes no sense, or a measured file cannot be used.

    Examples
    --------
    >>> rough = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05, "roll_off": 1 / 2, "cut_on": 1 / 16, "points": 64}
    >>> surface = gfmd_numba.make_surface({"surface": rough})
    >>> surface["height"].size, round(surface["rms_gradient"].item(), 3)
    (64, 0.05)
    """
    from gfmd_numba.scene.surface_file import load_surface
    from gfmd_numba.simulate.surface import surface_dataset

    return _warned(surface_dataset(*load_surface(surface)))


def run(
    campaign: str | Path | Mapping[str, Any] | Campaign,
    output: str | Path | None = None,
    workers: int | Client | str | Path | Mapping[str, Any] = 0,
    until: Mapping[str, float] | None = None,
    budget: float | str | None = None,
) -> xr.Dataset:
    """Run or resume a campaign.

    Parameters
    ----------
    campaign
        A file, a mapping of its content, or a record.
    output
        Directory of the results; by default it is named after the campaign.
    workers
        Number of local worker processes; 0 works in this process. Worker processes import the calling script, so that
        the call must then stand under `if __name__ == "__main__":`. A dask client, a cluster file, or a mapping of its
        content gives the work to others.
    until
        Targets like `{"kappa": 0.01}`: rounds until kappa in the limit has a relative standard error of 1 %. A `target`
        in a campaign without `realisations` does the same.
    budget
        Largest processor time of the rounds (s, or text like `20min`).

    Returns
    -------
    xarray.Dataset
        Results over (case, realisation). The attribute `ended` says how the rounds ended; a warning says if the error
        was not reached.

    Raises
    ------
    InputError
        The campaign or the arguments make no sense.

    Examples
    --------
    >>> campaign = {"name": "small", "seed": 1, "realisations": 8, "scene": {**scene, "dimension": 1}}
    >>> campaign |= {"reference": levels, "limits": {"eps_f": [1 / 2, 1 / 4, 1 / 16]}}
    >>> results = gfmd_numba.run(campaign)
    >>> round(results["kappa"].where(results["is_reference"]).mean().item(), 2)
    2.6
    """
    from gfmd_numba.campaign.run import run as run_campaign
    from gfmd_numba.campaign.workers import workers_of

    goal = _goal(campaign, output, until, budget)
    if goal is None:
        results = open_campaign(run_campaign(campaign, output, workers_of(workers))[0])
    else:
        from gfmd_numba.campaign.run import run_until

        outcome = run_until(campaign, goal, output, workers_of(workers))
        results = open_campaign(outcome.results)
        if not outcome.reached:
            warnings.warn(f"{results.attrs['until']} is {outcome.rounds.ended}", stacklevel=2)
    return _warned(results)


def rounds(
    campaign: str | Path | Mapping[str, Any] | Campaign,
    output: str | Path | None = None,
    workers: int | Client | str | Path | Mapping[str, Any] = 0,
    until: Mapping[str, float] | None = None,
    budget: float | str | None = None,
) -> Iterator[xr.Dataset]:
    """Run a campaign to a target, round by round.

    Parameters
    ----------
    campaign, output, workers, until, budget
        As in `run`; `until`, or a `target` in the campaign, is needed.

    Yields
    ------
    xarray.Dataset
        The results after each round, before the next one begins. Leave the loop to stop with the results you have:
        the same call, or `run`, goes on from there.

    Raises
    ------
    InputError
        As in `run`.

    Examples
    --------
    >>> for results in gfmd_numba.rounds({**campaign, "name": "rounds"}, until={"kappa": 0.3}):
    ...     print(results.sizes["round"], results.attrs["ended"])
    1 reached
    """
    from gfmd_numba.campaign.run import each_round
    from gfmd_numba.campaign.workers import workers_of

    goal = _goal(campaign, output, until, budget)
    if goal is None:
        raise InputError.of("until", "none, and no target in the campaign", "one like {'kappa': 0.01}")
    return (open_campaign(outcome.results) for outcome in each_round(campaign, goal, output, workers_of(workers)))


def open_campaign(path: str | Path) -> xr.Dataset:
    """Open the results of a campaign.

    Parameters
    ----------
    path
        The netCDF file, or the output directory of the campaign.

    Returns
    -------
    xarray.Dataset
        Results over (case, realisation).

    Raises
    ------
    InputError
        There are no results of a campaign.

    Examples
    --------
    >>> gfmd_numba.open_campaign("small")["kappa"].dims
    ('case', 'realisation')
    """
    from gfmd_numba.campaign.results import read_results

    if not isinstance(path, str | os.PathLike):
        raise InputError.of("path", brief(path), "a netCDF file, or the output directory of a campaign")
    results = read_results(Path(path))
    if not {"case", "realisation"} <= set(results.dims):
        raise InputError.of(path, "a file without results of a campaign", "one that `gfmd run` has left")
    return results


def fit_tfc(
    dataset: xr.Dataset | str | Path,
    variable: str = "kappa",
    exponents: Literal["shared", "free"] | None = None,
    fixed: Mapping[str, float | Sequence[float]] | None = None,
    omit_nyquist: bool = True,
    step: int | None = None,
) -> xr.Dataset:
    """Extrapolate kappa of a campaign to the thermodynamic, fractal and continuum limit.

    Parameters
    ----------
    dataset
        Results of the campaign, or their path.
    variable
        What is extrapolated.
    exponents
        `shared` by all groups of cases, or `free` in each; left out: as the campaign has it.
    fixed
        Exponents that are known, or the ranges they lie in, like `{"eps_c": 1.0, "eps_f": (0.5, 1.0)}`; left out: as
        the campaign has them.
    omit_nyquist
        Leave out levels whose shortest wave has two nodes.
    step
        The step of a loading path that is fitted; left out: every step.

    Returns
    -------
    xarray.Dataset
        The limit `..._tfc` with its error, corrections and error budget over groups, as `gfmd_numba.analysis.fit_tfc`
        has it.

    Raises
    ------
    InputError
        The options make no sense, or the variable has no limit.

    Examples
    --------
    >>> fit = gfmd_numba.fit_tfc("small")
    >>> bool(fit["kappa_tfc_low"] < fit["kappa_tfc"]), fit["error_budget"].dims
    (True, ('group', 'source'))
    """
    import json

    from gfmd_numba.analysis import fit_tfc as fit
    from gfmd_numba.analysis.extrapolation import check_effect
    from gfmd_numba.contact.observables import why_no_limit
    from gfmd_numba.text.input_error import InputError

    if isinstance(variable, str) and (why := why_no_limit(variable)):
        raise InputError(f"variable: you gave {variable!r}; gfmd allows what has a limit: {why}")
    results = _dataset("dataset", dataset, "open_campaign")
    own = json.loads(results.attrs.get("fit", "{}"))
    own = json.loads(results.attrs.get("fits_of_targets", "{}")).get(variable, own)
    exponents = own.get("exponents", "shared") if exponents is None else exponents
    if fixed is not None:
        check_effect(results, fixed, variable, exponents, step)
    return fit(results, variable, exponents, own.get("fixed") if fixed is None else fixed, omit_nyquist, step)


def contact_statistics(dataset: xr.Dataset | str | Path) -> xr.Dataset:
    """Find the distributions of pressure, gap and sizes of contacts of a solved contact.

    Parameters
    ----------
    dataset
        What `solve` returns, or the path of its netCDF file.

    Returns
    -------
    xarray.Dataset
        Densities of pressure and gap, segments of a profile or clusters of a map, and Persson's theory.

    Raises
    ------
    InputError
        This is no solved contact.

    Examples
    --------
    >>> int(gfmd_numba.contact_statistics(contact)["clusters"].sum()) == contact["n_segments"].item()
    True
    """
    from gfmd_numba.analysis import contact_statistics as statistics

    return statistics(_dataset("dataset", dataset, "solve"))


def gap_percolation(dataset: xr.Dataset | str | Path) -> xr.Dataset:
    """Look for channels through the gap of a map, around its period.

    Parameters
    ----------
    dataset
        What `solve` returns of a map, or the path of its netCDF file.

    Returns
    -------
    xarray.Dataset
        Over `direction` x and y: `gap_connects` and `contact_connects` (0 or 1), and `critical_gap`, the largest
        particle that passes, in the unit of the gap. Further `largest_gap_fraction`, `largest_contact_fraction` (shares
        of all nodes) and `n_gaps`.

    Raises
    ------
    InputError
        This is no solved map.

    Examples
    --------
    >>> gfmd_numba.gap_percolation(contact)["gap_connects"].values
    array([1, 1], dtype=int8)
    """
    from gfmd_numba.analysis.channels import gap_percolation as percolation

    return percolation(_dataset("dataset", dataset, "solve"))


def leakage(
    dataset: xr.Dataset | str | Path,
    viscosity: float | str | None = None,
    pressure: float | str | None = None,
    seal: Sequence[float | str] | None = None,
) -> xr.Dataset:
    """Find the leakage through the gap of a contact, by the Reynolds equation.

    Parameters
    ----------
    dataset
        What `solve` returns, or the path of its netCDF file. The grooves of a profile go on without end along y.
    viscosity, pressure
        Viscosity of a fluid (Pa s), and how much its pressure falls (Pa), or text with units, like `1 mPa s`.
    seal
        Length of a seal along the flow, and its width (m, or text with units); left out: those of the map.

    Returns
    -------
    xarray.Dataset
        Over `direction` x and y: `hydraulic_gap`, the gap of parallel walls that leak as much, in the unit of the gap;
        `flow_factor`, its cube over that of the mean gap; `flow_residual`, the relative difference of two ways to
        count the flow, beyond 1e-3 of which the others are nan; `local_flow` (direction, y, x) over its mean. With a
        viscosity also `flow` (m^3/s), and what was given of the fluid and the seal.

    Raises
    ------
    InputError
        This is no solved contact, or the arguments make no sense.

    Examples
    --------
    >>> gfmd_numba.leakage(contact)["flow_factor"].values.round(2)
    array([0.53, 0.62])
    """
    from gfmd_numba.simulate.transport import leakage as leakage_of

    return _warned(leakage_of(_dataset("dataset", dataset, "solve"), viscosity, pressure, seal))


def contact_conductance(
    contact: xr.Dataset | str | Path, conductivity: str | Sequence[str] | None = None
) -> xr.Dataset:
    """Find the electrical or thermal conductance of a contact, over the conductivity of the bodies.

    Parameters
    ----------
    contact
        What `solve` returns, or the path of its netCDF file.
    conductivity
        That of both bodies, or of each, as text with units, like `60 MS/m` or `16 W/m/K`.

    Returns
    -------
    xarray.Dataset
        `conductance` in 1/m (1/L_x without a length): times 2 s_1 s_2 / (s_1 + s_2) of two half-spaces of
        conductivities s_1 and s_2, it is the current per nominal area over the difference of potential or temperature.
        `current_density` over (y, x) is the current through each node over the mean. With a conductivity also
        `resistance_times_area` (ohm m^2 or K m^2/W), and of maps the `resistance` of the nominal area.

    Raises
    ------
    InputError
        This is no solved contact.

    Examples
    --------
    >>> round(gfmd_numba.contact_conductance(contact)["conductance"].item(), 2)
    2.0
    """
    from gfmd_numba.simulate.transport import contact_conductance as conductance_of

    return _warned(conductance_of(_dataset("contact", contact, "solve"), conductivity))


def _goal(
    campaign: str | Path | Mapping[str, Any] | Campaign,
    output: str | Path | None,
    until: Mapping[str, float] | None,
    budget: float | str | None,
) -> Goal | None:
    """Goal that is given, or that of the campaign, if any; raises InputError for arguments of another kind.

    Warns the caller of the function that asks for it if the results of another version are replaced.
    """
    from gfmd_numba.campaign.file import load_campaign, replaced, target_of_run
    from gfmd_numba.campaign.goal import goal_of

    if not (output is None or isinstance(output, str | os.PathLike)):
        raise InputError.of("output", f"{output!r:.60}", "the path of a directory")
    targets = until if until is not None else target_of_run(campaign)
    if targets is None and budget is not None:
        raise InputError("budget: you gave it without until, whose processor time it bounds; give both, or none")
    goal = None if targets is None else goal_of(targets, budget)
    of_goal = None if goal is None else goal.targets
    loaded, _ = load_campaign(campaign, of_goal)
    if told := replaced(Path(output or loaded.name), loaded, of_goal):
        warnings.warn(told, stacklevel=3)
    return goal


def _warned(dataset: xr.Dataset) -> xr.Dataset:
    """Dataset; how runs failed and the sentences on validity become warnings of the caller of what returns it."""
    for sentence in (*_failures(dataset), *filter(None, dataset.attrs["validity"].split("\n"))):
        warnings.warn(sentence, stacklevel=3)
    return dataset


def _failures(dataset: xr.Dataset) -> Iterator[str]:
    """How runs failed, and at which steps or loads of a path, or how many of a campaign."""
    if "status" not in dataset:
        return
    status = dataset.variables["status"]
    for i, ending in enumerate(status.attrs["flag_sentences"].split("\n")):
        ended = status.values == i
        if i == 0 or not ended.any() or ending.startswith("not_asked"):
            continue
        match status.dims:
            case ():
                where = ""
            case (along,):
                where = f" at {along} " + ", ".join(f"{place:.4g}" for place in dataset[along].values[ended])
            case _:
                where = f" in {int(ended.sum())} of {ended.size} simulations"
        name, _, sentence = ending.partition(": ")
        yield f"{name}{where}: {sentence}"


def _dataset(name: str, given: xr.Dataset | str | Path, maker: str) -> xr.Dataset:
    """Dataset of a path, or as it is given; raises InputError, by the argument's name, for anything else."""
    import xarray as xr

    if isinstance(given, str | os.PathLike):
        from gfmd_numba.campaign.results import read_results

        return read_results(Path(given))
    if not isinstance(given, xr.Dataset):
        allowed = f"an xarray.Dataset, as gfmd_numba.{maker} returns, or the path of a netCDF file"
        raise InputError.of(name, brief(given), allowed)
    return given.compute()  # what a file or dask still holds
