"""The fit of thesis (4.3), with interactions, where the laws of the limits are known: it is linear.

Its coefficients are the TFC limit, a correction for each limit, and an interaction for each pair of limits, by which
their corrections taken together differ from their sum. Interactions are products of the two laws. Nothing but cross
levels, where two discretisations differ from the reference at once, tells them. What is known before is that they are
of the size of the smaller correction, and that the correction in eps_t wanes with eps_f: it comes from the few longest
waves, whose part in the slope falls.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from gfmd_numba.analysis.laws import Law, power
from gfmd_numba.arrays import Reals

Laws = dict[str, Law]
# What is known before any cross level says more, measured from H = 0.3 to 1. An interaction is 0 within half of the
# smaller of its two corrections. The correction in eps_t is all interaction with eps_f, within half of itself; that of
# kappa falls with a power of the correction in eps_f, by the dimension of the surfaces: 1.3 (H = 1) to 2 on half-spaces
# and a slab with a thickness of 0.1 periods (1/eps_f = 16 to 16384, 1/eps_t = 2, 4 and 8), and 3 to 5 on maps.
_SCATTER = 0.5
_WANING = ("eps_t", "eps_f")
POWER_OF_WANING = {1: 1.75, 2: 3.5}


@dataclass(frozen=True)
class Means:
    """The means of a group's cases: `whitener` makes their errors independent and of unit variance."""

    values: Reals
    whitener: Reals
    levels: dict[str, Reals]  # (case) of the limits that are varied
    reference: dict[str, float]
    waning: float = 1.0  # power of the law of eps_f with which the correction in eps_t falls

    @property
    def pairs(self) -> list[tuple[str, str]]:
        """Pairs of the limits that are varied."""
        return list(combinations(self.levels, 2))

    def power_in_pair(self, limit: str, pair: tuple[str, str]) -> float:
        """Return the power of the law of a limit in the interaction of a pair."""
        return self.waning if set(pair) == set(_WANING) and limit == _WANING[1] else 1.0

    def of_pairs(self, limit: str, ratios: Reals, coefficients: Reals) -> Reals:
        """Return the interactions of a limit (node, level) where its law is `ratios` times that at the reference."""
        found = np.zeros(np.broadcast_shapes(ratios.shape, (len(coefficients), 1)))
        for column, pair in enumerate(self.pairs, start=1 + len(self.levels)):
            if limit in pair:
                found += coefficients[:, [column]] * ratios ** self.power_in_pair(limit, pair)
        return found


@dataclass(frozen=True)
class Before:
    """What is known before of coefficients: they are 0 within these standard deviations, infinite for free ones."""

    own: Reals  # (limit)
    pair: Reals  # (pair)


@dataclass(frozen=True)
class Linear:
    """The linear fits of one group (node, ...) at the nodes of a quadrature.

    The coefficients are the TFC limit, the correction of each limit at the reference and the interaction of each pair.
    """

    misfit: Reals  # chi^2 (node)
    coefficients: Reals  # (node, coefficient)
    covariance: Reals  # (node, coefficient, coefficient)
    influence: Reals  # of each mean on the TFC limit (node, case)
    pull: Reals  # derivative of chi^2 to each mean (node, case)
    exponents: Reals  # of each limit's law at the reference (node, limit)


def linear(means: Means, laws: Laws, nodes: Reals, before: Before) -> Linear:
    """Return the fits at nodes of the laws' parameters (node, parameter)."""
    coefficients, solving, residual = solved(means, laws, nodes, before)
    inverse = solving @ np.swapaxes(solving, 1, 2)
    n_cases = means.values.size
    # from the columns' coefficients to the TFC limit, corrections and interactions, in the unit of the variable
    limits = list(means.levels)
    change = np.zeros((len(nodes), 1 + len(limits) + len(means.pairs), coefficients.shape[1]))
    change[:, 0, 0] = 1.0
    exponents = np.empty((len(nodes), len(limits)))
    own = 1
    for row, (limit, scatter) in enumerate(zip(limits, before.own, strict=True), start=1):
        at = means.reference[limit]
        around = excess(laws, limit, at * np.exp([-0.01, 0.0, 0.01]), nodes)
        exponents[:, row - 1] = np.log(around[:, 2] / around[:, 0]) / 0.02
        if laws[limit].whole:
            change[:, row, 0] = around[:, 1]
        else:
            change[:, row, own] = _unit(scatter)
            own += 1
    for pair, scatter in enumerate(before.pair):
        change[:, 1 + len(limits) + pair, own + pair] = _unit(scatter)
    return Linear(
        misfit=(residual**2).sum(axis=1),
        coefficients=np.einsum("nkl,nl->nk", change, coefficients),
        covariance=np.einsum("nkl,nlm,npm->nkp", change, inverse, change),
        influence=solving[:, 0, :n_cases] @ means.whitener,
        pull=2.0 * residual[:, :n_cases] @ means.whitener,
        exponents=exponents,
    )


def misfit(means: Means, laws: Laws, nodes: Reals, before: Before) -> Reals:
    """Return chi^2 (node): what is left of the right side in the corner of the triangular factor."""
    rows, data = _equations(means, laws, nodes, before)
    if rows.shape[1] <= rows.shape[2]:
        return np.zeros(len(nodes))
    both = np.concatenate([rows, np.broadcast_to(data[:, np.newaxis], (len(nodes), len(data), 1))], axis=2)
    triangular: Reals = np.linalg.qr(both, mode="r")  # type: ignore[assignment]
    return np.asarray(triangular[:, -1, -1] ** 2)


def misfit_form(means: Means, laws: Laws, node: Reals, before: Before) -> Reals:
    """Return the matrix (case, case) that gives chi^2 of the means alone from them, at one node (parameter)."""
    rows, _ = _equations(means, laws, node[np.newaxis], before)
    orthogonal = np.linalg.qr(rows[0])[0][: means.values.size]
    left = np.eye(means.values.size) - orthogonal @ orthogonal.T
    return np.asarray(means.whitener.T @ left @ left @ means.whitener)


def solved(means: Means, laws: Laws, nodes: Reals, before: Before) -> tuple[Reals, Reals, Reals]:
    """Return coefficients (node, coefficient), what solves for them (node, coefficient, row), residuals (node, row).

    Rows are the whitened cases, and then what is known before.
    """
    rows, data = _equations(means, laws, nodes, before)
    orthogonal, upper = np.linalg.qr(rows)
    solving = np.linalg.solve(upper, np.swapaxes(orthogonal, 1, 2))
    coefficients = solving @ data
    return coefficients, solving, data - (rows @ coefficients[..., np.newaxis])[..., 0]


def _equations(means: Means, laws: Laws, nodes: Reals, before: Before) -> tuple[Reals, Reals]:
    """Return the left (node, row, coefficient) and right (row) side of what the coefficients have to meet."""
    whitened = means.whitener @ columns(means, laws, nodes, before)
    known = np.eye(whitened.shape[-1])[np.flatnonzero(certainty(means, laws, before))]
    rows = np.concatenate([whitened, np.broadcast_to(known, (len(nodes), *known.shape))], axis=1)
    return rows, np.concatenate([means.whitener @ means.values, np.zeros(len(known))])


def columns(means: Means, laws: Laws, nodes: Reals, before: Before) -> Reals:
    """Return the columns (node, case, coefficient) of the fit, those known before in units of their scatter."""
    laws_of = {limit: _relative(means, laws, limit, nodes) for limit in means.levels}
    whole = np.ones((len(nodes), means.values.size))
    found = []
    for (limit, column), scatter in zip(laws_of.items(), before.own, strict=True):
        if laws[limit].whole:  # the TFC limit times (1 + excess): no coefficient of its own
            whole = whole + column * excess(laws, limit, np.array([means.reference[limit]]), nodes)
        else:
            found.append(_unit(scatter) * column)
    for (first, second), scatter in zip(means.pairs, before.pair, strict=True):
        pair = (first, second)
        of_first, of_second = (laws_of[limit] ** means.power_in_pair(limit, pair) for limit in pair)
        found.append(_unit(scatter) * of_first * of_second)
    return np.stack([whole, *found], axis=-1)


def certainty(means: Means, laws: Laws, before: Before) -> Reals:
    """Return one over the variance (coefficient) of each coefficient before, in the units of `columns`: 1 or 0."""
    own = [scatter for limit, scatter in zip(means.levels, before.own, strict=True) if not laws[limit].whole]
    return np.isfinite([np.inf, *own, *before.pair]).astype(np.float64)


def _unit(scatter: float) -> float:
    return scatter if np.isfinite(scatter) else 1.0


def excess(laws: Laws, limit: str, eps: Reals, nodes: Reals) -> Reals:
    """Return a limit's law (node, level) at parameters of all laws (node, parameter)."""
    first = 0
    for name, law in laws.items():
        if name == limit:
            return law.excess(eps, nodes[:, first : first + len(law.parameters)])
        first += len(law.parameters)
    raise AssertionError(limit)


def _relative(means: Means, laws: Laws, limit: str, nodes: Reals) -> Reals:
    """Return a limit's law (node, case) over its value at the reference."""
    levels, case = np.unique(means.levels[limit], return_inverse=True)
    found = excess(laws, limit, np.append(levels, means.reference[limit]), nodes)
    return np.asarray((found[:, :-1] / found[:, -1:])[:, case])


def known_before(means: Means, laws: Laws) -> Before:
    """Return what is known before, from the corrections taken one at a time."""
    parameters = [parameter for law in laws.values() for parameter in law.parameters]
    middle = np.array([[each.middle for each in parameters]])
    powers = {limit: Law(law.parameters, law.excess) for limit, law in laws.items()}
    additive = linear(means, powers, middle, additive_only(means))
    corrections = dict(zip(means.levels, abs(additive.coefficients[0, 1:]), strict=False))
    waning, by = _WANING
    wanes = {waning, by} <= set(means.levels)
    own = [_SCATTER * corrections[limit] if wanes and limit == waning else np.inf for limit in means.levels]
    pair = [
        np.inf if wanes and set(both) == set(_WANING) else _SCATTER * min(corrections[limit] for limit in both)
        for both in means.pairs
    ]
    return Before(np.array(own), np.array(pair))


def additive_only(means: Means) -> Before:
    """Return that all interactions are 0."""
    return Before(np.full(len(means.levels), np.inf), np.zeros(len(means.pairs)))


def as_if_exact(before: Before) -> Before:
    """Return that coefficients of which anything is known are 0."""
    return Before(*(np.where(np.isfinite(scatter), 0.0, np.inf) for scatter in (before.own, before.pair)))


def linear_influence(means: Means) -> tuple[Reals, int]:
    """Return the derivative of the TFC limit to each mean (case) for linear laws, and how many contrasts have none."""
    laws = {limit: power(limit, dict.fromkeys(means.levels, (1.0, 1.0))) for limit in means.levels}
    nodes = np.ones((1, len(laws)))
    free = Before(np.full(len(means.levels), np.inf), np.full(len(means.pairs), np.inf))
    rank = int(np.linalg.matrix_rank(columns(means, laws, nodes, free)[0]))
    return linear(means, laws, nodes, known_before(means, laws)).influence[0], means.values.size - rank
