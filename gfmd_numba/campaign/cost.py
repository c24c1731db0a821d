"""What a campaign's contacts will cost on this machine: a pilot solves a few, a regression predicts the rest."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from itertools import islice

import numpy as np
import numpy.typing as npt
import psutil

from gfmd_numba.arrays import Reals
from gfmd_numba.campaign.cases import block_bytes
from gfmd_numba.campaign.regression import SCATTER, Regression, features, kinds_of, regression
from gfmd_numba.campaign.run_times import remember, remembered
from gfmd_numba.campaign.watchdog import watched
from gfmd_numba.contact.path_measures import measured
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.surfaces import without_shortest

Told = Callable[[float], None]  # of the share of something long that is done

_SAMPLES, _MOST_REALISATIONS = 2**17, 16  # nodes solved at a time in the pilot, as far as they are contacts
_LEAST_PILOTS, _MOST_PILOTS = 4, 32
_LEAST_NODES = 2**12  # of a smaller problem in place of one that takes too long: below, calls take the time
_LOOKED_AT = 50  # problems, those that tell most, for one the pilot can afford
_MACHINE = 0.25  # of the logarithm of all run times: a machine is not equally fast all day
_DRAWS = 200
_SCATTERED = 2**12  # problems, the costliest, whose scatter is drawn for each; that of more averages out


@dataclass(frozen=True)
class Cost:
    """Predicted processor time: seconds a realisation by identity of the problem, and draws of the total in s.

    `pilot` is the number of problems that were measured, `smaller` that of smaller ones in place of others.
    """

    seconds: dict[str, float]
    total: Reals
    pilot: int
    smaller: int

    def quantile(self, probability: float) -> float:
        """Total processor time in s that is not exceeded with a probability."""
        return float(np.quantile(self.total, probability))


def predict(
    problems: list[Problem],
    realisations: list[int],
    budget: float,
    warm: Callable[[list[Problem]], None],
    timeout: float | None = None,
    told: Told | None = None,
) -> Cost:
    """Predicted cost of the realisations of each problem, from a pilot of at most `budget` seconds.

    The pilot takes no more than a tenth of the work itself unless that tells nothing. Where a problem takes too long
    for it, the same physics is measured on a smaller grid. `warm` is called before anything is timed. Earlier pilots
    on this machine are remembered, and count into the budget. A problem that fails, or takes longer than `timeout`
    seconds, is predicted as the others.
    """
    kinds = kinds_of(problems)
    x, weight = features(problems, kinds), np.array(realisations, dtype=float)
    known = _Known(remembered(), min(_MOST_REALISATIONS, max(realisations, default=1)))
    for problem, row in zip(problems, x, strict=True):
        known.recall(problem, row)
    warmed = False
    while True:
        found = regression(*known.data(x.shape[1]))
        likely = weight * np.exp(x @ found.coefficients)
        left = (budget if len(known.rows) < _LEAST_PILOTS else min(budget, 0.1 * float(likely.sum()))) - known.spent
        chosen = None
        if left > 0.0 and len(known.rows) < _MOST_PILOTS:
            telling = (problems[i] for i in _most_telling(x, likely, found, _LOOKED_AT + len(known.tried)))
            untried = (problem for problem in telling if problem.identity not in known.tried)
            chosen = _affordable(list(islice(untried, _LOOKED_AT)), kinds, found, known, left)
        if chosen is None:
            break
        row = features([chosen], kinds)[0]
        if not known.recall(chosen, row):
            if not warmed:
                warm(problems)
                warmed = True
            known.learn(chosen, row, timeout)
        if told is not None:
            told(min(1.0, known.spent / (known.spent + left)))
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
    problems: list[Problem], kinds: list[str], found: Regression, known: _Known, left: float
) -> Problem | None:
    """First problem that the seconds `left` allow for, or the same on the largest smaller grid they allow for.

    The first of all is small, as nothing is known of how long it takes.
    """
    for problem in problems:
        choice = [problem, *_smaller(problem)]
        for candidate in choice if known.rows else choice[-1:]:
            row = features([candidate], kinds)[0]
            doubt = float(np.sqrt(row @ found.covariance @ row + found.scatter**2)) if known.rows else 0.0
            count = known.realisations(candidate)
            expected = count * float(np.exp(row @ found.coefficients + doubt))
            fits = block_bytes(candidate, count) < psutil.virtual_memory().available / 2
            if candidate.identity not in known.tried and expected <= left and fits:
                return candidate
    return None


def _smaller(problem: Problem) -> Iterator[Problem]:
    """The physics of a problem on grids of half its nx, a quarter, and so on: its shortest waves are left out."""
    surface = problem.surface
    if problem.tractions is not None:
        return  # which are prescribed node by node
    for halvings in range(1, 32):
        nx = 2 * (surface.nx >> (halvings + 1))
        if nx ** len(surface.shape) < _LEAST_NODES:
            return
        fewer_waves = without_shortest(surface, nx, halvings)
        if fewer_waves is None:
            return
        yield replace(problem, surface=fewer_waves)


def _measured(problem: Problem, count: int, timeout: float | None) -> float | None:
    """Seconds of the processor a realisation, whatever else the machine does; None where it fails or takes too long."""
    begun = time.thread_time()
    try:
        with watched(timeout):
            measured(problem, range(count))
    except Exception:  # the run itself will say which, and why
        return None
    return (time.thread_time() - begun) / count


def _most_telling(x: Reals, likely: Reals, found: Regression, count: int) -> npt.NDArray[np.intp]:
    """Indices of so many problems whose run time narrows the total of the `likely` seconds most, the most first."""
    share = likely / likely.sum()
    spread = x @ found.covariance
    together = spread @ (share @ x)
    own = np.einsum("ij,ij->i", spread, x) + found.scatter**2
    gain = together**2 / own + (share * found.scatter) ** 2
    least = np.partition(gain, -count)[-count] if count < len(gain) else 0.0
    candidates = np.flatnonzero(gain >= least)  # the first ones where many tell the same
    return candidates[np.argsort(-gain[candidates], kind="stable")][:count]


def _cost(problems: list[Problem], x: Reals, weight: Reals, found: Regression, known: _Known) -> Cost:
    seconds = np.array([known.memory.get(problem.identity, np.nan) for problem in problems])
    measured = ~np.isnan(seconds)
    rng = np.random.default_rng(0)
    logarithm = np.where(measured, np.log(np.where(measured, seconds, 1.0)), x @ found.coefficients)
    own = np.where(measured, SCATTER, found.scatter)
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
