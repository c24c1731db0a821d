"""What contacts cost: in operations, which are the same on every machine, and in seconds on this one.

Decisions follow from operations alone. Seconds are predicted: a pilot solves a few contacts, and a regression on what
decides their run time tells the others.
"""

import math
import platform
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from itertools import islice
from pathlib import Path

import numpy as np
import numpy.typing as npt
import psutil

from gfmd_numba.arrays import Reals
from gfmd_numba.campaign.cases import block_bytes
from gfmd_numba.campaign.execution import watched
from gfmd_numba.contact.load_path import measured
from gfmd_numba.contact.problem import Problem
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.surfaces import SmoothSurface, SummedSurface, Surface, without_shortest
from gfmd_numba.storage import cache, json_file
from gfmd_numba.text.input_error import InputError

UNITS = "operations: n log2 n of the grid, and 2^15 for the call, for every transform of a realisation"
_CALL = 2.0**15  # profiles of 512 to 131072 points take the same time per unit within a quarter
_SAMPLES, _MOST_REALISATIONS = 2**17, 16  # nodes solved at a time in the pilot, as far as they are contacts
_LEAST_PILOTS, _MOST_PILOTS = 4, 32
_LEAST_NODES = 2**12  # of a smaller problem in place of one that takes too long: below, calls take the time
_LOOKED_AT = 50  # problems, those that tell most, for one the pilot can afford
_MACHINE = 0.25  # of the logarithm of all run times: a machine is not equally fast all day
_DRAWS = 200
_SCATTERED = 2**12  # problems, the costliest, whose scatter is drawn for each; that of more averages out
_SCATTER = 0.15  # of the logarithm of a run time: what repeating it on a quiet machine gives
_CACHED = 2**17  # nodes whose arrays stay near the processor
_STATIC = ("active_set_newton", "conjugate_gradients")  # their iterations hardly rise with the number of nodes
# logarithm of seconds = coefficients . features: expectation and standard deviation before anything is measured
_PRIOR = (
    ("one", -5.5, 3.0),  # 4 ms at nx = 8192
    ("n log n", 1.05, 0.1),
    ("n log n of time steps", 0.4, 0.3),
    ("profile beyond the cache", 0.2, 0.1),
    ("map beyond the cache", 0.05, 0.08),
    ("nodes of the shortest wave", 0.0, 0.3),
    ("waves", 0.0, 0.15),
    ("hurst", 0.0, 1.0),
    ("reduced pressure", 0.15, 0.3),
    ("stiffening", 0.0, 0.3),
    ("anisotropy", 0.0, 0.3),
    ("loads of a path", 1.0, 0.2),
)


def price_of_transform(nodes: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return the price of one transform of a realisation on grids of some nodes."""
    n = np.asarray(nodes, dtype=np.float64)
    return n * np.log2(n) + _CALL


@dataclass(frozen=True)
class Cost:
    """Predicted processor time: seconds a realisation by identity of the problem, and draws of the total in s.

    `pilot` counts the problems that were measured, and `smaller` those measured on a smaller grid instead.
    """

    seconds: dict[str, float]
    total: Reals
    pilot: int
    smaller: int

    def quantile(self, probability: float) -> float:
        """Total processor time in s that is not exceeded with a probability."""
        return float(np.quantile(self.total, probability))


@dataclass(frozen=True)
class _Regression:
    """Mean and covariance of the coefficients, and the scatter of the logarithm of a run time around them."""

    coefficients: Reals
    covariance: Reals
    scatter: float


def predict(
    problems: list[Problem],
    realisations: list[int],
    budget: float,
    warm: Callable[[list[Problem]], None],
    timeout: float | None = None,
) -> Cost:
    """Predict the cost of the realisations of each problem, from a pilot of at most `budget` seconds.

    The pilot takes no more than a tenth of the work itself unless that is too little to learn anything. If a problem
    takes too long for the pilot, the same physics is measured on a smaller grid. `warm` is called before anything is
    timed. Earlier pilots on this machine are remembered and count towards the budget. A problem that fails, or takes
    longer than `timeout` seconds, is predicted like those that were not measured.
    """
    kinds = sorted({_kind(problem) for problem in problems})  # each has an iteration, hence a run time, of its own
    x, weight = _features(problems, kinds), np.array(realisations, dtype=float)
    known = _Known(remembered(), min(_MOST_REALISATIONS, max(realisations, default=1)))
    for problem, row in zip(problems, x, strict=True):
        known.recall(problem, row)
    warmed = False
    while True:
        found = _regression(*known.data(x.shape[1]))
        likely = weight * np.exp(x @ found.coefficients)
        left = (budget if len(known.rows) < _LEAST_PILOTS else min(budget, 0.1 * float(likely.sum()))) - known.spent
        chosen = None
        if left > 0.0 and len(known.rows) < _MOST_PILOTS:
            telling = (problems[i] for i in _most_telling(x, likely, found, _LOOKED_AT + len(known.tried)))
            untried = (problem for problem in telling if problem.identity not in known.tried)
            chosen = _affordable(list(islice(untried, _LOOKED_AT)), kinds, found, known, left)
        if chosen is None:
            break
        row = _features([chosen], kinds)[0]
        if not known.recall(chosen, row):
            if not warmed:
                warm(problems)
                warmed = True
            known.learn(chosen, row, timeout)
    if warmed:
        remember(known.memory)
    return _cost(problems, x, weight, found, known)


@dataclass
class _Known:
    """What is measured: `memory` of this and earlier pilots, seconds by identity, and the part of it in use."""

    memory: dict[str, float]
    most: int  # realisations solved at a time
    tried: set[str] = field(default_factory=set)  # identities
    rows: list[Reals] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    spent: float = 0.0

    def recall(self, problem: Problem, row: Reals) -> bool:
        """Use what an earlier pilot has measured, if it has."""
        seconds = self.memory.get(problem.identity)
        if seconds is None:
            return False
        self._use(problem, row, seconds)
        self.spent += seconds * self.realisations(problem)
        return True

    def learn(self, problem: Problem, row: Reals, timeout: float | None) -> None:
        """Measure a problem; one that fails is not tried again."""
        begun = time.perf_counter()
        seconds = _measured(problem, self.realisations(problem), timeout)
        self.spent += time.perf_counter() - begun
        self.tried.add(problem.identity)
        if seconds is not None:
            self.memory[problem.identity] = seconds
            self._use(problem, row, seconds)

    def realisations(self, problem: Problem) -> int:
        """Realisations of a problem that a pilot solves at a time, as a block of the run does."""
        return max(1, min(self.most, _SAMPLES // (problem.surface.nodes * problem.n_loads)))

    def data(self, columns: int) -> tuple[Reals, Reals]:
        """Features [problem, feature] and seconds [problem] of what is in use."""
        return np.array(self.rows).reshape(-1, columns), np.array(self.seconds)

    def _use(self, problem: Problem, row: Reals, seconds: float) -> None:
        self.tried.add(problem.identity)
        self.rows.append(row)
        self.seconds.append(seconds)


def _affordable(
    problems: list[Problem], kinds: list[str], found: _Regression, known: _Known, left: float
) -> Problem | None:
    """Return the first problem that can be solved in the seconds `left`, on its own grid or the largest smaller one.

    The very first problem is a small one, because nothing is known yet of how long it takes.
    """
    for problem in problems:
        choice = [problem, *_smaller(problem)]
        for candidate in choice if known.rows else choice[-1:]:
            row = _features([candidate], kinds)[0]
            deviation = float(np.sqrt(row @ found.covariance @ row + found.scatter**2)) if known.rows else 0.0
            count = known.realisations(candidate)
            expected = count * float(np.exp(row @ found.coefficients + deviation))
            fits = block_bytes(candidate, count) < psutil.virtual_memory().available / 2
            if candidate.identity not in known.tried and expected <= left and fits:
                return candidate
    return None


def _smaller(problem: Problem) -> Iterator[Problem]:
    """Yield a problem on grids of half its nx, a quarter, and so on, without its shortest waves."""
    surface = problem.surface
    if problem.tractions is not None:
        return  # which are prescribed node by node
    for halvings in range(1, 32):
        fewer_waves = without_shortest(surface, 2 * (surface.nx >> (halvings + 1)), halvings)
        if fewer_waves is None or fewer_waves.nodes < _LEAST_NODES:
            return
        yield replace(problem, surface=fewer_waves, interface=problem.interface.everywhere)


def _measured(problem: Problem, count: int, timeout: float | None) -> float | None:
    """Return the processor time in s of a realisation; None if the problem fails or takes too long."""
    begun = time.thread_time()
    try:
        with watched(timeout):
            measured(problem, range(count))
    except Exception:  # the run itself will say which, and why
        return None
    return (time.thread_time() - begun) / count


def _most_telling(x: Reals, likely: Reals, found: _Regression, count: int) -> npt.NDArray[np.intp]:
    """Return the indices of the problems whose run time would narrow the total of the `likely` seconds most."""
    share = likely / likely.sum()
    spread = x @ found.covariance
    together = spread @ (share @ x)
    own = np.einsum("ij,ij->i", spread, x) + found.scatter**2
    gain = together**2 / own + (share * found.scatter) ** 2
    least = np.partition(gain, -count)[-count] if count < len(gain) else 0.0
    candidates = np.flatnonzero(gain >= least)  # the first ones where many tell the same
    return candidates[np.argsort(-gain[candidates], kind="stable")][:count]


def _cost(problems: list[Problem], x: Reals, weight: Reals, found: _Regression, known: _Known) -> Cost:
    seconds = np.array([known.memory.get(problem.identity, np.nan) for problem in problems])
    measured = ~np.isnan(seconds)
    rng = np.random.default_rng(0)
    logarithm = np.where(measured, np.log(np.where(measured, seconds, 1.0)), x @ found.coefficients)
    own = np.where(measured, _SCATTER, found.scatter)
    costliest = np.argsort(-weight * np.exp(logarithm), kind="stable")
    shifts = rng.multivariate_normal(np.zeros(x.shape[1]), found.covariance, _DRAWS)
    total = np.zeros(_DRAWS)
    for first in range(0, len(x), _SCATTERED):
        some = costliest[first : first + _SCATTERED]
        shift = np.where(measured[some], 0.0, shifts @ x[some].T)
        scatter = own[some] * rng.standard_normal(shift.shape) if first == 0 else 0.5 * own[some] ** 2
        total += np.exp(logarithm[some] + shift + scatter) @ weight[some]
    total *= np.exp(_MACHINE * rng.standard_normal(_DRAWS))
    each = dict(zip((problem.identity for problem in problems), np.exp(logarithm).tolist(), strict=True))
    return Cost(each, total, int(measured.sum()), len(known.rows) - int(measured.sum()))


def _regression(x: Reals, seconds: Reals) -> _Regression:
    """Fit the `seconds` [problem] of problems with features `x` [problem, feature] (Bayesian, conjugate)."""
    kinds = x.shape[1] - len(_PRIOR)
    expected = np.array([mean for _, mean, _ in _PRIOR] + [0.0] * kinds)
    precision = np.diag([deviation**-2 for _, _, deviation in _PRIOR] + [1.0] * kinds)
    deviation = np.log(seconds) - x @ expected
    scatter = 2.0 * _SCATTER
    for _ in range(3):  # the scatter and what it scatters around, in turn
        covariance = np.linalg.inv(precision + x.T @ x / scatter**2)
        coefficients = covariance @ (x.T @ deviation) / scatter**2
        left = deviation - x @ coefficients
        scatter = float(np.sqrt((4 * (2 * _SCATTER) ** 2 + left @ left) / (4 + len(left))))
    return _Regression(np.asarray(expected + coefficients), np.asarray(covariance, dtype=float), scatter)


def _features(problems: Sequence[Problem], kinds: Sequence[str]) -> Reals:
    """Return the logarithms of what decides the run time [problem, feature], 0 for the thesis's reference system."""
    found = np.empty((len(problems), len(_PRIOR) + len(kinds)))
    stiffening: dict[ElasticBody, float] = {}
    for row, problem in zip(found, problems, strict=True):
        surface, body = problem.surface, problem.body
        if body not in stiffening:
            longest = np.array([2.0 * np.pi])
            stiffening[body] = float(np.log(body.condensed_stiffness(longest) / stiffness.half_space(longest))[0])
        cut_on, cut_off, hurst, anisotropy = _spectrum(surface)
        size = math.log(price_of_transform(surface.nodes) / price_of_transform(8192))
        beyond = max(0.0, math.log(surface.nodes / _CACHED))
        row[: len(_PRIOR)] = (
            1.0,
            size,
            0.0 if problem.numerics.solver in _STATIC else size,
            *(beyond * (len(surface.shape) == dimension) for dimension in (1, 2)),
            math.log(surface.nx / cut_off / 4),
            math.log(cut_off / cut_on / 1024),
            hurst - 0.5,
            0.0 if problem.mean_pressure is None else math.log(problem.mean_pressure / 0.007),
            stiffening[body],
            math.log(anisotropy),
            math.log(problem.n_loads),
        )
        own = _kind(problem)
        row[len(_PRIOR) :] = [own == kind for kind in kinds]
    return found


def _spectrum(surface: Surface) -> tuple[float, float, float, float]:
    """Return the wave indices between which the spectrum falls, the Hurst exponent and the anisotropy, or a guess.

    Of a sum of surfaces they are those of the steepest rough one.
    """
    one: Surface | SmoothSurface = surface
    if isinstance(surface, SummedSurface):
        rough = [part for part in surface.parts if not isinstance(part.surface, SmoothSurface)] or surface.parts
        one = max(rough, key=lambda part: part.rms_gradient).surface
    if not isinstance(one, RandomSurface):
        return 1.0, one.shape[-1] / 8, 0.5, 1.0
    generator = one.generator
    return *generator.band, generator.hurst, getattr(generator, "anisotropy", 1.0)


def _kind(problem: Problem) -> str:
    surface, laws = problem.surface, "+".join(problem.interface.laws)
    if problem.interface.hardness is not None:
        laws += "+hardness"
    path = " path" if problem.path else ""
    rough = f" rough {problem.rough.order}" if problem.rough is not None else ""
    return f"{problem.numerics.solver} {len(surface.shape)} {laws} {problem.mean_pressure is None}{path}{rough}"


def remembered() -> dict[str, float]:
    """Return the run times in s that were kept, by what took them; none if they cannot be read."""
    try:
        return json_file.read(_memory())
    except OSError:
        return {}  # there is no place for it


def remember(seconds: dict[str, float]) -> None:
    """Keep run times for later plans, if the disk allows."""
    try:
        path = _memory()
        path.parent.mkdir(mode=0o700, exist_ok=True)
        json_file.write(path, seconds)
    except (OSError, InputError):
        pass  # the next plan measures again


def _memory() -> Path:
    """Return the file of the run times of this version on this machine."""
    name = f"{version('gfmd-numba')}-{version('numba')}-{platform.node()}-{platform.machine()}"
    return cache.directory() / "times" / f"{name}.json"
