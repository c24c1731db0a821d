"""Steps of a load path along a branch of equilibria, divided until each jump between branches is located.

Let a step go from equilibrium 0 to equilibrium 1. With the load L, its conjugate force F, the sliding s, the mean
tangential traction T and the potential U (`energy_balance.py`), and the plastic work P of the step,

    W_i = F_i (L_1 - L_0) + T_i (s_1 - s_0)      work of the step if the forces of its end i acted throughout,
    loss = (W_0 + W_1) / 2 - (U_1 - U_0) - P     energy that jumps dissipate in the step.

On one branch with a monotonic force the work lies between W_0 and W_1. So the step holds a jump if

    min(W_0, W_1) - (U_1 - U_0) - P > 2e-3 A,

with the work of adhesion A of the surfaces. A step is halved until it holds no jump and |loss| is negligible, or until
the place of the jump no longer matters: |W_1 - W_0| / 2 <= 2e-3 |loss|. `follow` records loss + P of all parts.

Only paths under an attraction with truncated_newton are followed (`is_followed`). The loss of a step of any other path
is `EnergyBalance.dissipated`, or if the body creeps that of dashpots and friction, or under a hardness the plastic work
(`load_path.PathRecord`). The criterion does not use the smallest curvature of the energy, 0 at a fold: `stability` only
reports it.
"""

import warnings
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
import numpy.typing as npt
import scipy  # its modules load with their first use

from gfmd_numba.arrays import Reals
from gfmd_numba.contact import free_window, solution
from gfmd_numba.contact.energy_balance import EnergyBalance
from gfmd_numba.contact.evaluation import gap, plastic_work
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import NO_LOSS, Contact, Followed, State, with_costs
from gfmd_numba.fourier import grid
from gfmd_numba.interface import vector_slip
from gfmd_numba.interface.normal_law import NormalLaw
from gfmd_numba.solvers.status import Status

_VECTORS, _ITERATIONS, _TOLERANCE = 3, 60, 1e-5
_NEGLIGIBLE = 2e-3  # loss over the work of adhesion A
_HELD = 1e-2  # of the work of adhesion: a node with at least this gain is held by a law of gap and slip
_CURVED = 1e-2  # apparent loss over the work of the step, as the trapezium of the forces misses their curvature
_BENT = 0.05  # loss over |W_1 - W_0| that a bend of the force within the step may hide
_UNCERTAIN = 2e-3  # |W_1 - W_0| / 2 over the loss up to which the place of a jump is known well enough
_DIVISIONS = 12  # halvings of a step at most
_MOST_SOLUTIONS = 64  # in one step, which may hold a jump of each asperity


def smallest_curvature(gap: Reals, held: npt.NDArray[np.bool_], stiffness: Reals, law: NormalLaw) -> float:
    """Smallest second derivative of the energy over that of the body alone, of one contact `[(y,) x]`.

    1 where the law does nothing, 0 at a fold (jump-in or pull-off), below 0 where the equilibrium is unstable. Nodes
    that are `held` by the wall do not move. `stiffness` is K(q) `[(ny,) nx // 2 + 1]`; a mean that nothing restores
    counts as stiff as the softest wave. By Knyazev's method (SIAM J. Sci. Comput. 23:517, 2001).
    """
    shape, free = gap.shape, np.flatnonzero(~held)
    if len(free) == 0:
        return 1.0
    positive = np.where(stiffness > 0.0, stiffness, stiffness.ravel()[1:].min())
    curvature = law.stiffness(gap).ravel()[free]

    def filtered(symbol: Reals, x: Reals) -> Reals:
        whole = np.zeros((x.shape[1], *shape))
        whole.reshape(len(whole), -1)[:, free] = x.T
        filtered = grid.signal(symbol * grid.coefficients(whole, len(shape)), *shape)
        return filtered.reshape(len(whole), -1)[:, free].T

    def body(x: Reals) -> Reals:
        return filtered(positive, x)

    def energy(x: Reals) -> Reals:
        return filtered(stiffness, x) + curvature[:, np.newaxis] * x

    if len(free) < 5 * _VECTORS:  # too few for iterations
        every = np.eye(len(free))
        lower = np.linalg.inv(np.linalg.cholesky(body(every)))
        return float(np.linalg.eigvalsh(lower @ energy(every) @ lower.T)[0])
    guess = np.random.default_rng(0).normal(size=(len(free), _VECTORS))
    if curvature.any():  # about where the law softens most; a mode exactly would end the search for a lower one
        guess[:, 0] = np.abs(curvature) / np.abs(curvature).max() + 0.1 * guess[:, 0]
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # of the larger ones, which nobody needs
        values, _ = scipy.sparse.linalg.lobpcg(
            energy, guess, body, partial(filtered, 1.0 / positive), tol=_TOLERANCE, maxiter=_ITERATIONS, largest=False
        )
    return float(values.min())


@dataclass(frozen=True)
class _Point:
    problem: Problem
    contact: Contact
    after: State

    @cached_property
    def balance(self) -> EnergyBalance:
        """Energy and forces."""
        return EnergyBalance.of(self.problem, self.contact)

    @property
    def pressure(self) -> float:
        """Mean pressure."""
        return float(self.contact.equilibrium.pressure[0].mean())

    @property
    def adhesion(self) -> float:
        """Work of adhesion that the surfaces have gained: where they touch, or across the gap if they touch nowhere."""
        laws, found = self.problem.interface, self.contact.equilibrium
        if laws.normal_law is not None:
            touching = float(laws.normal_law.energy(np.zeros(1))[0])
            if not laws.hard_wall or touching > 0.0 or not found.touching.any():
                return float(-np.minimum(laws.normal_law.energy(gap(self.contact)), 0.0).mean())
            return -touching * float(found.touching.mean())
        assert laws.cohesive is not None  # as is_followed says
        assert found.tangential is not None
        apart, tangential = self.contact.punch - found.displacement, found.tangential
        slip = np.moveaxis(tangential.sliding - tangential.displacement, 1, 0)
        gained = -laws.cohesive.energy(apart, vector_slip.length(slip))
        return float(np.where(gained > _HELD * laws.cohesive.work, gained, 0.0).mean())

    def work(self, other: "_Point") -> tuple[float, float]:
        """Return W_0 and W_1 of the step to another point."""
        way, drag = other.balance.load - self.balance.load, other.balance.sliding - self.balance.sliding
        here, there = (each.force * way + float(each.traction @ drag) for each in (self.balance, other.balance))
        return here, there


def stability(problem: Problem, contact: Contact) -> float | None:
    """Smallest curvature of the energy over that of the bodies alone, not-a-number unless in equilibrium.

    Touching nodes do not move, nor do plastic ones, as when the punch is drawn off. It may take as long as the
    equilibrium itself. None under a law of gap and slip, for which it is not built yet.
    """
    law, found = problem.interface.normal_law, contact.equilibrium
    if law is None:
        return None
    if found.status[0] != Status.ok:
        return float("nan")
    apart, touching, ends, shape = gap(contact), found.touching, problem.ends, contact.punch.shape[1:]
    if not any(ends):
        stiffness = solution.condensed_stiffness(problem, grid.magnitudes(shape))
    else:  # the law acts in the window alone
        stiffness = solution.response_of(problem).normal.copy()
        apart = free_window.in_corner(apart, np.full((1,) * apart.ndim, free_window.reach(law)), ends)
        touching = free_window.in_corner(touching, np.zeros((1,) * apart.ndim, dtype=np.bool_), ends)
    if problem.mean_pressure is not None or not np.isfinite(stiffness.flat[0]):
        stiffness.flat[0] = 0.0  # a rigid mean stores no energy
    return smallest_curvature(apart[0], touching[0], stiffness, law)


def is_followed(problem: Problem) -> bool:
    """Whether the steps of a path are divided: where a law attracts and the solver keeps to a branch."""
    return problem.interface.softening > 0.0 and problem.numerics.solver == "truncated_newton"


def follow(problem: Problem, state: State) -> Contact:
    """Equilibrium of a problem, reached from a state, with what happened on the way."""
    if state.last is None or state.last.step is None:
        first = solution.solve(problem, state)
        plastic, pressure = float(plastic_work(first)[0]), float(first.equilibrium.pressure[0].mean())
        return replace(
            first, followed=replace(NO_LOSS, dissipated=plastic, plastic_work=plastic, least_pressure=pressure)
        )
    spent: list[_Point] = []
    start = _Point(problem.under(state.last.step), state.last, state)
    point, steps = _advance(start, problem, _DIVISIONS, 0.0, spent)
    jumps = [step for step in steps if not np.isnan(step.jump_at)]
    largest = max(jumps, key=lambda step: step.dissipated, default=NO_LOSS)
    equilibrium = with_costs(point.contact.equilibrium, (each.contact.equilibrium for each in spent))
    least = min(each.pressure for each in spent)
    dissipated, plastic = (sum(getattr(step, name) for step in steps) for name in ("dissipated", "plastic_work"))
    followed = Followed(dissipated, largest.jump_at, least, largest.jump_sliding, plastic)
    return replace(point.contact, equilibrium=equilibrium, followed=followed)


def _advance(
    start: _Point, problem: Problem, divisions: int, curved: float, spent: list[_Point]
) -> tuple[_Point, list[Followed]]:
    """Go from a point to a problem in one step, or in two if it loses energy; up to `curved` the loss is apparent."""
    contact = solution.solve(problem, start.after)
    end = _Point(problem, contact, contact.after)
    spent.append(end)
    plastic = float(plastic_work(contact)[0])  # dissipated, jump or not
    gained = end.balance.potential - start.balance.potential + plastic
    least, most = sorted(start.work(end))  # of a branch of monotonic force: the work between them
    loss = 0.5 * (least + most) - gained
    if divisions == _DIVISIONS:
        curved = _CURVED * 0.5 * max(abs(least + most), most - least)
    negligible = _NEGLIGIBLE * max(start.adhesion, end.adhesion)
    jumps = least - gained > (negligible or np.inf)
    hidden = _BENT * (most - least) * 0.5 ** (_DIVISIONS - divisions)  # which has the same limit at every level
    is_known = max(abs(loss), hidden) <= max(negligible, curved)
    if contact.equilibrium.status[0] != Status.ok or (is_known and not jumps):
        return end, [Followed(loss + plastic, np.nan, plastic_work=plastic)]
    halfway = start.problem.step.towards(problem.step, 0.5)
    is_located = 0.5 * (most - least) <= _UNCERTAIN * abs(loss)
    if is_located or divisions == 0 or len(spent) >= _MOST_SOLUTIONS:
        found = Followed(loss + plastic, np.nan, plastic_work=plastic)
        return end, [replace(found, jump_at=halfway.load, jump_sliding=halfway.sliding[0]) if jumps else found]
    middle, first = _advance(start, problem.under(halfway), divisions - 1, 0.5 * curved, spent)
    rest = replace(problem, duration=problem.duration - halfway.duration)
    end, second = _advance(middle, rest, divisions - 1, 0.5 * curved, spent)
    return end, first + second
