"""The memory of a viscoelastic body: what its branches are stretched by and bear, and the process that changes them.

The body is linear, and its Poisson's ratio is constant. What it remembers of one node is therefore nothing but the past
of that node, whatever its stiffness is as a function of the wave number: a step in time is an elastic contact of a
stiffer body whose surface has moved on its own.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import Change, Contact, LoadStep, State


@dataclass(frozen=True)
class Springs:
    """The springs of a body: the relaxed one first, then that of each branch (g L_x, g E*).

    `stretch` and `pressure` are `[spring, realisation, (y,) x]`, the stretch of the relaxed one is the displacement.
    `dissipated` is the energy per nominal area that the dashpots have taken so far `[realisation]` (g^2 E* L_x).
    """

    stretch: Reals
    pressure: Reals
    dissipated: Reals

    def energy(self, periodic: bool) -> Reals:
        """Energy per nominal area in all springs `[realisation]`; of periodic bodies that of all waves but the mean."""
        stretch, along = self.stretch, tuple(range(2, self.stretch.ndim))
        if periodic:
            stretch = stretch - stretch.mean(axis=along, keepdims=True)
        return np.asarray(-0.5 * (self.pressure * stretch).mean(axis=along).sum(axis=0))


@dataclass(frozen=True)
class Relaxation:
    """Branches of a Prony series in parallel with the relaxed bodies, exact for displacements linear in time."""

    problem: Problem
    name: ClassVar[str] = "springs"

    def begin(self, shape: tuple[int, ...]) -> Springs:
        """Nothing is stretched."""
        assert self.problem.relaxation is not None
        nothing = np.zeros((1 + len(self.problem.relaxation.moduli), *shape))
        return Springs(nothing, nothing, np.zeros(shape[0]))

    def split(self, state: State, step: LoadStep) -> Change:
        """The bodies are stiffer, and their surface has moved to where nothing would press on it."""
        series, stretch = self.problem.relaxation, state.memory[self.name].stretch
        assert series is not None
        kept, joined = series.shares(step.duration)
        moduli, factor = np.array(series.moduli), series.factor(step.duration)
        out = np.tensordot(np.append((moduli * joined).sum(), -moduli * kept) / factor, stretch, 1)
        return Change(out=out, factor=factor)

    def advance(self, state: State, solved: Contact, step: LoadStep) -> Springs:
        """Springs are stretched by what the step adds, less what the dashpots yield."""
        series, before = self.problem.relaxation, state.memory[self.name]
        assert series is not None
        kept, joined = (_over_branches(each, before.stretch) for each in series.shares(step.duration))
        moduli, factor = _over_branches(np.array(series.moduli), before.stretch), series.factor(step.duration)
        moved = self._moved(solved) - before.stretch[0]
        past = (kept * before.pressure[1:] - moduli * joined * before.pressure[0]).sum(axis=0)
        borne = (solved.equilibrium.pressure - past) / factor - before.pressure[0]
        stretch = np.concatenate(((before.stretch[0] + moved)[np.newaxis], kept * before.stretch[1:] + joined * moved))
        pressure = np.concatenate(
            ((before.pressure[0] + borne)[np.newaxis], kept * before.pressure[1:] + moduli * joined * borne)
        )
        old, both, new = series.losses(step.duration)
        along = tuple(range(1, moved.ndim))
        lost = np.zeros(len(moved))
        for i, modulus in enumerate(series.moduli):
            w, p = before.stretch[1 + i], before.pressure[1 + i]
            products = old[i] * w * p + both[i] * (modulus * w * borne + p * moved) + new[i] * modulus * moved * borne
            lost -= products.mean(axis=along)
        return Springs(stretch, pressure, before.dissipated + lost)

    def _moved(self, solved: Contact) -> Reals:
        """Displacement since the unloaded body; that of a half-space with a period has no mean.

        Under a prescribed load its mean is arbitrary in what is solved.
        """
        found, out = solved.equilibrium, solved.change.out
        u = found.displacement
        if solved.approach is None and self.problem.mean_pressure is not None:
            along = tuple(range(1, u.ndim))
            mean = solved.change.factor * self.problem.body.uniform_stiffness()[1]
            pressed = found.pressure.mean(axis=along, keepdims=True) / mean if mean > 0.0 else 0.0
            u = u - u.mean(axis=along, keepdims=True) - pressed
        return u if out is None else u + out


def _over_branches(shares: Reals, stretch: Reals) -> Reals:
    """Shares `[branch]`, ready to broadcast with the branches of a stretch `[spring, realisation, (y,) x]`."""
    return shares.reshape(-1, *(1 for _ in stretch.shape[1:]))
