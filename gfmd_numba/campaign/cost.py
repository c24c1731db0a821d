"""What a campaign will cost on this machine: a pilot solves a few of its contacts, a regression predicts the rest."""

import json
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np
import numpy.typing as npt

from gfmd_numba import cache
from gfmd_numba.campaign import shards
from gfmd_numba.campaign.watchdog import watched
from gfmd_numba.contact import solve
from gfmd_numba.elasticity import stiffness
from gfmd_numba.observables import measure
from gfmd_numba.problem import Problem, RandomSurface

Reals = npt.NDArray[np.float64]

_REALISATIONS = 2  # solved of each problem in the pilot
_LEAST_PILOTS, _MOST_PILOTS = 4, 32
_DRAWS = 200
_SCATTER = 0.15  # of the logarithm of a run time: what repeating it on a quiet machine gives
# logarithm of seconds = coefficients . features: expectation and standard deviation before anything is measured
_PRIOR = (
    ("one", -3.5, 3.0),  # 0.03 s at nx = 8192
    ("nx", 1.3, 0.3),
    ("nodes of the shortest wave", 0.0, 0.3),
    ("waves", 0.0, 0.3),
    ("hurst", 0.0, 1.0),
    ("reduced pressure", 0.0, 0.3),
    ("stiffening", 0.0, 0.3),
)


@dataclass(frozen=True)
class Cost:
    """Predicted processor time: seconds a realisation by identity of the problem, and draws of the total in s.

    `pilot` is the number of problems that were measured.
    """

    seconds: dict[str, float]
    total: Reals
    pilot: int

    def quantile(self, probability: float) -> float:
        """Total processor time in s that is not exceeded with a probability."""
        return float(np.quantile(self.total, probability))


def predict(
    problems: list[Problem],
    realisations: list[int],
    budget: float,
    warm: Callable[[list[Problem]], None],
    timeout: float | None = None,
) -> Cost:
    """Predicted cost of the realisations of each problem, from a pilot of at most `budget` seconds.

    The pilot takes no more than a tenth of the work itself unless that tells nothing. `warm` is called before
    anything is timed. Earlier pilots on this machine are remembered. A problem that fails, or takes longer than
    `timeout` seconds, is predicted as the others.
    """
    x = _features(problems)
    identities = [problem.identity for problem in problems]
    remembered = _remembered()
    seconds = np.array([remembered.get(identity, np.nan) for identity in identities])
    weight = np.array(realisations, dtype=float)
    missing = np.isnan(seconds)
    fit_to_measure = np.ones(len(problems), dtype=bool)
    begun = None
    while missing.any() and (known := len(problems) - missing.sum()) < _MOST_PILOTS:
        mean = np.exp(x @ _regression(x, seconds)[0])
        if begun is None:
            warm(problems)
            begun = time.perf_counter()
        left = budget if known < _LEAST_PILOTS else min(budget, 0.1 * float(weight @ mean))
        affordable = missing & fit_to_measure & (_REALISATIONS * mean <= left - (time.perf_counter() - begun))
        if not affordable.any():
            break
        i = _most_informative(x, ~missing, affordable)
        measured = _measured(problems[i], timeout)
        if measured is None:
            fit_to_measure[i] = False
        else:
            seconds[i] = remembered[identities[i]] = measured
            missing[i] = False
    if begun is not None:
        _remember(remembered)
    return _cost(x, seconds, weight, identities)


def _measured(problem: Problem, timeout: float | None) -> float | None:
    """Seconds of the processor a realisation, whatever else the machine does; None where it fails or takes too long."""
    begun = time.thread_time()
    try:
        with watched(timeout):
            measure(solve(problem, range(_REALISATIONS)))
    except Exception:  # the run itself will say which, and why
        return None
    return (time.thread_time() - begun) / _REALISATIONS


def _features(problems: list[Problem]) -> Reals:
    """Logarithms of what decides the run time `[problem, feature]`, zero at the thesis's reference system."""
    rows = []
    kinds = sorted({_kind(problem) for problem in problems})
    stiffening: dict[tuple[float | None, float | None], float] = {}
    for problem in problems:
        surface, body = problem.surface, problem.body
        assert isinstance(surface, RandomSurface)  # a campaign has no other
        slab = body.poissons_ratio, body.aspect_ratio
        if slab not in stiffening:
            ratio = 1.0
            if body.aspect_ratio is not None and body.poissons_ratio is not None:
                k = np.array([2.0 * np.pi * body.aspect_ratio])
                ratio = float(stiffness.slab_factor(k, body.poissons_ratio)[0])
            stiffening[slab] = np.log(ratio)
        row = [
            1.0,
            np.log(surface.nodes / 8192),
            np.log(surface.nx / surface.cut_off_index / 4),
            np.log(surface.cut_off_index / surface.cut_on_index / 1024),
            surface.hurst - 0.5,
            0.0 if problem.mean_pressure is None else np.log(problem.mean_pressure / 0.007),
            stiffening[slab],
        ]
        rows.append(row + [float(_kind(problem) == kind) for kind in kinds])
    return np.array(rows)


def _kind(problem: Problem) -> str:
    """What has an iteration of its own, hence a run time of its own."""
    interface = problem.interface
    return f"{problem.numerics.solver} {interface.law is None} {interface.couples} {problem.mean_pressure is None}"


def _regression(x: Reals, seconds: Reals) -> tuple[Reals, Reals, float]:
    """Mean and covariance of the coefficients, and the scatter of the logarithm around them (Bayesian, conjugate)."""
    kinds = x.shape[1] - len(_PRIOR)
    expected = np.array([mean for _, mean, _ in _PRIOR] + [0.0] * kinds)
    precision = np.diag([deviation**-2 for _, _, deviation in _PRIOR] + [1.0] * kinds)
    known = ~np.isnan(seconds)
    a, excess = x[known], np.log(seconds[known]) - x[known] @ expected
    scatter = 2.0 * _SCATTER
    for _ in range(3):  # the scatter and what it scatters around, in turn
        covariance = np.linalg.inv(precision + a.T @ a / scatter**2)
        coefficients = covariance @ (a.T @ excess) / scatter**2
        left = excess - a @ coefficients
        scatter = float(np.sqrt((4 * (2 * _SCATTER) ** 2 + left @ left) / (4 + len(left))))
    return np.asarray(expected + coefficients), np.asarray(covariance, dtype=float), scatter


def _most_informative(x: Reals, known: npt.NDArray[np.bool_], candidates: npt.NDArray[np.bool_]) -> int:
    """Index of the candidate farthest from all that is known; at first, of the cheapest one."""
    indices = np.flatnonzero(candidates)
    if not known.any():
        return int(indices[np.argmin(x[indices, 1])])
    nearest = np.full(len(indices), np.inf)
    for i in np.flatnonzero(known):
        nearest = np.minimum(nearest, ((x[indices] - x[i]) ** 2).sum(axis=1))
    return int(indices[np.argmax(nearest)])


def _cost(x: Reals, seconds: Reals, weight: Reals, identities: list[str]) -> Cost:
    coefficients, covariance, scatter = _regression(x, seconds)
    known = ~np.isnan(seconds)
    rng = np.random.default_rng(0)
    logarithm = np.where(known, np.log(np.where(known, seconds, 1.0)), x @ coefficients)
    own = np.where(known, _SCATTER, scatter)
    total = np.empty(_DRAWS)
    for i in range(_DRAWS):
        shift = x @ rng.multivariate_normal(np.zeros(len(coefficients)), covariance)
        shift[known] = 0.0
        total[i] = weight @ np.exp(logarithm + shift + own * rng.standard_normal(len(x)))
    total *= np.exp(_SCATTER * rng.standard_normal(_DRAWS))  # a machine is not equally fast all day
    return Cost(dict(zip(identities, np.exp(logarithm).tolist(), strict=True)), total, int(known.sum()))


def _memory() -> Path:
    """File of earlier pilots of this version on this machine."""
    name = f"{version('gfmd-numba')}-{version('numba')}-{platform.node()}-{platform.machine()}"
    return cache.directory() / "run-times" / f"{name}.json"


def _remembered() -> dict[str, float]:
    try:
        times = json.loads(_memory().read_text())
        return {str(identity): float(seconds) for identity, seconds in times.items()}
    except (OSError, ValueError, AttributeError, TypeError):
        return {}  # none, or a damaged one: it is measured again


def _remember(seconds: dict[str, float]) -> None:
    path = _memory()
    try:
        path.parent.mkdir(exist_ok=True)
        shards.replace(path, json.dumps(seconds).encode())
    except OSError:
        pass  # the next plan measures again
