"""Posterior of the TFC limit over the parameters of the laws: linear fits at the nodes of a quadrature, and weights.

At given parameters of the laws, the fit of thesis (4.3) with interactions is linear. Its coefficients are the TFC
limit, a correction for each limit, and an interaction for each pair of limits: the difference between two corrections
together and their sum. The law of an interaction is the product of the laws of its two limits. Only cross levels, where
two discretisations differ from the reference at once, measure it. Without cross levels a prior stands for it: an
interaction is of the size of the smaller of its two corrections, and the correction in eps_t decreases with eps_f,
because the few longest waves, which cause it, then have a smaller part in the slope. We integrate over the parameters
of the laws by quadrature, on a box that is narrowed to their likely values.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
import scipy  # its modules load with their first use

from gfmd_numba.analysis.laws import Law, Parameter, gauss, power
from gfmd_numba.arrays import Flags, Reals

Laws = dict[str, Law]
# The prior of the interactions, measured from H = 0.3 to 1. An interaction is 0 within half of the smaller of its two
# corrections. The correction in eps_t is all interaction with eps_f, within half of itself. For kappa it falls with a
# power of the correction in eps_f, by the dimension of the surfaces: 1.3 (H = 1) to 2 on half-spaces and a slab with a
# thickness of 0.1 periods (1/eps_f = 16 to 16384, 1/eps_t = 2, 4 and 8), and 3 to 5 on maps.
_SCATTER = 0.5
_FALLING_PAIR = ("eps_t", "eps_f")
INTERACTION_POWER = {1: 1.75, 2: 3.5}


@dataclass(frozen=True)
class Means:
    """The means of a group's cases: `whitener` makes their errors independent and of unit variance."""

    values: Reals
    whitener: Reals
    levels: dict[str, Reals]  # (case) of the limits that are varied
    reference: dict[str, float]
    interaction_power: float = 1.0  # power of the law of eps_f with which the correction in eps_t falls
    scatter: Reals | None = None  # (case, case) of the means, by which the whitener is judged; None if they have none

    @property
    def pairs(self) -> list[tuple[str, str]]:
        """Pairs of the limits that are varied."""
        return list(combinations(self.levels, 2))

    def finest(self, limit: str) -> float:
        """Return the finest level of a limit that has results: a reference that failed bridges no distance."""
        return float(self.levels[limit].min())

    def power_in_pair(self, limit: str, pair: tuple[str, str]) -> float:
        """Return the power of the law of a limit in the interaction of a pair."""
        return self.interaction_power if set(pair) == set(_FALLING_PAIR) and limit == _FALLING_PAIR[1] else 1.0

    def of_pairs(self, limit: str, ratios: Reals, coefficients: Reals) -> Reals:
        """Return the interactions of a limit (node, level) where its law is `ratios` times that at the reference."""
        found = np.zeros(np.broadcast_shapes(ratios.shape, (len(coefficients), 1)))
        for column, pair in enumerate(self.pairs, start=1 + len(self.levels)):
            if limit in pair:
                found += coefficients[:, [column]] * ratios ** self.power_in_pair(limit, pair)
        return found


@dataclass(frozen=True)
class Linear:
    """The linear fits of one group (node, ...) at the nodes of a quadrature.

    The coefficients are the TFC limit, the correction of each limit at the reference and the interaction of each pair.
    """

    misfit: Reals  # chi^2 (node)
    coefficients: Reals  # (node, coefficient)
    covariance: Reals  # (node, coefficient, coefficient)
    influence: Reals  # of each mean on the TFC limit (node, case)
    misfit_gradient: Reals  # derivative of chi^2 to each mean (node, case)
    exponents: Reals  # of each limit's law at the reference (node, limit)


def linear(means: Means, laws: Laws, nodes: Reals, prior_std: Reals) -> Linear:
    """Return the fits at nodes of the laws' parameters (node, parameter).

    `prior_std` are the standard deviations of the priors around 0: of the corrections of the limits, then of the
    interactions of the pairs. Infinite ones are free.
    """
    coefficients, solving, residual = solved(means, laws, nodes, prior_std)
    inverse = solving @ np.swapaxes(solving, 1, 2)
    n_cases = means.values.size
    # from the columns' coefficients to the TFC limit, corrections and interactions, in the unit of the variable
    limits = list(means.levels)
    change = np.zeros((len(nodes), 1 + len(prior_std), coefficients.shape[1]))
    counted = _counted(means, laws)
    change[:, counted, np.arange(coefficients.shape[1])] = np.append(1.0, _units(prior_std))[counted]
    exponents = np.empty((len(nodes), len(limits)))
    for row, limit in enumerate(limits, start=1):
        at = means.reference[limit]
        around = law_value(laws, limit, at * np.exp([-0.01, 0.0, 0.01]), nodes)
        exponents[:, row - 1] = np.log(around[:, 2] / around[:, 0]) / 0.02
        if laws[limit].scales_limit:
            change[:, row, 0] = around[:, 1]
    return Linear(
        misfit=(residual**2).sum(axis=1),
        coefficients=np.einsum("nkl,nl->nk", change, coefficients),
        covariance=np.einsum("nkl,nlm,npm->nkp", change, inverse, change),
        influence=solving[:, 0, :n_cases] @ means.whitener,
        misfit_gradient=2.0 * residual[:, :n_cases] @ means.whitener,
        exponents=exponents,
    )


def misfit(means: Means, laws: Laws, nodes: Reals, prior_std: Reals) -> Reals:
    """Return chi^2 (node), the squared corner of the triangular factor of the equations with their right side."""
    rows, data = _equations(means, laws, nodes, prior_std)
    if rows.shape[1] <= rows.shape[2]:
        return np.zeros(len(nodes))
    both = np.concatenate([rows, np.broadcast_to(data[:, np.newaxis], (len(nodes), len(data), 1))], axis=2)
    triangular: Reals = np.linalg.qr(both, mode="r")  # type: ignore[assignment]
    return np.asarray(triangular[:, -1, -1] ** 2)


def misfit_form(means: Means, laws: Laws, node: Reals, prior_std: Reals) -> Reals:
    """Return the matrix (case, case) that gives chi^2 of the means alone from them, at one node (parameter)."""
    rows, _ = _equations(means, laws, node[np.newaxis], prior_std)
    orthogonal = np.linalg.qr(rows[0])[0][: means.values.size]
    left = np.eye(means.values.size) - orthogonal @ orthogonal.T
    return np.asarray(means.whitener.T @ left @ left @ means.whitener)


def solved(means: Means, laws: Laws, nodes: Reals, prior_std: Reals) -> tuple[Reals, Reals, Reals]:
    """Return coefficients (node, coefficient), what solves for them (node, coefficient, row), residuals (node, row).

    Rows are the whitened cases, and then the priors.
    """
    rows, data = _equations(means, laws, nodes, prior_std)
    orthogonal, upper = np.linalg.qr(rows)
    solving = np.linalg.solve(upper, np.swapaxes(orthogonal, 1, 2))
    coefficients = solving @ data
    return coefficients, solving, data - (rows @ coefficients[..., np.newaxis])[..., 0]


def _equations(means: Means, laws: Laws, nodes: Reals, prior_std: Reals) -> tuple[Reals, Reals]:
    """Return the left (node, row, coefficient) and right (row) side of the equations for the coefficients."""
    whitened = means.whitener @ columns(means, laws, nodes, prior_std)
    prior = np.eye(whitened.shape[-1])[np.flatnonzero(prior_precision(means, laws, prior_std))]
    rows = np.concatenate([whitened, np.broadcast_to(prior, (len(nodes), *prior.shape))], axis=1)
    return rows, np.concatenate([means.whitener @ means.values, np.zeros(len(prior))])


def columns(means: Means, laws: Laws, nodes: Reals, prior_std: Reals) -> Reals:
    """Return the columns (node, case, coefficient) of the fit, those with a prior in units of its deviation."""
    laws_of, at_reference = {}, {}  # over their values at the reference
    for limit, of_cases in means.levels.items():
        levels, case = np.unique(of_cases, return_inverse=True)
        at = law_value(laws, limit, np.append(levels, means.reference[limit]), nodes)
        at_reference[limit] = at[:, -1:]
        laws_of[limit] = np.asarray((at[:, :-1] / at[:, -1:])[:, case])
    whole = np.ones((len(nodes), means.values.size))
    found, units = [], iter(_units(prior_std))
    for (limit, column), unit in zip(laws_of.items(), units, strict=False):
        if laws[limit].scales_limit:  # the TFC limit times (1 + value): no coefficient of its own
            whole = whole + column * at_reference[limit]
        else:
            found.append(unit * column)
    for pair, unit in zip(means.pairs, units, strict=True):
        of_first, of_second = (laws_of[limit] ** means.power_in_pair(limit, pair) for limit in pair)
        found.append(unit * of_first * of_second)
    return np.stack([whole, *found], axis=-1)


def prior_precision(means: Means, laws: Laws, prior_std: Reals) -> Reals:
    """Return one over the prior variance (coefficient) of each coefficient, in the units of `columns`: 1 or 0."""
    return np.asarray(np.isfinite(np.append(np.inf, prior_std))[_counted(means, laws)], dtype=np.float64)


def _counted(means: Means, laws: Laws) -> Flags:
    """Return which of the TFC limit, corrections and interactions have a coefficient: all but those of whole laws."""
    return np.array([True, *(not laws[limit].scales_limit for limit in means.levels), *[True] * len(means.pairs)])


def _units(prior_std: Reals) -> Reals:
    return np.where(np.isfinite(prior_std), prior_std, 1.0)


def law_value(laws: Laws, limit: str, eps: Reals, nodes: Reals) -> Reals:
    """Return a limit's law (node, level) at parameters of all laws (node, parameter)."""
    first = 0
    for name, law in laws.items():
        if name == limit:
            return law.value(eps, nodes[:, first : first + len(law.parameters)])
        first += len(law.parameters)
    raise AssertionError(limit)


def prior_deviations(means: Means, laws: Laws) -> Reals:
    """Return the `prior_std` of `linear`, from the corrections taken one at a time."""
    parameters = [parameter for law in laws.values() for parameter in law.parameters]
    middle = np.array([[each.middle for each in parameters]])
    powers = {limit: Law(law.parameters, law.value) for limit, law in laws.items()}
    without_interactions = [np.inf] * len(means.levels) + [0.0] * len(means.pairs)
    additive = linear(means, powers, middle, np.array(without_interactions))
    corrections = dict(zip(means.levels, abs(additive.coefficients[0, 1:]), strict=False))
    falls = set(_FALLING_PAIR) <= set(means.levels)
    own = [_SCATTER * corrections[limit] if falls and limit == _FALLING_PAIR[0] else np.inf for limit in means.levels]
    pair = [
        np.inf if falls and set(both) == set(_FALLING_PAIR) else _SCATTER * min(corrections[limit] for limit in both)
        for both in means.pairs
    ]
    return np.array(own + pair)


def linear_influence(means: Means) -> tuple[Reals, int]:
    """Return the derivative of the TFC limit to each mean (case) for linear laws, and how many contrasts have none."""
    laws = {limit: power(limit, dict.fromkeys(means.levels, (1.0, 1.0))) for limit in means.levels}
    nodes = np.ones((1, len(laws)))
    free = np.full(len(means.levels) + len(means.pairs), np.inf)
    rank = int(np.linalg.matrix_rank(columns(means, laws, nodes, free)[0]))
    return linear(means, laws, nodes, prior_deviations(means, laws)).influence[0], means.values.size - rank


_COARSE = 7  # points in each parameter, while the box is narrowed
_FINE = {1: 25, 2: 21, 3: 15}  # and in the end, by the number of parameters: spacings of a standard deviation
_FINE_OF_MORE = 9
_UNLIKELY = 25.0  # chi^2 above the least one, beyond which parameters do not count: 5 standard deviations
_ROUNDS = 60
_NEGLIGIBLE = 1e-9  # of the weight of all nodes: the lightest that weigh less together are left out


@dataclass(frozen=True)
class ChoiceOfLaws:
    """One choice of laws: nodes in their parameters, the logarithms of the nodes' weights, and each group's fits."""

    laws: Laws
    parameters: tuple[Parameter, ...]
    nodes: Reals  # values of the parameters (node, parameter)
    log_weight: Reals
    means: Sequence[Means]
    prior_std: Sequence[Reals]  # of each group, as `linear` takes it

    @cached_property
    def fits(self) -> list[Linear]:
        """Fits of each group at all nodes, made with their first use: a plan asks for the weights alone."""
        pairs = zip(self.means, self.prior_std, strict=True)
        return [linear(means, self.laws, self.nodes, prior_std) for means, prior_std in pairs]


def weighed(means: Sequence[Means], laws: Laws) -> ChoiceOfLaws:
    """Return the fits of groups that share their laws' parameters, at nodes weighed by how well they fit."""
    parameters = tuple(parameter for law in laws.values() for parameter in law.parameters)
    prior_std = [prior_deviations(each, laws) for each in means]
    ends = np.array([parameter.ends for parameter in parameters])
    low, high = ends.T.copy()
    fine = _FINE.get(int((low < high).sum()), _FINE_OF_MORE)
    points = _COARSE
    for _ in range(_ROUNDS):
        nodes, log_volume, shape = _nodes(parameters, low, high, points)
        # before there are data
        of_each = zip(parameters, nodes.T, strict=True)
        log_density = sum((each.log_density(each.positions(values)) for each, values in of_each), np.zeros(len(nodes)))
        of_groups = (misfit(each, laws, nodes, prior) for each, prior in zip(means, prior_std, strict=True))
        chi2 = sum(of_groups, start=-2.0 * log_density)
        new_low, new_high = _narrowed(chi2.reshape(shape), low, high, ends)
        settled = (new_high - new_low >= 0.7 * (high - low)) & (new_low >= low - 1e-15) & (new_high <= high + 1e-15)
        if settled.all() and points == fine:
            break
        points = fine if settled.all() else points
        low, high = new_low, new_high
    log_weight = log_volume - chi2 / 2.0
    order = np.argsort(log_weight)
    weight = np.exp(log_weight[order] - log_weight[order[-1]]).cumsum()
    counts = np.sort(order[weight >= _NEGLIGIBLE * weight[-1]])
    return ChoiceOfLaws(laws, parameters, nodes[counts], log_weight[counts], means, prior_std)


def posterior_weights(choices: Sequence[ChoiceOfLaws]) -> list[Reals]:
    """Return the weights of the nodes of all choices, which add up to 1."""
    whole = scipy.special.logsumexp(np.concatenate([choice.log_weight for choice in choices]))
    return [np.exp(choice.log_weight - whole) for choice in choices]


def _nodes(parameters: Sequence[Parameter], low: Reals, high: Reals, size: int) -> tuple[Reals, Reals, tuple[int, ...]]:
    """Return nodes of Gauss and Legendre in a box (node, parameter), the logarithm of their volume, and their shape."""
    points, weights = gauss(size)
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
        points = (1.0 + gauss(size)[0]) / 2.0
        grid = low[axis] + width[axis] * np.concatenate([[0.0], points, [1.0]])
        narrow[:, axis] = grid[found[0]], grid[found[-1] + 2]
        if found[0] == 0:
            wide[0, axis] = max(ends[axis, 0], low[axis] - 0.5 * width[axis])
        if found[-1] == size - 1:
            wide[1, axis] = min(ends[axis, 1], high[axis] + 0.5 * width[axis])
    cut = (wide != [low, high]).any()
    return tuple(wide) if cut else tuple(narrow)


def along(choice: ChoiceOfLaws, index: int, means: Means, limit: str, eps: Reals) -> Reals:
    """Return the fits (node, level) of a group at levels of one limit, the others at the reference."""
    found = law_value(choice.laws, limit, np.append(eps, means.reference[limit]), choice.nodes)
    ratio = found[:, :-1] / found[:, -1:]
    row = 1 + list(means.levels).index(limit)
    coefficients = choice.fits[index].coefficients
    there, here = (
        coefficients[:, [row]] * each + means.of_pairs(limit, each, coefficients) for each in (ratio, np.ones((1, 1)))
    )
    return np.asarray(coefficients.sum(axis=1, keepdims=True) + there - here)


def linearised(means: Means, choice: ChoiceOfLaws) -> tuple[Reals, Reals, Reals, float]:
    """Return a choice of laws as a linear fit about its mean parameters, with the TFC limit there.

    The columns (case, coefficient), their derivatives (case, parameter) to the positions of the parameters in their
    ranges, and the prior precision of coefficients and parameters: one over the variance of each.
    """
    weight = np.exp(choice.log_weight - scipy.special.logsumexp(choice.log_weight))
    at = np.array(
        [parameter.positions(node) for parameter, node in zip(choice.parameters, choice.nodes.T, strict=True)]
    )
    mean = at @ weight
    prior_std = prior_deviations(means, choice.laws)
    moving = [index for index, parameter in enumerate(choice.parameters) if parameter.low < parameter.high]
    step = 1e-3 * np.eye(len(mean))[moving]
    positions = np.vstack([mean, mean + step, mean - step])
    nodes = np.stack(
        [parameter.values(row) for parameter, row in zip(choice.parameters, positions.T, strict=True)], axis=-1
    )
    at_nodes = columns(means, choice.laws, nodes, prior_std)
    coefficients = solved(means, choice.laws, nodes[:1], prior_std)[0][0]
    forward, backward = at_nodes[1 : 1 + len(moving)], at_nodes[1 + len(moving) :]
    slopes = ((forward - backward) @ coefficients).T / 2e-3
    variances = np.array([choice.parameters[index].variance for index in moving])
    precision = np.concatenate([prior_precision(means, choice.laws, prior_std), 1.0 / variances])
    return at_nodes[0], slopes, precision, float(coefficients[0])
