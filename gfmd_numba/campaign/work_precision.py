"""Error against seconds, one setting at a time around a campaign's reference case (work-precision studies)."""

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.campaign.axes import DISCRETISATIONS
from gfmd_numba.campaign.cases import Case
from gfmd_numba.campaign.ensemble import measured
from gfmd_numba.campaign.plan import Plan
from gfmd_numba.contact.dataset import cf_attributes
from gfmd_numba.contact.problem import Problem, random_surface
from gfmd_numba.contact.refusal import check_where
from gfmd_numba.contact.solution import solve
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.scene import SINGLE_RESIDUAL, Discretisation
from gfmd_numba.solvers.table import able

_RESIDUALS = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
_TIGHT = 1e-10
_PATIENCE = 50_000  # iterations
_TIME_STEPS = (0.25, 0.5, 0.95)
_DAMPINGS = (0.0625, 0.25, 0.5, 1.0, 4.0)
_OF_EACH_PRECISION = ("active_set_newton", "verlet")
_FINER = 4  # times as fine as the reference, the level that others are compared with
_SLABS = (1.0, 0.5, 0.2, 0.1)
_MOST_NODES = {1: 2**17, 2: 2**20}  # of a level, by dimension
_SURFACES = (4, 16)  # of a study: the most unless they have more nodes than these, which take seconds,
_NODES = 2**19
_SAMPLED = 16  # times as many of the study of their number, unless they have more nodes than these
_SAMPLED_NODES = 2**23


@dataclass(frozen=True)
class Point:
    """One setting: its relative error in kappa and the seconds a surface takes.

    `study` is what is varied, `curve` what else differs, `setting` its value; `failed` surfaces did not end ok.
    """

    study: str
    curve: str
    setting: float
    error: float
    seconds: float
    transforms: float
    failed: int


_NAMES = {
    "study": ("what is varied", "1"),
    "curve": ("what else differs within the study", "1"),
    "setting": ("value of what is varied", "1"),
    "error": ("relative error of kappa", "1"),
    "seconds": ("processor time of one surface", "s"),
    "transforms": ("Fourier transforms of one surface", "1"),
    "failed": ("surfaces that did not end ok", "1"),
}


def studies(planned: Plan, realisations: int | None = None) -> Iterator[Point]:
    """Work-precision studies of the first reference case of a campaign, one thread, in this process.

    Without `realisations` a study has 16, fewer on a large grid but 4 at least. Raises InputError for a campaign of
    measured surfaces, or along a path.
    """
    check_where(planned.document, planned.campaign.scene, "accuracy", planned.campaign.numerics, planned.campaign.path)
    case = next(case for case in planned.cases if case.limit == "reference")
    exact = replace(case.problem.numerics, precision="double")
    case = replace(case, problem=replace(case.problem, numerics=exact))
    nodes = case.problem.surface.nodes
    if realisations is None:
        realisations = min(_SURFACES[1], max(_SURFACES[0], _NODES // nodes))
    yield from _solvers(case.problem, realisations)
    seed = planned.campaign.seed
    if case.discretisation is not None and seed is not None:
        for axis in DISCRETISATIONS:
            yield from _discretisation(case, case.discretisation, axis, seed, realisations)
    yield from _sampling(case.problem, min(_SAMPLED * realisations, max(realisations, _SAMPLED_NODES // nodes)))
    yield from _effects(case.problem, realisations)


def dataset(points: Iterable[Point]) -> xr.Dataset:
    """Studies as a dataset over (point), for netCDF."""
    rows = list(points)
    found = xr.Dataset()
    for name, (long_name, units) in _NAMES.items():
        found[name] = ("point", [getattr(point, name) for point in rows], cf_attributes(long_name, units))
    return found


def _solvers(problem: Problem, realisations: int) -> Iterator[Point]:
    """Solver and residual, precision, time step and damping of the reference solver, against a tight residual."""
    exact = _run(problem, realisations, residual=_TIGHT)["kappa"]
    solvers = able((f"dimension {len(problem.surface.shape)}", *problem.interface.abilities))
    for solver in solvers:
        for residual in _RESIDUALS:
            values = _run(problem, realisations, solver=solver, residual=residual, max_iterations=_PATIENCE)
            yield _point("solver residual", solver.replace("_", " "), residual, values, exact)
    if "active_set_newton" in solvers and problem.interface.hardness is None:
        yield from _precision(problem, exact, [name for name in _OF_EACH_PRECISION if name in solvers])
    if "verlet" not in solvers:
        return
    for damping in _DAMPINGS:
        for step in _TIME_STEPS:
            settings = {"solver": "verlet", "time_step": step, "damping": damping, "max_iterations": _PATIENCE}
            values = _run(problem, realisations, **settings)
            yield _point("damping of Verlet", f"time step {step:g} of the limit", damping, values, exact)


def _precision(problem: Problem, exact: Reals, solvers: Iterable[str]) -> Iterator[Point]:
    """Single precision beside double, as far down as its certificate goes."""
    for solver in solvers:
        for precision in ("double", "single"):
            for residual in (residual for residual in _RESIDUALS if residual >= SINGLE_RESIDUAL):
                settings = {"solver": solver, "residual": residual, "precision": precision, "max_iterations": _PATIENCE}
                values = _run(problem, len(exact), **settings)
                yield _point("precision", f"{solver.replace('_', ' ')}, {precision}", residual, values, exact)


def _discretisation(case: Case, at: Discretisation, axis: str, seed: int, realisations: int) -> Iterator[Point]:
    """Levels from 8 times coarser to 4 times finer than the reference, against the finest."""
    reference = getattr(at, axis)
    dimension = len(case.problem.surface.shape)
    levels = []
    for factor in (8.0, 4.0, 2.0, 1.0, 0.5, 1.0 / _FINER):
        level = at.model_copy(update={axis: reference * factor})
        small = factor >= 1.0 or level.nx**dimension <= _MOST_NODES[dimension]
        if reference * factor <= 1.0 and level.misfit is None and small:
            surface = random_surface(case.scene, level, seed)[0]
            levels.append((reference * factor, _run(replace(case.problem, surface=surface), realisations)))
    estimators, best = {"corrected on average": "kappa"}, "kappa"
    if axis == "eps_c":
        estimators |= {"counted": "kappa_counted"}
        if dimension == 1:  # the edges of a map's contact are not located
            estimators, best = estimators | {"each edge located": "kappa_edges"}, "kappa_edges"
    finest = levels[-1][1][best]
    for label, variable in estimators.items():
        for eps, values in levels if variable != best else levels[:-1]:
            yield _point(axis, label, eps, values, finest, variable=variable, of_means=True)


def _sampling(problem: Problem, most: int) -> Iterator[Point]:
    """Number of surfaces against the standard error of their mean."""
    values = _run(problem, most)
    kappa, seconds = values["kappa"], float(values["seconds"])
    n = 4
    while n <= most:
        error = float(np.nanstd(kappa, ddof=1) / np.sqrt(n) / np.nanmean(kappa))
        yield Point(
            study="surfaces",
            curve="reference discretisation",
            setting=n,
            error=error,
            seconds=n * seconds,
            transforms=np.nan,
            failed=0,
        )
        n *= 4


def _effects(problem: Problem, realisations: int) -> Iterator[Point]:
    """What a slab changes and costs over the half-space."""
    if problem.interface.couples or problem.mean_pressure is None or problem.body.stack is not None:
        return
    nu = 0.33 if problem.body.poissons_ratio is None else problem.body.poissons_ratio
    half_space = _run(replace(problem, body=ElasticBody(None, None)), realisations)
    yield _point("effects", "half-space for a slab", np.inf, half_space, half_space["kappa"], of_means=True)
    for aspect_ratio in _SLABS:
        slab = _run(replace(problem, body=ElasticBody(nu, aspect_ratio)), realisations)
        yield _point("effects", "half-space for a slab", aspect_ratio, half_space, slab["kappa"], of_means=True)


def _run(problem: Problem, realisations: int, **settings: Any) -> dict[str, Reals]:
    if settings.get("solver", problem.numerics.solver) != problem.numerics.solver:
        settings = {"time_step": None, "damping": None} | settings  # the other solver's own
    changed = replace(problem, numerics=replace(problem.numerics, **settings))
    solve(changed, range(1))  # kernels compiled, plans made
    begun = time.thread_time()
    values = measured(changed, realisations)
    return values | {"seconds": np.asarray((time.thread_time() - begun) / realisations)}


def _point(
    study: str,
    curve: str,
    setting: float,
    values: dict[str, Reals],
    exact: Reals,
    *,
    variable: str = "kappa",
    of_means: bool = False,
) -> Point:
    """Error of the surfaces that ended ok, rms or, where it is a bias that counts, of their mean."""
    difference = values[variable] / np.nanmean(exact) - exact / np.nanmean(exact)
    good = np.isfinite(difference)
    error = np.nan
    if good.any():
        error = float(abs(difference[good].mean()) if of_means else np.sqrt((difference[good] ** 2).mean()))
    return Point(
        study=study,
        curve=curve,
        setting=float(setting),
        error=error,
        seconds=float(values["seconds"]),
        transforms=float(values["n_transforms"].mean()),
        failed=int((values["status"] != 0).sum()),
    )
