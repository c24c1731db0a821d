"""Error against seconds, one setting at a time around a campaign's reference case (work-precision studies)."""

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from itertools import pairwise, product
from math import isnan, nan
from typing import Any

import numpy as np
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.campaign.axes import DISCRETISATIONS, Grid
from gfmd_numba.campaign.cases import Case, blocks
from gfmd_numba.campaign.limits import Limits
from gfmd_numba.campaign.plan import Plan
from gfmd_numba.contact import load_path
from gfmd_numba.contact.contact_dataset import cf_attributes
from gfmd_numba.contact.observables import recorded_along
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.refusal import check_where, refusals
from gfmd_numba.contact.state import LoadStep
from gfmd_numba.roughness.surfaces import SummedSurface
from gfmd_numba.scene import Discretisation
from gfmd_numba.solvers.table import able

_RESIDUALS = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
_TIGHT = 1e-10
_PATIENCE = 50_000  # iterations
_TIME_STEPS = (0.25, 0.5, 0.95)
_DAMPINGS = (0.0625, 0.25, 0.5, 1.0, 4.0)
_FINER = 4  # times as fine as the reference, the level that others are compared with
_DIVISIONS, _FINEST_DIVISION = (1, 2, 4), 8  # of each step of a path
_ORDERS, _HIGHEST_ORDER = (0, 1, 2), 3  # in the slope of rough bodies
_MOST_NODES = {1: 2**17, 2: 2**20}  # of a level, by dimension
_SURFACES = (4, 16)  # of a study: the most unless they have more nodes than these, which take seconds,
_NODES = 2**19
_SAMPLED = 16  # times as many of the study of their number, unless they have more nodes than these
_SAMPLED_NODES = 2**23

Measures = dict[str, Reals]  # [realisation] or, along a path, [realisation, step]
KAPPA, AREA = "kappa", "contact_area_fraction"
OF_PATHS = ("hysteresis", "pull_off_pressure")
_OF_SOME = ("hysteresis_error", "pull_off_pressure_error", "next_order")  # which not every contact has


def _column(long_name: str, **default: Any) -> Any:
    """Return a field of a `Point`, and what it is called in the table."""
    return field(metadata={"long_name": long_name}, **default)


@dataclass(frozen=True)
class Point:
    """One setting, its error and what a surface costs: a row of a table.

    Where no step has a mean pressure above 0, and so a kappa, the `variable` is the contact area. Errors that the
    contact does not have are nan.
    """

    study: str = _column("what is varied")
    curve: str = _column("what else differs within the study")
    setting: float = _column("value of what is varied")
    error: float = _column("relative error of the variable, along a path where it is largest")
    seconds: float = _column("processor time of one surface")
    transforms: float = _column("Fourier transforms of one surface")
    failed: int = _column("surfaces that did not end ok")
    variable: str = _column("what the error is about", default=KAPPA)
    hysteresis_error: float = _column("relative error of the hysteresis", default=nan)
    pull_off_pressure_error: float = _column("relative error of the pull-off pressure", default=nan)
    next_order: float = _column("what the next order in the slope would add to a displacement, over L_x", default=nan)


def dataset(points: Iterable[Point]) -> xr.Dataset:
    """Return studies as a dataset over (point), for netCDF, without columns that no point has."""
    rows = list(points)
    found = xr.Dataset()
    for column in fields(Point):
        values, unit = [getattr(point, column.name) for point in rows], "s" if column.name == "seconds" else "1"
        if column.name not in _OF_SOME or not all(map(isnan, values)):
            found[column.name] = ("point", values, cf_attributes(column.metadata["long_name"], unit))
    return found


def relative_error(values: Reals, exact: Reals, *, of_means: bool = False) -> float:
    """Return the rms error of the surfaces that ended ok, or of their mean if it is a bias that counts; nan if unknown.

    Of values [realisation, step] it is the largest over the steps at which most surfaces are known.
    """
    return _largest(_relative_error(found, known, of_means) for found, known in _best_known(values, exact))


def _relative_error(values: Reals, exact: Reals, of_means: bool) -> float:
    mean = abs(exact[np.isfinite(exact)].mean())
    if mean == 0.0:
        return nan
    difference = values / mean - exact / mean
    good = np.isfinite(difference)
    if not good.any():
        return nan
    return float(abs(difference[good].mean()) if of_means else np.sqrt((difference[good] ** 2).mean()))


def sampling_error(values: Reals, number: int) -> float:
    """Return the relative standard error of the mean of a number of surfaces, the largest of a path; nan if unknown."""
    surfaces = (of_step[np.isfinite(of_step)] for (of_step,) in _best_known(values))
    known = [each for each in surfaces if len(each) > 1 and each.mean() != 0.0]
    return _largest(float(np.std(each, ddof=1) / np.sqrt(number) / abs(each.mean())) for each in known)


def _best_known(*values: Reals) -> list[tuple[Reals, ...]]:
    """Values `[realisation]` at each step at which most surfaces are known, by the last of them."""
    steps = [tuple(each) for each in zip(*(np.atleast_2d(each.T) for each in values), strict=True)]
    known = [np.isfinite(of_step[-1]).sum() for of_step in steps]
    return [of_step for of_step, count in zip(steps, known, strict=True) if count == max(known) > 0]


def _largest(errors: Iterable[float]) -> float:
    return max((error for error in errors if not isnan(error)), default=nan)


def divided(problem: Problem, number: int) -> tuple[LoadStep, ...]:
    """Return the path of a problem with each step divided into equal ones."""
    return tuple(
        LoadStep(
            before.load + share * (after.load - before.load),
            tuple(old + share * (new - old) for old, new in zip(before.sliding, after.sliding, strict=True)),
            after.duration / number,
        )
        for before, after in pairwise((problem.step, *problem.path))
        for share in (np.arange(1, number + 1) / number).tolist()
    )


def studies(planned: Plan, realisations: int | None = None) -> Iterator[Point]:
    """Yield the work-precision studies of the first reference case of a campaign, with one thread, in this process.

    Without `realisations` a study has 16, fewer on a large grid or along a path, but 4 at least. Raises InputError for
    a campaign of measured surfaces, or with tractions from a file.
    """
    study = study_of(planned, realisations)
    yield from study.solvers()
    for axis in study.axes:
        yield from study.discretisation(axis)
    yield from study.sampling()
    yield from study.load_steps()
    yield from study.orders()


def study_of(planned: Plan, realisations: int | None = None) -> "Study":
    """Return the study of the first reference case of a campaign; raises as `studies` does."""
    check_where(planned.document, planned.campaign.scene, "accuracy", planned.campaign.numerics)
    case = next(case for case in planned.cases if case.limit == "reference")
    if realisations is None:
        realisations = min(_SURFACES[1], max(_SURFACES[0], _NODES // _nodes(case.problem)))
    return Study(planned, case, realisations)


def _nodes(problem: Problem) -> int:
    return problem.surface.nodes * problem.n_loads


@dataclass(frozen=True)
class Study:
    """The reference case of a campaign, and how many of its surfaces a study has."""

    planned: Plan
    case: Case
    realisations: int

    @property
    def problem(self) -> Problem:
        """Problem of the case."""
        return self.case.problem

    @property
    def axes(self) -> tuple[str, ...]:
        """Discretisations that are varied: another eps_t of a window is another contact."""
        return DISCRETISATIONS[:2] if any(self.problem.ends) else DISCRETISATIONS

    @cached_property
    def of_path(self) -> tuple[str, ...]:
        """What the path of the case has as a whole."""
        rough = self.problem.rough
        rows = recorded_along(self.case.scene, 0 if rough is None else rough.order) if self.problem.path else {}
        return tuple(name for name in OF_PATHS if name in rows)

    def solvers(self) -> Iterator[Point]:
        """Solver and residual, time step and damping of the reference solver, against a tight residual."""
        exact = self.run(self.problem, residual=_TIGHT)
        needs = (f"dimension {len(self.problem.surface.shape)}", *self.problem.interface.abilities)
        solvers = [name for name in able(needs) if self._allowed(solver=name)]
        trials: list[tuple[str, str, float, dict[str, Any]]] = [
            ("solver residual", solver.replace("_", " "), residual, {"solver": solver, "residual": residual})
            for solver, residual in product(solvers, _RESIDUALS)
        ]
        for damping, step in product(_DAMPINGS, _TIME_STEPS) if "verlet" in solvers else ():
            settings: dict[str, Any] = {"solver": "verlet", "time_step": step, "damping": damping}
            trials.append(("damping of Verlet", f"time step {step:g} of the limit", damping, settings))
        for study, curve, setting, settings in trials:
            values = self.run(self.problem, max_iterations=_PATIENCE, **settings)
            yield self.point(study, curve, setting, values, exact)

    def _allowed(self, **changed: Any) -> bool:
        """Whether the campaign could have these numerics."""
        own = {"time_step": None, "damping": None}
        numerics = self.planned.campaign.numerics.model_copy(update=own | changed)
        return not any(refusals(self.case.scene, numerics, self.planned.campaign.path, {}))

    def discretisation(self, axis: str) -> Iterator[Point]:
        """Levels from 8 times coarser to 4 times finer than the reference, against the finest."""
        at = self.case.discretisation
        if at is None or self.planned.campaign.seed is None:
            return
        reference = getattr(at, axis)
        dimension = len(self.problem.surface.shape)
        levels = []
        for factor in (8.0, 4.0, 2.0, 1.0, 0.5, 1.0 / _FINER):
            level = at.model_copy(update={axis: reference * factor})
            small = factor >= 1.0 or level.nx**dimension <= _MOST_NODES[dimension]
            if reference * factor <= 1.0 and level.misfit is None and small:
                levels.append((reference * factor, self.run(self._at(level))))
        finest = levels[-1][1]
        best = _variable(finest)
        estimators = {"corrected on average": best}
        if axis == "eps_c":
            estimators |= {"counted": f"{best}_counted"}
            if np.isfinite(finest["kappa_edges"]).any():  # those of a map's contact are not located
                estimators, best = estimators | {"each edge located": "kappa_edges"}, "kappa_edges"
        for label, name in estimators.items():
            for eps, values in levels if name != best else levels[:-1]:
                yield self.point(axis, label, eps, values, finest, estimator=(name, best), of_means=True)

    def _at(self, level: Discretisation) -> Problem:
        """The problem of the case at another discretisation, as a campaign has it there."""
        at = self.planned.changed(scene=self.case.scene, reference=level, grid=Grid(), limits=Limits())
        return at.cases[0].problem

    def sampling(self) -> Iterator[Point]:
        """Number of surfaces against the standard error of their mean."""
        most = min(_SAMPLED * self.realisations, max(self.realisations, _SAMPLED_NODES // _nodes(self.problem)))
        values = self.run(self.problem, most)
        found, n = self.point("surfaces", "reference discretisation", 4, values, values), 4
        while n <= most:
            errors: dict[str, Any] = {f"{name}_error": sampling_error(values[name], n) for name in self.of_path}
            error, seconds = sampling_error(values[found.variable], n), n * found.seconds
            yield replace(found, setting=n, error=error, seconds=seconds, transforms=nan, failed=0, **errors)
            n *= 4

    def load_steps(self) -> Iterator[Point]:
        """Each step of a path that a contact remembers, divided into several, against the finest division."""
        if not self.problem.path or not recorded_along(self.case.scene):
            return
        exact = self._divided(_FINEST_DIVISION)
        for number in _DIVISIONS:
            yield self.point("load steps", "each step divided", number, self._divided(number), exact, of_means=True)

    def _divided(self, number: int) -> Measures:
        """Return measures at the steps of the path, each of which is divided into equal ones."""
        values = self.run(replace(self.problem, path=divided(self.problem, number)))
        return {name: each[:, ::number] if each.ndim == 2 else each for name, each in values.items()}

    def orders(self) -> Iterator[Point]:
        """Orders in the slope of rough bodies, where more than order 0 is known, against the highest."""
        rough = self.problem.rough
        if rough is None or not self._allowed(topography_order=_HIGHEST_ORDER):
            return
        if any(body.elastic.stack is not None for body in rough.bodies):
            return  # interfaces follow the surface at order 0 and are flat above, which is no error of either
        exact = self.run(replace(self.problem, rough=replace(rough, order=_HIGHEST_ORDER)))
        for order in _ORDERS:
            values = self.run(replace(self.problem, rough=replace(rough, order=order)))
            yield self.point("topography order", "each order", order, values, exact, of_means=True)

    def run(self, problem: Problem, realisations: int | None = None, **settings: Any) -> Measures:
        """Return the measures of surfaces, and the seconds that one takes."""
        number = self.realisations if realisations is None else realisations
        if settings.get("solver", problem.numerics.solver) != problem.numerics.solver:
            settings = {"time_step": None, "damping": None} | settings  # the other solver's own
        changed = replace(problem, numerics=replace(problem.numerics, **settings))
        load_path.measured(changed, range(1))  # kernels compiled, plans made
        begun = time.thread_time()
        # in blocks as in a run, so that their memory is bounded
        parts = [load_path.measured(changed, range(block.first, block.stop)) for block in blocks(changed, number)]
        seconds = np.asarray((time.thread_time() - begun) / number)
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]} | {"seconds": seconds}

    def point(
        self,
        study: str,
        curve: str,
        setting: float,
        values: Measures,
        exact: Measures,
        *,
        estimator: tuple[str, str] | None = None,
        of_means: bool = False,
    ) -> Point:
        """Return the error against the exact values, or of an estimator against the best one, and the cost."""
        variable = _variable(exact)
        name, best = estimator or (variable, variable)
        known = self.of_path if values is not exact else ()
        return Point(
            study=study,
            curve=curve,
            setting=float(setting),
            error=relative_error(values[name], exact[best], of_means=of_means),
            seconds=float(values["seconds"]),
            transforms=float(values["n_transforms"].mean()),
            failed=int((values["status"] != 0).sum()),
            variable=variable,
            next_order=self._next_order(values),
            **{f"{name}_error": relative_error(values[name], exact[name], of_means=of_means) for name in known},
        )

    def _next_order(self, values: Measures) -> float:
        """Return the mean of what the next order would add to a displacement (L_x), the largest of a path."""
        surface = self.problem.surface
        if self.problem.rough is None or not isinstance(surface, SummedSurface):
            return nan
        error = values["next_order"].reshape(len(values["status"]), -1)
        means = [column[np.isfinite(column)].mean() for column in error.T if np.isfinite(column).any()]
        return float(surface.rms_gradient * max(means)) if means else nan


def _variable(values: Measures) -> str:
    """What errors are about: kappa, or the contact area where no mean pressure is above 0."""
    return KAPPA if np.isfinite(values[KAPPA]).any() else AREA
