"""How a solver is run."""

from dataclasses import dataclass

from gfmd_numba.solvers.table import MAX_ITERATIONS, RESIDUAL, SOLVERS


@dataclass(frozen=True)
class Options:
    """Options of a solver of the table; `time_step` and `damping` stay None for a solver without them.

    A run stops at the relative `residual`. `time_step` is a fraction of the stability limit, `damping` one of the
    critical damping of the slowest mode; left out they are the solver's own. Raises ValueError for an option that the
    solver does not have.
    """

    solver: str
    residual: float = RESIDUAL
    max_iterations: int = MAX_ITERATIONS
    precision: str = "double"
    time_step: float | None = None
    damping: float | None = None

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
