"""The compliance as an accurate sum of decays, and all else that a body and a grid decide, made once for both."""

from collections import OrderedDict
from dataclasses import dataclass
from hashlib import blake2b

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.kernels.decays import POWERS
from gfmd_numba.solvers.preconditioners.exponential_sum import ExponentialSum

# 32 decays, within 1e-5 to 4e-5 of 1/q at 2^13 to 2^20 nodes; alternating ones, (-1)^m exp(-rate m), for the kink of
# |q| at Nyquist
_SMOOTH, _ALTERNATING = 20, 12
_SLOWEST, _FASTEST = 0.5, 3.0  # smooth: half the longest wave's, and a rate per node that leaves little but the node
_SLOWEST_ALTERNATING = 1e-3
_SAMPLES = 100  # wave numbers fitted, as many near q = 0, on a logarithmic scale, as twice that near Nyquist
_RIDGE = 1e-8  # of the size of columns: keeps weights small where fewer decays would do
_SPACING, _FAINT = 2.0, 1e-3  # of the preconditioner's decays: fewer factor faster, and are close enough here
_CLOSE = 0.03  # relative error up to which a sum of decays is taken for the compliance
_COARSENING = 4
_COARSEST = 256  # nodes up to which the first guess is full contact
_KEPT = 32  # bodies and grids


@dataclass(frozen=True, eq=False)
class DecayModel:
    """Sum of decays close to a compliance on n nodes, as `kernels.decay_contact` takes it.

    `error` is its largest relative error. `compliance` and `stiffness` `[n // 2 + 1]` are zero at q = 0 where they do
    not count there. `coarser` is the model of every fourth node, for the first guess.
    """

    n: int
    compliance: Reals
    stiffness: Reals
    error: float
    powers: Reals
    weights: Reals
    white: float
    mean: float
    preconditioner: ExponentialSum
    coarser: "DecayModel | None"


_models: OrderedDict[tuple[int, bool, bytes], DecayModel | None] = OrderedDict()


def decay_model(stiffness: Reals, shape: tuple[int, ...], free_mean: bool) -> DecayModel | None:
    """Model of a stiffness on the nodes of a profile, None on maps and where decays are far; made once for both."""
    n, *of_maps = shape
    if of_maps:
        return None
    key = (n, free_mean, blake2b(stiffness.tobytes()).digest())
    if key not in _models:
        _models[key] = _made(stiffness, n, free_mean)
        if len(_models) > _KEPT:
            _models.popitem(last=False)
    _models.move_to_end(key)
    return _models[key]


def _made(stiffness: Reals, n: int, free_mean: bool) -> DecayModel | None:
    with np.errstate(divide="ignore"):
        compliance = np.where(stiffness > 0.0, 1.0 / stiffness, 0.0)
    if n < 3 or not (compliance[1:] > 0.0).all():
        return None
    slowest = _SLOWEST * np.pi / n
    rates = np.concatenate(
        (np.geomspace(slowest, _FASTEST, _SMOOTH), np.geomspace(_SLOWEST_ALTERNATING, _FASTEST, _ALTERNATING))
    )
    signs = np.repeat([1.0, -1.0], [_SMOOTH, _ALTERNATING])
    order = np.argsort(rates, kind="stable")
    rates, signs = rates[order], signs[order]
    weights, white, error = _fit(compliance, n, rates, signs)
    if not error <= _CLOSE:
        return None
    preconditioner = ExponentialSum(compliance, n, _SPACING, _FAINT)
    if not preconditioner.is_safe:
        return None
    coarser = None
    if n > _COARSEST:
        nodes = -(-n // _COARSENING)
        coarser = _made(stiffness[: nodes // 2 + 1], nodes, free_mean)
        if coarser is None:
            return None
    periodic = signs**n * np.exp(-n * rates)
    mean = 0.0
    if not free_mean:  # a constant makes up for what the decays have at q = 0
        mean = float(compliance[0] - (_symbols(np.zeros(1), rates, signs)[0] * weights).sum() - white) / n
    white += float(weights.sum())  # sweeps go from node to node
    digits, top = [], 1
    while top <= n:
        exponents = top * np.arange(POWERS, dtype=np.float64)
        digits.append(np.exp(-np.outer(exponents, rates)) * np.where(np.outer(exponents % 2, signs < 0), -1.0, 1.0))
        top *= POWERS
    return DecayModel(
        n, compliance / n, np.where(np.isfinite(stiffness), stiffness, 0.0) / n, error, np.concatenate(digits),
        np.stack((weights, 1.0 / (1.0 - periodic))), white, mean, preconditioner, coarser,
    )  # fmt: skip


def _symbols(phase: Reals, rates: Reals, signs: Reals) -> Reals:
    """Fourier transforms `[phase, decay]` of decays on the nodes, at half the angles given."""
    trigonometric = np.where(signs > 0.0, np.sin(phase)[:, np.newaxis], np.cos(phase)[:, np.newaxis])
    return np.asarray(np.sinh(rates) / (2.0 * (np.sinh(rates / 2.0) ** 2 + trigonometric**2)))


def _fit(compliance: Reals, n: int, rates: Reals, signs: Reals) -> tuple[Reals, float, float]:
    """Weights of the decays and of the node itself, by least squares of the relative error, and the largest error."""
    half = n // 2
    near_zero, near_nyquist = np.geomspace(1, half, 2 * _SAMPLES), half + 1 - np.geomspace(1, half, _SAMPLES)
    sampled = np.unique(np.round(np.concatenate((near_zero, near_nyquist))).astype(np.int64))
    index = np.unique(np.concatenate((sampled, (sampled[:-1] + sampled[1:]) // 2)))
    fitted = np.isin(index, sampled)
    symbols = _symbols(np.pi * index / n, rates, signs)
    ratios = np.column_stack((symbols, np.ones(len(index)))) / compliance[index, np.newaxis]
    scale = np.sqrt((ratios[fitted] ** 2).sum(axis=0))
    ridge = _RIDGE * np.eye(scale.size)
    matrix = np.concatenate((ratios[fitted] / scale, ridge))
    right = np.concatenate((np.ones(fitted.sum()), np.zeros(scale.size)))
    weights = np.empty(scale.size)
    kernels.least_squares(matrix, right, weights)
    weights /= scale
    error = np.abs((ratios * weights).sum(axis=1) - 1.0).max()
    return weights[:-1], float(weights[-1]), float(error)
