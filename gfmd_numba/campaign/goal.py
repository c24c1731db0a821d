"""What a campaign is to find: the variable that is fitted, errors of variables in the limit, and a budget of time."""

from collections.abc import Callable, Collection, Mapping, Sequence
from math import inf, nan
from typing import Annotated, Any, Literal, cast

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema
from pydantic_core import PydanticCustomError

from gfmd_numba.campaign.limits import FixedExponents
from gfmd_numba.contact import observables
from gfmd_numba.scene import Document, Scene
from gfmd_numba.scene.document import Location, nearest, plain_scalar
from gfmd_numba.scene.quantities import RECORD, broken_rule
from gfmd_numba.scene.units import TIME
from gfmd_numba.text.input_error import InputError, brief

A_VARIABLE = f"one of {', '.join(observables.LIMITED)}"
A_TARGET = f"any of {', '.join(observables.LIMITED)} and relative errors of them, like {{kappa: 3%, kappa_r: 0.02}}"
_SHARES = f"{A_VARIABLE}, or several, each with a relative error above 0 and below 1, like kappa=3% or 0.03"
A_TIME = "a time like 20min, 2h or 90 s; a plain number is in s"


def share_of(given: object) -> float:
    """Return a share above 0 and below 1 that is given as 0.03 or as `3%`; raises ValueError."""
    number: Any = given.strip().removesuffix("%") if isinstance(given, str) else given
    try:
        share = float(number) / 100.0 ** str(given).strip().endswith("%")
    except (TypeError, ValueError):
        share = 0.0
    if isinstance(given, bool) or not 0.0 < share < 1.0:
        raise ValueError("a relative error above 0 and below 1, like 3% or 0.03")
    return share


def _variable(given: str) -> str:
    if why := observables.why_no_limit(given):
        raise broken_rule((), f"{A_VARIABLE}; {why}")
    if given not in observables.LIMITED:
        raise ValueError(A_VARIABLE)
    return given


def _target(given: object) -> dict[str, float]:
    names = [name for name in given if isinstance(name, str)] if isinstance(given, Mapping) else []
    unknown = [name for name in names if name not in observables.LIMITED]
    if why := "; ".join(observables.why_no_limit(name) or nearest(name, observables.LIMITED) for name in unknown):
        raise broken_rule((), f"{A_TARGET}; {why}")
    if not isinstance(given, Mapping) or not given or not set(given) <= observables.LIMITED.keys():
        raise ValueError(A_TARGET)
    try:
        return {name: share_of(value) for name, value in given.items()}
    except ValueError as error:
        raise broken_rule((), f"{error} for each variable") from None


Variable = Annotated[str, AfterValidator(_variable), WithJsonSchema({"enum": list(observables.LIMITED)})]
Target = Annotated[dict[str, float], BeforeValidator(_target), WithJsonSchema({"allowed": A_TARGET})]


class Goal(BaseModel):
    """Relative standard errors of variables in the limit, and the processor time in s for all; None: no bound."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
    targets: dict[str, Annotated[float, Field(gt=0, lt=1)]] = Field(min_length=1)
    budget: float | None = Field(None, gt=0)


def goal_of(until: object, budget: object = None) -> Goal:
    """Return the goal of a mapping like `{"kappa": 0.01}` and a time in s or like `20min`; raises InputError."""
    unknown = [name for name in until if name not in observables.LIMITED] if isinstance(until, Mapping) else []
    if unknown:
        why = observables.why_no_limit(unknown[0]) if isinstance(unknown[0], str) else ""
        clauses = (A_VARIABLE, why, nearest(unknown[0], observables.LIMITED))
        raise InputError.of("until", brief(unknown[0]), "; ".join(filter(None, clauses)))
    try:
        targets = _target(until)
    except (PydanticCustomError, ValueError):
        raise InputError.of("until", brief(until), _SHARES) from None
    if budget is None:
        return Goal(targets=targets)
    try:
        given = plain_scalar(budget) if isinstance(budget, str) else budget
        seconds = nan if isinstance(given, bool) else float(cast(Any, TIME.read(given)))
    except (TypeError, ValueError, PydanticCustomError):
        seconds = nan
    if not 0.0 < seconds < inf:
        raise InputError.of("budget", brief(budget), A_TIME)
    return Goal(targets=targets, budget=seconds)


class Fit(BaseModel):
    """How the results are fitted to their limit."""

    model_config = RECORD
    variable: Variable = Field(
        "kappa", description="What is fitted; left out: the first variable of a target, else kappa"
    )
    step: int | None = Field(
        None, ge=0, description="Step of the path whose contact is fitted, 0 is the first loading; None: every step"
    )
    exponents: Literal["shared", "free"] = Field("shared", description="One set for all groups, or one for each")
    fixed: FixedExponents = Field(FixedExponents(), description="Exponents known beforehand")

    @property
    def is_of_path(self) -> bool:
        """Whether a path has the variable as a whole, not at each step."""
        row = observables.PATH_OBSERVABLES.get(self.variable)
        return row is not None and row.of == "path"

    @property
    def options(self) -> dict[str, Any]:
        """Arguments of the fit itself."""
        return self.model_dump(mode="json", exclude_none=True)

    def with_target(self, target: Mapping[str, float] | None) -> "Fit":
        """Return the same for the first variable of a target, if the file does not say what is fitted."""
        if target is None or "variable" in self.model_fields_set:
            return self
        return self.model_copy(update={"variable": next(iter(target))})

    def check(self, n_steps: int, place: Location) -> None:
        """Raise a located error if the variable or step does not exist on a path of `n_steps` after the first loading.

        `place` is where the variable stands in the file.
        """
        if self.variable in observables.PATH_OBSERVABLES and n_steps == 0:
            raise broken_rule(place, "what a single contact has, as this campaign has no path")
        if self.step is None:
            return
        if n_steps == 0:
            raise broken_rule(("fit", "step"), "nothing without a path")
        if self.is_of_path:
            raise broken_rule(("fit", "step"), f"nothing with {self.variable}, which the path has as a whole")
        if self.step > n_steps:
            raise broken_rule(("fit", "step"), f"a step from 0, the first loading, to {n_steps}")


# of what a variable needs: whether a scene has it, and what it is
_NEEDS: dict[str, tuple[Callable[[Scene], bool], str]] = {
    "hardness": (lambda scene: scene.interface.hardness is not None, "a hardness of the hard_wall"),
    "form": (lambda scene: scene.form is not None, "a form of the punch"),
    "window": (lambda scene: any(scene.ends), "a scene without a period"),
}


def check_fit(
    document: Document, fit: Fit, place: Location, scenes: Sequence[tuple[Scene, int]], varied: Collection[str]
) -> None:
    """Raise InputError unless one of the scenes, each with its order in the slope, has what is fitted.

    `place` is where the variable stands in the file. A target needs a limit in the discretisations that are `varied`.
    """
    variable, row, allowed = fit.variable, observables.LIMITED[fit.variable], ""
    has, what = _NEEDS.get(row.needs, (bool, ""))
    is_asked = place[0] == "target" or varied or "variable" in fit.model_fields_set
    if is_asked and variable in observables.OF_TOUCHING and not any(each.interface.touches for each, _ in scenes):
        allowed = "mean_gap or elastic_energy: under this law nothing touches"
    elif not any(has(scene) for scene, _ in scenes):
        allowed = f"what these contacts have; this needs {what}"
    elif variable in observables.PATH_OBSERVABLES and not any(
        variable in observables.recorded_along(scene, order) for scene, order in scenes
    ):
        allowed = f"what this path has; {observables.needed_for(variable)}"
    elif place[0] == "target" and (why := observables.unheld(row, scenes[0][0], varied)):
        allowed = f"what has a limit here; {variable} has none, because {why}"
    if allowed:
        raise document.error(place, variable, allowed)
