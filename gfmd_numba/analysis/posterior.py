"""What the results of some groups say of the limit, for every law that is possible, each by how well it fits.

At known parameters of the laws the fit is linear: kappa_tfc, a correction for each limit, and an interaction for each
pair of limits, by which their corrections taken together differ from their sum. Interactions are products of the two
laws. Nothing but cross levels, where two discretisations differ from the reference at once, tells them. What is known
before is that they are of the size of the smaller correction, and that the correction in eps_t wanes with eps_f: it
comes from the few longest waves, whose part in the slope falls. Over the parameters of the laws we integrate by
quadrature, on a box that is narrowed to where they are likely.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.special import logsumexp

from gfmd_numba.analysis.laws import Law, Parameter, power
from gfmd_numba.arrays import Reals

Laws = dict[str, Law]
_COARSE = 7  # points in each parameter, while the box is narrowed
_FINE = {1: 25, 2: 21, 3: 15}  # and in the end, by the number of parameters: spacings of a standard deviation
_FINE_OF_MORE = 9
_UNLIKELY = 25.0  # chi^2 above the least one, beyond which parameters do not count: 5 standard deviations
_ROUNDS = 60
# Interactions over the smaller of the two corrections before any cross level says more: mean and standard deviation.
# Measured (H = 0.3 to 1): 0.0 to 0.5, of eps_f and eps_t 1.0 to 1.5.
_INTERACTION = (0.0, 0.5)
_WANING = {("eps_f", "eps_t"): (1.0, 0.5)}


@dataclass(frozen=True)
class Means:
    """The means of a group's cases: `whitener` makes their errors independent and of unit variance."""

    values: Reals
    whitener: Reals
    levels: dict[str, Reals]  # (case) of the limits that are varied
    reference: dict[str, float]

    @property
    def pairs(self) -> list[tuple[str, str]]:
        """Pairs of the limits that are varied."""
        return list(combinations(self.levels, 2))


@dataclass(frozen=True)
class Before:
    """What is known of the interactions of each pair before: their mean, in units of their scatter, and that."""

    mean: Reals
    scatter: Reals


@dataclass(frozen=True)
class Linear:
    """The linear fits of one group (node, ...) at the nodes of a quadrature.

    The coefficients are kappa_tfc, the correction of each limit at the reference and the interaction of each pair.
    """

    misfit: Reals  # chi^2 (node)
    coefficients: Reals  # (node, coefficient)
    covariance: Reals  # (node, coefficient, coefficient)
    influence: Reals  # of each mean on kappa_tfc (node, case)
    pull: Reals  # derivative of chi^2 to each mean (node, case)
    exponents: Reals  # of each limit's law at the reference (node, limit)


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
    before = [_before(each, laws) for each in means]
    ends = np.array([parameter.ends for parameter in parameters])
    low, high = ends.T.copy()
    fine = _FINE.get(int((low < high).sum()), _FINE_OF_MORE)
    points = _COARSE
    for _ in range(_ROUNDS):
        nodes, log_volume, shape = _nodes(parameters, low, high, points)
        misfit = sum(
            (_misfit(each, laws, nodes, known) for each, known in zip(means, before, strict=True)),
            start=np.zeros(len(nodes)),
        )
        new_low, new_high = _narrowed(misfit.reshape(shape), low, high, ends)
        settled = (new_high - new_low >= 0.7 * (high - low)) & (new_low >= low - 1e-15) & (new_high <= high + 1e-15)
        if settled.all() and points == fine:
            break
        points = fine if settled.all() else points
        low, high = new_low, new_high
    fits = [linear(each, laws, nodes, known) for each, known in zip(means, before, strict=True)]
    # the share of the box in the ranges is the share of what is possible
    width = np.where(ends[:, 1] > ends[:, 0], ends[:, 1] - ends[:, 0], 1.0)
    log_weight = log_volume - np.log(width).sum() - misfit / 2.0
    return Choice(laws, parameters, nodes, log_weight, fits)


def shares(choices: Sequence[Choice]) -> list[Reals]:
    """Return the weights of the nodes of all choices, which add up to 1."""
    whole = logsumexp(np.concatenate([choice.log_weight for choice in choices]))
    return [np.exp(choice.log_weight - whole) for choice in choices]


def _nodes(parameters: Sequence[Parameter], low: Reals, high: Reals, size: int) -> tuple[Reals, Reals, tuple[int, ...]]:
    """Return nodes of Gauss and Legendre in a box (node, parameter), the logarithm of their volume, and their shape."""
    points, weights = np.polynomial.legendre.leggauss(size)
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
        points = (1.0 + np.polynomial.legendre.leggauss(size)[0]) / 2.0
        grid = low[axis] + width[axis] * np.concatenate([[0.0], points, [1.0]])
        narrow[:, axis] = grid[found[0]], grid[found[-1] + 2]
        if found[0] == 0:
            wide[0, axis] = max(ends[axis, 0], low[axis] - 0.5 * width[axis])
        if found[-1] == size - 1:
            wide[1, axis] = min(ends[axis, 1], high[axis] + 0.5 * width[axis])
    cut = (wide != [low, high]).any()
    return tuple(wide) if cut else tuple(narrow)


def _columns(means: Means, laws: Laws, nodes: Reals, before: Before) -> Reals:
    """Return the columns (node, case, coefficient) of the linear fit, interactions in units of their likely scatter."""
    laws_of = {limit: _relative(means, laws, limit, nodes) for limit in means.levels}
    whole = np.ones((len(nodes), means.values.size))
    columns = []
    for limit, column in laws_of.items():
        if laws[limit].whole:  # kappa_tfc (1 + excess): no coefficient of its own
            whole = whole + column * _excess(laws, limit, np.array([means.reference[limit]]), nodes)
        else:
            columns.append(column)
    for (first, second), size in zip(means.pairs, before.scatter, strict=True):
        columns.append(size * laws_of[first] * laws_of[second])
    return np.stack([whole, *columns], axis=-1)


def _excess(laws: Laws, limit: str, eps: Reals, nodes: Reals) -> Reals:
    first = 0
    for name, law in laws.items():
        if name == limit:
            return law.excess(eps, nodes[:, first : first + len(law.parameters)])
        first += len(law.parameters)
    raise AssertionError(limit)


def _relative(means: Means, laws: Laws, limit: str, nodes: Reals) -> Reals:
    """Return a limit's law (node, case) over its value at the reference."""
    levels, case = np.unique(means.levels[limit], return_inverse=True)
    found = _excess(laws, limit, np.append(levels, means.reference[limit]), nodes)
    return np.asarray((found[:, :-1] / found[:, -1:])[:, case])


def _solved(means: Means, laws: Laws, nodes: Reals, before: Before) -> tuple[Reals, Reals, Reals]:
    """Return coefficients (node, coefficient), what solves for them (node, coefficient, row), residuals (node, row).

    Rows are the whitened cases, and then what is known of the interactions before.
    """
    rows, data = _equations(means, laws, nodes, before)
    orthogonal, upper = np.linalg.qr(rows)
    solving = np.linalg.solve(upper, np.swapaxes(orthogonal, 1, 2))
    coefficients = solving @ data
    return coefficients, solving, data - (rows @ coefficients[..., np.newaxis])[..., 0]


def _equations(means: Means, laws: Laws, nodes: Reals, before: Before) -> tuple[Reals, Reals]:
    """Return the left (node, row, coefficient) and right (row) side of what the coefficients have to meet."""
    columns = means.whitener @ _columns(means, laws, nodes, before)
    n_coefficients, n_pairs = columns.shape[-1], len(before.scatter)
    known = np.zeros((n_pairs, n_coefficients))
    known[:, n_coefficients - n_pairs :] = np.eye(n_pairs)
    rows = np.concatenate([columns, np.broadcast_to(known, (len(nodes), *known.shape))], axis=1)
    return rows, np.concatenate([means.whitener @ means.values, before.mean])


def _misfit(means: Means, laws: Laws, nodes: Reals, before: Before) -> Reals:
    """Return chi^2 (node): what is left of the right side in the corner of the triangular factor."""
    rows, data = _equations(means, laws, nodes, before)
    if rows.shape[1] <= rows.shape[2]:
        return np.zeros(len(nodes))
    both = np.concatenate([rows, np.broadcast_to(data[:, np.newaxis], (len(nodes), len(data), 1))], axis=2)
    triangular: Reals = np.linalg.qr(both, mode="r")  # type: ignore[assignment]
    return np.asarray(triangular[:, -1, -1] ** 2)


def _before(means: Means, laws: Laws) -> Before:
    """Return what is known before of the interactions, from the corrections taken one at a time."""
    parameters = [parameter for law in laws.values() for parameter in law.parameters]
    middle = np.concatenate([each.values(np.array([np.mean(each.ends)])) for each in parameters])[np.newaxis]
    own = {limit: Law(law.parameters, law.excess) for limit, law in laws.items()}
    additive = linear(means, own, middle, additive_only(means))
    corrections = dict(zip(means.levels, additive.coefficients[0, 1:], strict=False))
    found = []
    for pair in means.pairs:
        mean, scatter = _WANING.get(pair, _INTERACTION)
        size = min((corrections[limit] for limit in pair), key=abs)
        found.append((mean / scatter, scatter * size))
    return Before(*np.array(found).reshape(-1, 2).T)


def additive_only(means: Means) -> Before:
    """Return that all interactions are 0."""
    return Before(*np.zeros((2, len(means.pairs))))


def linear(means: Means, laws: Laws, nodes: Reals, before: Before) -> Linear:
    """Return the fits at nodes of the laws' parameters."""
    coefficients, solving, residual = _solved(means, laws, nodes, before)
    inverse = solving @ np.swapaxes(solving, 1, 2)
    n_cases = means.values.size
    influence = solving[:, 0, :n_cases] @ means.whitener
    pull = 2.0 * residual[:, :n_cases] @ means.whitener
    # from the columns' coefficients to kappa_tfc, corrections and interactions, in the unit of kappa
    limits = list(means.levels)
    change = np.zeros((len(nodes), 1 + len(limits) + len(means.pairs), coefficients.shape[1]))
    change[:, 0, 0] = 1.0
    exponents = np.empty((len(nodes), len(limits)))
    own = 1
    for row, limit in enumerate(limits, start=1):
        at = means.reference[limit]
        around = _excess(laws, limit, at * np.exp([-0.01, 0.0, 0.01]), nodes)
        exponents[:, row - 1] = np.log(around[:, 2] / around[:, 0]) / 0.02
        if laws[limit].whole:
            change[:, row, 0] = around[:, 1]
        else:
            change[:, row, own] = 1.0
            own += 1
    for pair, size in enumerate(before.scatter):
        change[:, 1 + len(limits) + pair, own + pair] = size
    return Linear(
        misfit=(residual**2).sum(axis=1),
        coefficients=np.einsum("nkl,nl->nk", change, coefficients),
        covariance=np.einsum("nkl,nlm,npm->nkp", change, inverse, change),
        influence=influence,
        pull=pull,
        exponents=exponents,
    )


def linear_influence(means: Means) -> tuple[Reals, int]:
    """Return the derivative of kappa_tfc to each mean (case) for linear laws, and how many contrasts have none."""
    laws = {limit: power(limit, dict.fromkeys(means.levels, (1.0, 1.0))) for limit in means.levels}
    nodes = np.ones((1, len(laws)))
    before = _before(means, laws)
    columns = _columns(means, laws, nodes, Before(*np.ones((2, len(means.pairs)))))[0]
    return linear(means, laws, nodes, before).influence[0], means.values.size - int(np.linalg.matrix_rank(columns))


def along(choice: Choice, index: int, means: Means, limit: str, eps: Reals) -> Reals:
    """Return the fits (node, level) of a group at levels of one limit, the others at the reference."""
    found = _excess(choice.laws, limit, np.append(eps, means.reference[limit]), choice.nodes)
    ratio = found[:, :-1] / found[:, -1:]
    row = 1 + list(means.levels).index(limit)
    coefficients = choice.fits[index].coefficients
    mine = [1 + len(means.levels) + pair for pair, both in enumerate(means.pairs) if limit in both]
    moving = coefficients[:, [row, *mine]].sum(axis=1, keepdims=True)
    return np.asarray(coefficients.sum(axis=1, keepdims=True) + moving * (ratio - 1.0))


def linearised(means: Means, choice: Choice) -> tuple[Reals, Reals, Reals, float]:
    """Return a choice of laws as a linear fit about its mean parameters, with kappa_tfc there.

    The columns (case, coefficient), their derivatives (case, parameter) to the positions of the parameters in their
    ranges, and what is known before of coefficients and parameters: one over the variance of each.
    """
    share = np.exp(choice.log_weight - logsumexp(choice.log_weight))
    at = np.array(
        [_position(parameter, node) for parameter, node in zip(choice.parameters, choice.nodes.T, strict=True)]
    )
    mean = at @ share
    before = _before(means, choice.laws)
    moving = [index for index, parameter in enumerate(choice.parameters) if parameter.low < parameter.high]
    step = 1e-3 * np.eye(len(mean))[moving]
    positions = np.vstack([mean, mean + step, mean - step])
    nodes = np.stack(
        [parameter.values(row) for parameter, row in zip(choice.parameters, positions.T, strict=True)], axis=-1
    )
    columns = _columns(means, choice.laws, nodes, before)
    coefficients = _solved(means, choice.laws, nodes[:1], before)[0][0]
    forward, backward = columns[1 : 1 + len(moving)], columns[1 + len(moving) :]
    slopes = ((forward - backward) @ coefficients).T / 2e-3
    widths = np.array([np.diff(choice.parameters[index].ends)[0] for index in moving])
    of_coefficients = np.zeros(len(coefficients))
    of_coefficients[len(coefficients) - len(means.pairs) :] = 1.0
    return columns[0], slopes, np.concatenate([of_coefficients, 12.0 / widths**2]), float(coefficients[0])


def _position(parameter: Parameter, values: Reals) -> Reals:
    return np.log(values) if parameter.logarithmic else values
