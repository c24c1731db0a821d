"""The table of solvers, with the abilities and options of each, and the options of a run.

Pure data: importing it compiles nothing. The first solver of the table that can do all that a problem asks for is the
one that `auto` stands for.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

RESIDUAL, MAX_ITERATIONS = 1e-8, 200_000  # the defaults of every solver

# What a problem may ask of a solver, and how a message goes on that names those that can.
ABILITIES = {
    "rigid mean": " under loading.displacement at poissons_ratio 0.5, where the mean displacement is rigid",
    "dimension 1": " with dimension 1",
    "dimension 2": " with dimension 2",
    "friction": ", which follow both displacements",
    "sticking": " with an infinite coefficient of friction",
    "slip rate": " with a friction that depends on the slip rate",
    "cohesive law": " with a law of gap and slip",
    "prescribed": ", the solver of both displacements",
    "normal law": ", as the others know the hard wall only",
    "hard wall": " with a hard_wall",
    "hardness": " with a hardness, the second bound of the pressure",
    "speed": " with a sliding speed over a viscoelastic body, whose response is not symmetric",
}


@dataclass(frozen=True)
class Solver:
    """A solver; what can be done is named as in `ABILITIES`.

    `condensed` begins it where the normal displacement alone is followed, `coupled` where all are: "module:callable" of
    a problem and options. The first of them that takes the problem runs, as the others return None. `options` are
    those that not every solver has, with their defaults. A block of rows holds at most `block_samples` samples: up to
    2^15 its arrays stay in the second-level cache; a solver that finishes one row before the next has no use for that.
    After `gives_up_after` iterations the solver named `successor` begins anew. `shares_threads`: threads share the work
    on maps without a hardness.
    """

    sentence: str
    can: frozenset[str]
    condensed: tuple[str, ...]
    coupled: tuple[str, ...] = ()
    options: Mapping[str, float] = field(default_factory=dict)
    block_samples: int = 2**15
    gives_up_after: int | None = None
    successor: str | None = None
    shares_threads: bool = False


_PRESSURE = frozenset({"dimension 1", "dimension 2", "hard wall", "hardness", "rigid mean"})
_DISPLACEMENT = frozenset({"dimension 1", "dimension 2", "hard wall", "normal law"})
_ACTIVE_SETS = (
    "gfmd_numba.solvers.tiles.newton:tile_newton",
    "gfmd_numba.solvers.exponential_sums.newton:decay_newton",
    "gfmd_numba.solvers.active_set_newton:ActiveSetNewton",
)
ONLY_IN = {_ACTIVE_SETS[0]: 2, _ACTIVE_SETS[1]: 1}  # the dimension of the surfaces that some take
OF_CORNERS = frozenset({_ACTIVE_SETS[0]})  # take a punch without the grid around it
_TIME_STEP, _DAMPING = {"time_step": 0.95}, {"damping": 0.5}

SOLVERS = {
    "active_set_newton": Solver(
        "guesses which nodes touch and solves the linear problem that is left, preconditioned",
        can=_PRESSURE,
        condensed=_ACTIVE_SETS,
        block_samples=2**18,
        gives_up_after=50,  # usually below 10
        successor="conjugate_gradients",
        shares_threads=True,
    ),
    "conjugate_gradients": Solver(
        "constrained conjugate gradients on the pressure",
        can=_PRESSURE,
        condensed=("gfmd_numba.solvers.conjugate_gradients:ConjugateGradients",),
    ),
    "truncated_newton": Solver(
        "descends the energy by Newton steps from preconditioned conjugate gradients, with a law of the gap or of gap "
        "and slip; under a hardness without a law the same as active_set_newton",
        can=_PRESSURE | {"normal law", "cohesive law"},
        condensed=("gfmd_numba.solvers.truncated_newton:unless_hardness_alone", *_ACTIVE_SETS),
        coupled=("gfmd_numba.solvers.truncated_newton:TruncatedNewton",),
        block_samples=2**18,
    ),
    "frictional_newton": Solver(
        "guesses which nodes touch, stick and slip, and solves the linear problem that is left; without friction the "
        "same as active_set_newton, or as truncated_newton with a law",
        can=frozenset({"dimension 1", "dimension 2", "hard wall", "normal law", "friction", "sticking", "rigid mean"})
        | {"slip rate"},
        condensed=("gfmd_numba.solvers.truncated_newton:under_a_law", *_ACTIVE_SETS),
        coupled=("gfmd_numba.solvers.friction.newton:FrictionalNewton",),
        block_samples=2**18,
        gives_up_after=100,  # usually below 12
        successor="verlet",
    ),
    "verlet": Solver(
        "damped dynamics by the position Stormer-Verlet scheme, of one displacement or of all",
        can=_DISPLACEMENT | {"dimension 2", "cohesive law", "friction", "sticking", "prescribed"},
        condensed=("gfmd_numba.solvers.dynamics:verlet",),
        coupled=("gfmd_numba.solvers.dynamics:verlet",),
        options=_TIME_STEP | _DAMPING,
    ),
    "gronbech_jensen": Solver(
        "damped dynamics by the scheme of Gronbech-Jensen and Farago",
        can=_DISPLACEMENT,
        condensed=("gfmd_numba.solvers.dynamics:gronbech_jensen_farago",),
        options=_TIME_STEP | _DAMPING,
    ),
    "fire": Solver(
        "fast inertial relaxation engine, which finds its own damping",
        can=_DISPLACEMENT,
        condensed=("gfmd_numba.solvers.dynamics:fire",),
        options=_TIME_STEP,
    ),
    "sliding_newton": Solver(
        "guesses which nodes touch of a punch that slides steadily over a viscoelastic body",
        can=frozenset({"dimension 1", "dimension 2", "hard wall", "speed"}),
        condensed=("gfmd_numba.solvers.sliding_newton:SlidingNewton",),
        block_samples=2**18,
        gives_up_after=200,  # usually below 12
    ),
}


def able(needs: Iterable[str]) -> tuple[str, ...]:
    """Names of the solvers that can do all that is needed, the fastest first."""
    needed = frozenset(needs)
    return tuple(name for name, solver in SOLVERS.items() if needed <= solver.can)


def automatic(dimension: int, needs: Iterable[str]) -> str:
    """Name of the solver that `auto` stands for."""
    return able((f"dimension {dimension}", *needs))[0]


@dataclass(frozen=True)
class Options:
    """Options of a solver of the table; `time_step` and `damping` stay None for a solver without them.

    A run stops at the relative `residual`. `time_step` is a fraction of the stability limit, `damping` one of the
    critical damping of the slowest mode; left out they are the solver's own. The `threads` that share the work change
    no result. Raises ValueError for an option that the solver does not have.
    """

    solver: str
    residual: float = RESIDUAL
    max_iterations: int = MAX_ITERATIONS
    time_step: float | None = None
    damping: float | None = None
    threads: int = field(default=1, repr=False, compare=False)

    def __post_init__(self) -> None:
        has = SOLVERS[self.solver].options
        for name in ("time_step", "damping"):
            if name in has and getattr(self, name) is None:
                object.__setattr__(self, name, has[name])
            elif name not in has and getattr(self, name) is not None:
                raise ValueError(f"the solver {self.solver} has no {name}")

    def number(self, name: str) -> float:
        """Value of an option that the solver has."""
        return float(getattr(self, name))
