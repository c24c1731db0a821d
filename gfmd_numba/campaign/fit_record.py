"""What a campaign file says of its fit: the variable, along a path the step, and what is known of the exponents."""

from collections.abc import Collection, Iterable, Mapping
from typing import Any, Literal

from pydantic import BaseModel, Field

from gfmd_numba.campaign.goal import Variable
from gfmd_numba.campaign.limits import FixedExponents
from gfmd_numba.contact.observables import LIMITED, PATH_OBSERVABLES, needed_for, recorded_along, unheld
from gfmd_numba.scene import Document, Scene
from gfmd_numba.scene.document import Location
from gfmd_numba.scene.quantities import RECORD, broken_rule


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
        row = PATH_OBSERVABLES.get(self.variable)
        return row is not None and row.of == "path"

    @property
    def options(self) -> dict[str, Any]:
        """What the fit itself is told."""
        return self.model_dump(mode="json", exclude_none=True)

    def with_target(self, target: Mapping[str, float] | None) -> "Fit":
        """The same, of the first variable of a target if the file names none to be fitted."""
        if target is None or "variable" in self.model_fields_set:
            return self
        return self.model_copy(update={"variable": next(iter(target))})

    def check(self, n_steps: int, place: Location) -> None:
        """Raise a located error if what is fitted is not there along a path of so many steps after the first one.

        The variable stands at a place in the file.
        """
        if self.variable in PATH_OBSERVABLES and n_steps == 0:
            raise broken_rule(place, "what a single contact has, as this campaign has no path")
        if self.step is None:
            return
        if n_steps == 0:
            raise broken_rule(("fit", "step"), "nothing without a path")
        if self.is_of_path:
            raise broken_rule(("fit", "step"), f"nothing with {self.variable}, which the path has as a whole")
        if self.step > n_steps:
            raise broken_rule(("fit", "step"), f"a step from 0, the first loading, to {n_steps}")


def check_limit(document: Document, scene: Scene, varied: Collection[str], fit: Fit, place: Location) -> None:
    """Raise InputError for a target, at a place in the file, that has no limit where these discretisations vary."""
    if why := unheld(LIMITED[fit.variable], scene, varied):
        raise document.error(place, fit.variable, f"what has a limit here; {fit.variable} has none, because {why}")


def check_recorded(document: Document, fit: Fit, place: Location, scenes: Iterable[tuple[Scene, int]]) -> None:
    """Raise InputError if none of some scenes, followed to an order in the slope, has what a path is fitted for.

    The variable stands at a place in the file.
    """
    scenes, along = list(scenes), fit.variable in PATH_OBSERVABLES
    if LIMITED[fit.variable].needs_hardness and all(scene.interface.hardness is None for scene, _ in scenes):
        raise document.error(place, fit.variable, "what these contacts have; this needs a hardness of the hard_wall")
    if along and not any(fit.variable in recorded_along(scene, order) for scene, order in scenes):
        raise document.error(place, fit.variable, f"what this path has; {needed_for(fit.variable)}")
