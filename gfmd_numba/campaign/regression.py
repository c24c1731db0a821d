"""The run time of a contact as a regression on what decides it, with what is known before anything is measured."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.surfaces import GivenSurface, SummedSurface, Surface
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody

SCATTER = 0.15  # of the logarithm of a run time: what repeating it on a quiet machine gives
_CALLS = 4e4  # what is done once for each contact, in units of n log2(n)
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


@dataclass(frozen=True)
class Regression:
    """Mean and covariance of the coefficients, and the scatter of the logarithm of a run time around them."""

    coefficients: Reals
    covariance: Reals
    scatter: float


def regression(x: Reals, seconds: Reals) -> Regression:
    """Fit the `seconds` [problem] of problems with features `x` [problem, feature] (Bayesian, conjugate)."""
    kinds = x.shape[1] - len(_PRIOR)
    expected = np.array([mean for _, mean, _ in _PRIOR] + [0.0] * kinds)
    precision = np.diag([deviation**-2 for _, _, deviation in _PRIOR] + [1.0] * kinds)
    excess = np.log(seconds) - x @ expected
    scatter = 2.0 * SCATTER
    for _ in range(3):  # the scatter and what it scatters around, in turn
        covariance = np.linalg.inv(precision + x.T @ x / scatter**2)
        coefficients = covariance @ (x.T @ excess) / scatter**2
        left = excess - x @ coefficients
        scatter = float(np.sqrt((4 * (2 * SCATTER) ** 2 + left @ left) / (4 + len(left))))
    return Regression(np.asarray(expected + coefficients), np.asarray(covariance, dtype=float), scatter)


def kinds_of(problems: Sequence[Problem]) -> list[str]:
    """Return the kinds among problems: each has an iteration of its own, hence a run time of its own."""
    return sorted({_kind(problem) for problem in problems})


def features(problems: Sequence[Problem], kinds: Sequence[str]) -> Reals:
    """Return logarithms of what decides the run time [problem, feature], zero at the thesis's reference system."""
    found = np.empty((len(problems), len(_PRIOR) + len(kinds)))
    stiffening: dict[ElasticBody, float] = {}
    for row, problem in zip(found, problems, strict=True):
        surface, body = problem.surface, problem.body
        if body not in stiffening:
            longest = np.array([2.0 * np.pi])
            stiffening[body] = float(np.log(body.condensed_stiffness(longest) / stiffness.half_space(longest))[0])
        cut_on, cut_off, hurst, anisotropy = _spectrum(surface)
        size = math.log(_work(surface.nodes) / _work(8192))
        beyond = max(0.0, math.log(surface.nodes / _CACHED))
        row[: len(_PRIOR)] = (
            1.0,
            size,
            0.0 if problem.numerics.solver in _STATIC else size,
            beyond if len(surface.shape) == 1 else 0.0,
            beyond if len(surface.shape) == 2 else 0.0,
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
    """Wave indices between which the spectrum falls, Hurst exponent and anisotropy; those of a guess if unknown.

    Of a sum those of the steepest surface.
    """
    if isinstance(surface, SummedSurface):
        surface = max(surface.parts, key=lambda part: part.rms_gradient).surface
    if isinstance(surface, GivenSurface):
        return 1.0, surface.nx / 8, 0.5, 1.0
    generator = surface.generator
    return *generator.band, generator.hurst, getattr(generator, "anisotropy", 1.0)


def _work(nodes: int) -> float:
    return nodes * math.log2(nodes) + _CALLS


def _kind(problem: Problem) -> str:
    surface, laws = problem.surface, "+".join(problem.interface.laws)
    if problem.interface.hardness is not None:
        laws += "+hardness"
    path = " path" if problem.path else ""
    rough = f" rough {problem.rough.order}" if problem.rough is not None else ""
    return f"{problem.numerics.solver} {len(surface.shape)} {laws} {problem.mean_pressure is None}{path}{rough}"
