"""What the results of some groups say of the limit, for every law that is possible, each by how well it fits.

Over the parameters of the laws we integrate by quadrature, on a box that is narrowed to where they are likely.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.special import logsumexp

from gfmd_numba.analysis.laws import Parameter
from gfmd_numba.analysis.linear_fit import (
    Laws,
    Linear,
    Means,
    certainty,
    columns,
    excess,
    known_before,
    linear,
    misfit,
    solved,
)
from gfmd_numba.arrays import Reals

_COARSE = 7  # points in each parameter, while the box is narrowed
_FINE = {1: 25, 2: 21, 3: 15}  # and in the end, by the number of parameters: spacings of a standard deviation
_FINE_OF_MORE = 9
_UNLIKELY = 25.0  # chi^2 above the least one, beyond which parameters do not count: 5 standard deviations
_ROUNDS = 60
_gauss = cache(np.polynomial.legendre.leggauss)


@dataclass(frozen=True)
class Choice:
    """One choice of laws: nodes in their parameters, the logarithms of the nodes' weights, and each group's fits."""

    laws: Laws
    parameters: tuple[Parameter, ...]
    nodes: Reals  # values of the parameters (node, parameter)
    log_weight: Reals
    fits: list[Linear]


def weighed(means: Sequence[Means], laws: Laws) -> Choice:
    """Return the fits of groups that share their laws' parameters, at nodes weighed by how well they fit."""
    parameters = tuple(parameter for law in laws.values() for parameter in law.parameters)
    before = [known_before(each, laws) for each in means]
    ends = np.array([parameter.ends for parameter in parameters])
    low, high = ends.T.copy()
    fine = _FINE.get(int((low < high).sum()), _FINE_OF_MORE)
    points = _COARSE
    for _ in range(_ROUNDS):
        nodes, log_volume, shape = _nodes(parameters, low, high, points)
        chi2 = sum(
            (misfit(each, laws, nodes, known) for each, known in zip(means, before, strict=True)),
            start=-2.0 * _log_density(parameters, nodes),
        )
        new_low, new_high = _narrowed(chi2.reshape(shape), low, high, ends)
        settled = (new_high - new_low >= 0.7 * (high - low)) & (new_low >= low - 1e-15) & (new_high <= high + 1e-15)
        if settled.all() and points == fine:
            break
        points = fine if settled.all() else points
        low, high = new_low, new_high
    fits = [linear(each, laws, nodes, known) for each, known in zip(means, before, strict=True)]
    return Choice(laws, parameters, nodes, log_volume - chi2 / 2.0, fits)


def shares(choices: Sequence[Choice]) -> list[Reals]:
    """Return the weights of the nodes of all choices, which add up to 1."""
    whole = logsumexp(np.concatenate([choice.log_weight for choice in choices]))
    return [np.exp(choice.log_weight - whole) for choice in choices]


def _log_density(parameters: Sequence[Parameter], nodes: Reals) -> Reals:
    """Return the logarithm of how likely nodes (node, parameter) are before there are data."""
    found = np.zeros(len(nodes))
    for parameter, values in zip(parameters, nodes.T, strict=True):
        found += parameter.log_density(parameter.positions(values))
    return found


def _nodes(parameters: Sequence[Parameter], low: Reals, high: Reals, size: int) -> tuple[Reals, Reals, tuple[int, ...]]:
    """Return nodes of Gauss and Legendre in a box (node, parameter), the logarithm of their volume, and their shape."""
    points, weights = _gauss(size)
    axes, volumes = [], []
    for parameter, left, right in zip(parameters, low, high, strict=True):
        exact = right <= left
        axes.append(parameter.values(np.array([left]) if exact else left + (right - left) * (1.0 + points) / 2.0))
        volumes.append(np.zeros(1) if exact else np.log(weights / 2.0 * (right - left)))
    shape = tuple(axis.size for axis in axes)
    nodes = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=-1)
    log_volume = sum(axis.ravel() for axis in np.meshgrid(*volumes, indexing="ij"))
    return nodes, np.asarray(log_volume), shape


def _narrowed(misfit: Reals, low: Reals, high: Reals, ends: Reals) -> tuple[Reals, Reals]:
    """Return the box of the likely nodes and one more on each side, or a wider box if likely nodes lie at its edge."""
    likely = misfit - misfit.min() < _UNLIKELY
    width = high - low
    narrow, wide = np.array([low, high]), np.array([low, high])
    for axis, size in enumerate(misfit.shape):
        if size == 1:
            continue
        others = tuple(other for other in range(misfit.ndim) if other != axis)
        found = np.flatnonzero(likely.any(axis=others))
        points = (1.0 + _gauss(size)[0]) / 2.0
        grid = low[axis] + width[axis] * np.concatenate([[0.0], points, [1.0]])
        narrow[:, axis] = grid[found[0]], grid[found[-1] + 2]
        if found[0] == 0:
            wide[0, axis] = max(ends[axis, 0], low[axis] - 0.5 * width[axis])
        if found[-1] == size - 1:
            wide[1, axis] = min(ends[axis, 1], high[axis] + 0.5 * width[axis])
    cut = (wide != [low, high]).any()
    return tuple(wide) if cut else tuple(narrow)


def along(choice: Choice, index: int, means: Means, limit: str, eps: Reals) -> Reals:
    """Return the fits (node, level) of a group at levels of one limit, the others at the reference."""
    found = excess(choice.laws, limit, np.append(eps, means.reference[limit]), choice.nodes)
    ratio = found[:, :-1] / found[:, -1:]
    row = 1 + list(means.levels).index(limit)
    coefficients = choice.fits[index].coefficients
    there, here = (
        coefficients[:, [row]] * each + means.of_pairs(limit, each, coefficients) for each in (ratio, np.ones((1, 1)))
    )
    return np.asarray(coefficients.sum(axis=1, keepdims=True) + there - here)


def linearised(means: Means, choice: Choice) -> tuple[Reals, Reals, Reals, float]:
    """Return a choice of laws as a linear fit about its mean parameters, with the TFC limit there.

    The columns (case, coefficient), their derivatives (case, parameter) to the positions of the parameters in their
    ranges, and what is known before of coefficients and parameters: one over the variance of each.
    """
    share = np.exp(choice.log_weight - logsumexp(choice.log_weight))
    at = np.array(
        [parameter.positions(node) for parameter, node in zip(choice.parameters, choice.nodes.T, strict=True)]
    )
    mean = at @ share
    before = known_before(means, choice.laws)
    moving = [index for index, parameter in enumerate(choice.parameters) if parameter.low < parameter.high]
    step = 1e-3 * np.eye(len(mean))[moving]
    positions = np.vstack([mean, mean + step, mean - step])
    nodes = np.stack(
        [parameter.values(row) for parameter, row in zip(choice.parameters, positions.T, strict=True)], axis=-1
    )
    at_nodes = columns(means, choice.laws, nodes, before)
    coefficients = solved(means, choice.laws, nodes[:1], before)[0][0]
    forward, backward = at_nodes[1 : 1 + len(moving)], at_nodes[1 + len(moving) :]
    slopes = ((forward - backward) @ coefficients).T / 2e-3
    variances = np.array([choice.parameters[index].variance for index in moving])
    known = np.concatenate([certainty(means, choice.laws, before), 1.0 / variances])
    return at_nodes[0], slopes, known, float(coefficients[0])
