"""State before a step of the loading, the processes that make it, and the contact at the end of the step.

A process remembers something between steps, and modifies a step by its memory. A load path is a fold over steps: each
begins in the state that the last one has left. Lengths are in g L_x, stresses in g E*. Words for motion along the
surface:

    sliding                   tangential displacement of the punch since first touch
    tangential displacement   of a node of the body
    slip                      of a node of the body on the punch in one step, from its anchor
    anchor                    where a node was when the step began, moved with the punch
    way, distance             length of a path, at least 0
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import dist, prod
from typing import Any, NamedTuple, Protocol

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.equilibrium import Equilibrium

Tell = Callable[[float], None]  # told how many more steps are done
_COSTS = ("n_iterations", "n_transforms", "wall_time")


class LoadStep(NamedTuple):
    """What a step of the loading ends with: a mean pressure or a displacement, and the sliding of the punch.

    `sliding` is along x, on maps also along y, since the first touch. `duration` is the time that the step takes, in
    the unit of the processes that know one. With a `speed` (L_x over that unit) the punch slides steadily along x.
    """

    load: float
    sliding: tuple[float, ...]
    duration: float = 0.0
    speed: float = 0.0

    def towards(self, end: "LoadStep", fraction: float) -> "LoadStep":
        """First share of the step from here to an end."""
        rest = 1.0 - fraction
        sliding = tuple(rest * here + fraction * there for here, there in zip(self.sliding, end.sliding, strict=True))
        return LoadStep(rest * self.load + fraction * end.load, sliding, fraction * end.duration, end.speed)


@dataclass(frozen=True)
class StepModification:
    """Modification of a step by a process; a part that is None modifies nothing, and costs nothing.

    - `wall` `[realisation, (y,) x]`: the wall has moved away from the body, as a punch does that loses material.
    - `wear_compliance` (L_x/E*): where it touches, the wall moves by another wear_compliance times the pressure, as a
      punch does that wears in the step.
    - `normal_offset` `[realisation, (y,) x]` and `tangential_offset` `[realisation, component, (y,) x]`: the surface of
      the body has moved on its own, out of the body and along it; the displacements solved for count from there.
    - `factor`: the bodies are stiffer by this factor.
    - `modulus` `[nx // 2 + 1]`: the complex modulus of each wave in bodies that creep under a steadily sliding punch.
    - `anchor_shift` `[realisation, component, (y,) x]`: the anchor of each node has moved.
    - `lifted`: the part of the mean pressure that tangential tractions carry.
    """

    wall: Reals | float | None = None
    normal_offset: Reals | None = None
    tangential_offset: Reals | None = None
    factor: float = 1.0
    modulus: Complexes | None = None
    wear_compliance: float = 0.0
    anchor_shift: Reals | None = None
    lifted: float = 0.0

    @classmethod
    def of_all(cls, changes: Iterable["StepModification"]) -> "StepModification":
        """What several processes do together."""
        every = list(changes)
        if not every:
            return NO_MODIFICATION
        wall, normal, tangential, anchors = (
            _sum(getattr(each, name) for each in every)
            for name in ("wall", "normal_offset", "tangential_offset", "anchor_shift")
        )
        factor, compliance = prod(each.factor for each in every), sum(each.wear_compliance for each in every)
        modulus = next((each.modulus for each in every if each.modulus is not None), None)
        return cls(wall, normal, tangential, factor, modulus, compliance, anchors, sum(each.lifted for each in every))

    def applied_to(self, response: SpectralResponse) -> SpectralResponse:
        """Response of bodies that are stiffer by the factor, or lag behind, with a punch that wears."""
        response = response.scaled(self.factor)
        if self.modulus is not None:
            lagging: Any = self.modulus * response.normal
            response = response.of_normal(lagging)
        return response if self.wear_compliance == 0.0 else response.with_yielding(self.wear_compliance)


NO_MODIFICATION = StepModification()


def _sum(parts: Iterable[Any]) -> Any:
    given = [part for part in parts if part is not None]
    return sum(given[1:], given[0]) if given else None


class Process(Protocol):
    """Something that happens to a contact besides its load, like wear: it is named, and remembers what it likes."""

    @property
    def name(self) -> str:
        """Key of what it remembers, in the memory of a state."""
        ...

    def begin(self, shape: tuple[int, ...]) -> Any:
        """What it remembers before the first step, of heights of a shape (realisation, (y,) x)."""
        ...

    def change(self, state: "State", step: LoadStep) -> StepModification:
        """What it does to a step that begins in a state."""
        ...

    def advance(self, state: "State", solved: "Contact", step: LoadStep) -> Any:
        """What it remembers after a step that began in a state, and has led to a contact: as a rule the same."""
        return state.memory[self.name]


@dataclass(frozen=True)
class State:
    """What happened before a step: what each process remembers, by its name, and the contact that the last step left.

    `heights` `[realisation, (y,) x]` are those of the punch as it was made, peaks towards the body. They include the
    smooth `form` under its roughness. `passing` is that of a `Problem`, and `moved` maps a way (L_x) to the heights
    `[(y,) x]` of a form alone that has moved by it. A step that `repeats` the load of the last one, on a surface that
    has hardly moved since, begins with the sticking nodes of the last one.
    """

    heights: Reals
    processes: tuple[Process, ...] = ()
    memory: Mapping[str, Any] = field(default_factory=dict)
    last: "Contact | None" = None
    repeats: bool = False
    form: Reals | None = None
    passing: float | None = None
    moved: Callable[[tuple[float, ...]], Reals] | None = None

    @classmethod
    def untouched(cls, heights: Reals, processes: tuple[Process, ...], **known: Any) -> "State":
        """State of surfaces before the first step; its other fields may be known."""
        memory = {each.name: each.begin(heights.shape) for each in processes}
        return cls(heights, processes, memory, **known)

    def facing(self, heights: Reals, step: LoadStep) -> Reals:
        """Heights `[..., (y,) x]` of the punch over the nodes of the body at the end of a step."""
        if self.passing is None or not any(step.sliding):
            return heights
        way = tuple(self.passing * each for each in step.sliding)
        return grid.moved(heights, way) if self.moved is None else np.broadcast_to(self.moved(way), heights.shape)

    def change(self, step: LoadStep) -> StepModification:
        """What all processes do to the next step."""
        return StepModification.of_all(each.change(self, step) for each in self.processes)

    def step_before(self, step: LoadStep) -> LoadStep:
        """The step before the next one; at first no load, and no sliding."""
        before = None if self.last is None else self.last.step
        return LoadStep(0.0, (0.0,) * len(step.sliding)) if before is None else before

    def sliding_distance(self, step: LoadStep) -> float:
        """Distance that the punch slides in the next step."""
        return dist(step.sliding, self.step_before(step).sliding)

    def remembering(self, name: str, memory: Any) -> "State":
        """The same, but for what one process remembers."""
        return replace(self, memory={**self.memory, name: memory})

    def after(self, solved: "Contact", step: LoadStep) -> "State":
        """Return the state after a step."""
        memory = {each.name: each.advance(self, solved, step) for each in self.processes}
        return replace(self.begun_at(solved), memory=memory)

    def begun_at(self, solved: "Contact", repeats: bool = False) -> "State":
        """The same, but begun where another contact is."""
        return replace(self, last=replace(solved, before=None), repeats=repeats)


@dataclass(frozen=True)
class Followed:
    """Energy `dissipated` in a step of a path, per nominal area (g^2 E* L_x), and the load at its largest jump.

    The load `jump_at` is the displacement of the punch (g L_x) or the mean pressure (g E*), not-a-number without a
    jump. `least_pressure` is the smallest mean pressure of all solutions on the way (g E*), and `jump_sliding` the
    tangential displacement of the punch along x at the jump (g L_x). The `plastic_work` is a part of the energy
    dissipated.
    """

    dissipated: float
    jump_at: float
    least_pressure: float = np.nan
    jump_sliding: float = np.nan
    plastic_work: float = 0.0


NO_LOSS = Followed(0.0, np.nan)


@dataclass(frozen=True)
class Contact:
    """Heights `[realisation, (y,) x]` of the punch, peaks towards the body, and the equilibrium of the body under it.

    `punch` is the wall that limits the displacement: the heights upside down, with first touch (or the prescribed
    displacement below it) at zero, moved by the `change` that processes make to this step. `before` is the state in
    which the `step` began. `followed` tells of the step of a path that led here, None where steps are not divided.
    `stiffness` maps wave numbers to the stiffness of the deformable bodies (E*/L_x). Without a period, `approach`
    `[realisation, (1,) 1]` is how far the punch has sunk in since first touch, and displacements and punch are measured
    from the body at rest; it is None in a periodic contact. `ends` says along which of (y,) x the punch ends, and is
    empty with a period. `time_error` is the relative error by the divisions of all steps so far, 0 where no step
    is divided. `least_pressure` is the smallest mean pressure at any of the divisions of this step, infinite without
    any, and `slip_path` `[realisation, (y,) x]` the way of each node along the punch in all of them, None without any.
    `law_traction_at_contact` `[(y,) x]` is the traction of a law of the gap where the gap is 0, 0 without one. The
    mirror images of a contact are `fields_in_period` contacts with edges at the same places. `found` are the
    observables found so far.
    """

    heights: Reals
    punch: Reals
    equilibrium: Equilibrium
    before: State | None = None
    step: LoadStep | None = None
    change: StepModification = NO_MODIFICATION
    followed: Followed | None = None
    stiffness: Callable[[Reals], Reals] = stiffness.half_space
    approach: Reals | None = None
    ends: tuple[bool, ...] = ()
    time_error: float = 0.0
    least_pressure: float = np.inf
    slip_path: Reals | None = None
    law_traction_at_contact: Reals | float = 0.0
    fields_in_period: int = 1
    found: dict[object, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    @cached_property
    def after(self) -> State:
        """State in which the next step begins."""
        assert self.before is not None  # of what was solved
        assert self.step is not None
        return self.before.after(self, self.step)

    @property
    def in_plane(self) -> "Contact":
        """The contact with its tractions along the plane and its pressure out of it, as the load counts them."""
        return self

    @property
    def tangential_displacement(self) -> Reals | None:
        """Tangential displacement of the body `[realisation, component, (y,) x]` in g L_x, None if none is followed."""
        found, along = self.equilibrium.tangential, self.change.tangential_offset
        return None if found is None else found.displacement if along is None else found.displacement + along

    @property
    def roughness(self) -> Reals:
        """Heights `[realisation, (y,) x]` of the punch without the form below its roughness; those of a form alone."""
        if self.form is None:
            return self.heights
        rough = self.heights - self.form
        return rough if rough.any() else self.heights

    @property
    def form(self) -> Reals | None:
        """Heights `[(y,) x]` of the smooth form of the punch, None without."""
        if self.before is None or self.before.form is None or self.step is None:
            return None
        return self.before.facing(self.before.form, self.step)

    @property
    def plastic_penetration(self) -> Reals | float:
        """Depth by which plastic nodes penetrate the punch, and flatten it, in this step (g L_x)."""
        if self.equilibrium.plastic is None:
            return 0.0
        return np.maximum(self.equilibrium.displacement - self.punch, 0.0)

    @property
    def memory(self) -> Mapping[str, Any]:
        """What processes remember after the step, by their names; nothing of a contact that no state came before."""
        return {} if self.before is None else self.after.memory

    @property
    def plastic_depth(self) -> Reals | float:
        """Depth by which the punch has been flattened in all steps (g L_x), which stays when it is unloaded."""
        depth: Reals | float = self.after.memory.get("indentation", 0.0)
        return depth


def with_costs(found: Equilibrium, every: Iterable[Equilibrium]) -> Equilibrium:
    """Return the equilibrium with the iterations, transforms and time of `every` solve that led to it."""
    each = list(every)
    return replace(found, **{name: sum(getattr(one, name) for one in each) for name in _COSTS})


def relative_difference(coarse: Reals, fine: Reals, least: float = 0.0) -> float:
    """Mean difference of two fields over the mean of the finer one, or over a `least` sum of it if that is larger."""
    scale = max(float(abs(fine).sum()), least)
    return float(abs(coarse - fine).sum()) / scale if scale > 0.0 else 0.0
