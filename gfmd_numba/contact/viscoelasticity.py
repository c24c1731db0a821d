"""The memory of a viscoelastic body, stretch and traction of its springs, and the process that changes them.

The body is linear, and its Poisson's ratio is constant, so that all waves relax alike. So the memory of a node holds
the past of that node alone, whatever the stiffness is as a function of the wave number. A step in time is an elastic
contact of a stiffer body whose surface has moved on its own (`Relaxation.change`).
"""

from dataclasses import dataclass
from math import isfinite
from typing import ClassVar

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.contact.energy_balance import FrictionalWork
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import Contact, LoadStep, State, StepModification
from gfmd_numba.elasticity.prony import PronySeries
from gfmd_numba.fourier import grid


@dataclass(frozen=True)
class Springs:
    """The springs of a body: the relaxed one first, then that of each branch (g L_x, g E*).

    `stretch` and `traction` are `[spring, realisation, component, (y,) x]`, the normal component last and out of the
    body. The stretch of the relaxed spring is the displacement. `dissipated` is the energy per nominal area that
    dashpots and friction have dissipated so far `[realisation]` (g^2 E* L_x). `largest` are the largest sums over the
    nodes, in any step so far, of |traction of all springs| and of |displacement|.
    """

    stretch: Reals
    traction: Reals
    dissipated: Reals
    largest: tuple[float, float] = (0.0, 0.0)

    def energy(self, periodic: bool) -> Reals:
        """Energy per nominal area in all springs `[realisation]`; of periodic bodies that of all waves but the mean."""
        stretch, along = self.stretch, tuple(range(3, self.stretch.ndim))
        if periodic:
            stretch = stretch - stretch.mean(axis=along, keepdims=True)
        return np.asarray(0.5 * (self.traction * stretch).mean(axis=along).sum(axis=(0, 2)))


@dataclass(frozen=True)
class Relaxation:
    """Branches of a Prony series in parallel with the relaxed bodies, exact for displacements linear in time."""

    problem: Problem
    name: ClassVar[str] = "springs"

    def begin(self, shape: tuple[int, ...]) -> Springs:
        """Nothing is stretched."""
        assert self.problem.relaxation is not None
        components = len(shape) if self.problem.interface.couples else 1
        nothing = np.zeros((1 + len(self.problem.relaxation.moduli), shape[0], components, *shape[1:]))
        return Springs(nothing, nothing, np.zeros(shape[0]))

    def change(self, state: State, step: LoadStep) -> StepModification:
        """The bodies are stiffer, and their surface has moved to where nothing would press on it.

        With the symbols of `prony.py`, the pressure is

            p = -f K (u' - u_0),    f = 1 + sum_i m_i ramp_factor_i,
            u_0 = sum_i m_i (ramp_factor_i u - decay_i w_i) / f,

        and the solver finds u' - u_0. Under a punch that slides steadily each wave has a complex modulus of its own,
        and nothing is remembered.
        """
        series, stretch = self.problem.relaxation, state.memory[self.name].stretch
        assert series is not None
        if step.speed:
            return StepModification(modulus=sliding_modulus(series, step.speed, state.heights.shape[-1]))
        decay, ramp_factor = series.update_coefficients(step.duration)
        moduli, factor = np.array(series.moduli), series.factor(step.duration)
        moved = np.tensordot(np.append((moduli * ramp_factor).sum(), -moduli * decay) / factor, stretch, 1)
        if not self.problem.interface.couples:
            return StepModification(normal_offset=moved[:, -1], factor=factor)
        along = moved[:, :-1]
        carried = None if state.last is None else along  # a law of gap and slip counts from the first touch
        before = None if state.last is None else state.last.change.tangential_offset
        if self.problem.interface.cohesive is None and before is not None:
            carried = along - before  # friction since the last step
        return StepModification(
            normal_offset=moved[:, -1], tangential_offset=along, factor=factor, anchor_shift=carried
        )

    def advance(self, state: State, solved: Contact, step: LoadStep) -> Springs:
        """Update stretch and traction of each spring by the formula of `prony.py`."""
        series, before = self.problem.relaxation, state.memory[self.name]
        assert series is not None
        traction, moved = tractions_of(solved), self._moved(solved)
        if step.speed:
            return self._sliding(before, solved, traction, moved)
        decay, ramp_factor = (
            _over_branches(each, before.stretch) for each in series.update_coefficients(step.duration)
        )
        moduli, factor = _over_branches(np.array(series.moduli), before.stretch), series.factor(step.duration)
        moved = moved - before.stretch[0]
        past = (decay * before.traction[1:] - moduli * ramp_factor * before.traction[0]).sum(axis=0)
        borne = (traction - past) / factor - before.traction[0]
        stretch = np.concatenate(
            ((before.stretch[0] + moved)[np.newaxis], decay * before.stretch[1:] + ramp_factor * moved)
        )
        traction = np.concatenate(
            ((before.traction[0] + borne)[np.newaxis], decay * before.traction[1:] + moduli * ramp_factor * borne)
        )
        old, both, new = series.losses(step.duration)
        along = tuple(range(2, moved.ndim))
        dissipated = self._rubbed(state, solved)
        for i, modulus in enumerate(series.moduli):
            w, t = before.stretch[1 + i], before.traction[1 + i]
            products = old[i] * w * t + both[i] * (modulus * w * borne + t * moved) + new[i] * modulus * moved * borne
            dissipated = dissipated + products.mean(axis=along).sum(axis=1)
        sizes = float(abs(tractions_of(solved)).sum()), float(abs(stretch[0]).sum())
        traction_so_far, stretch_so_far = (max(each) for each in zip(before.largest, sizes, strict=True))
        return Springs(stretch, traction, before.dissipated + dissipated, (traction_so_far, stretch_so_far))

    def _rubbed(self, state: State, solved: Contact) -> Reals:
        """Energy per nominal area that friction dissipates `[realisation]`; 0 in the first step of unknown path."""
        dissipated = np.zeros(len(solved.heights))
        friction = self.problem.interface.friction
        if friction is not None and isfinite(friction) and state.last is not None:
            now, last = (FrictionalWork.of(self.problem, each) for each in (solved, state.last))
            dissipated[0] = now.dissipated(last)  # who follows steps follows one realisation
        return dissipated

    def _sliding(self, before: Springs, solved: Contact, traction: Reals, moved: Reals) -> Springs:
        """Springs under a punch that slides steadily; what the dashpots take then never ends, and is not added up."""
        series, shape = self.problem.relaxation, moved.shape[2:]
        assert series is not None
        assert solved.step is not None
        assert solved.change.modulus is not None
        lags = series.lags(_frequencies(solved.step.speed, shape[-1]))
        lags = lags.reshape(len(lags), *(1 for _ in moved.shape[:-1]), -1)
        borne = lags * _over_branches(np.array(series.moduli), lags) / solved.change.modulus
        of_branches = [
            grid.signal(share * grid.coefficients(field, len(shape)), *shape)
            for share, field in ((lags, moved), (borne, traction))
        ]
        first = moved[np.newaxis], (traction - of_branches[1].sum(axis=0))[np.newaxis]
        stretch, traction = (np.concatenate(each) for each in zip(first, of_branches, strict=True))
        return Springs(stretch, traction, before.dissipated)

    def _moved(self, solved: Contact) -> Reals:
        """Displacement `[realisation, component, (y,) x]` since the unloaded body.

        On a periodic half-space the displacement has no mean. Under a prescribed load the mean of the solution is
        arbitrary, and replaced by that of the mean pressure.
        """
        found, change = solved.equilibrium, solved.change
        u = found.displacement
        if solved.approach is None and self.problem.mean_pressure is not None:
            along = tuple(range(1, u.ndim))
            mean = change.factor * self.problem.body.uniform_stiffness()[1]
            by_mean = found.pressure.mean(axis=along, keepdims=True) / mean if mean > 0.0 else 0.0
            u = u - u.mean(axis=along, keepdims=True) - by_mean
        out = (u if change.normal_offset is None else u + change.normal_offset)[:, np.newaxis]
        return (
            out
            if solved.tangential_displacement is None
            else np.concatenate((solved.tangential_displacement, out), axis=1)
        )


def tractions_of(solved: Contact) -> Reals:
    """Tractions on the body `[realisation, component, (y,) x]`, the normal one last and out of it."""
    found = solved.equilibrium
    out = -found.pressure[:, np.newaxis]
    return out if found.tangential is None else np.concatenate((found.tangential.traction, out), axis=1)


def _frequencies(speed: float, nx: int) -> Reals:
    """Angular frequency `[nx // 2 + 1]` at a node of the body of each wave that a punch takes with it along x."""
    return -speed * grid.wavenumbers(nx)


def sliding_modulus(series: PronySeries, speed: float, nx: int) -> Complexes:
    """Complex modulus `[nx // 2 + 1]` of each wave under a punch that slides along x, over the relaxed modulus.

    At Nyquist, where a grid does not tell waves of opposite directions, their compliances are averaged.
    """
    found = series.complex_modulus(_frequencies(speed, nx))
    if nx % 2 == 0:
        found[-1] = 1.0 / (1.0 / found[-1]).real
    return found


def _over_branches(coefficients: Reals, stretch: Reals | Complexes) -> Reals:
    """Coefficients `[branch]`, ready to broadcast with a stretch `[spring, realisation, component, (y,) x]`."""
    return coefficients.reshape(-1, *(1 for _ in stretch.shape[1:]))
