"""One axis of a campaign: a parameter that its grid may vary, where it stands in a scene, and what it is called."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter
from typing import Any

from gfmd_numba.scene import Discretisation, Scene
from gfmd_numba.scene.measured_record import FileName

Place = tuple[str, ...]  # names of the fields that lead from a scene to a value


@dataclass(frozen=True)
class Axis:
    """A parameter of a grid: its key, the type of its values, and the place in the scene that they are put in.

    `place` is empty for a discretisation, which stands next to the scene. `symbol` heads a column on the terminal,
    `label` is its TeX. `unit` is a kind of unit, as a scene's units are named by. Cases that differ in an axis that
    `forms_groups` are different physics, and never enter one fit. `coordinate_name` is its name in the dataset where
    that is not its key. `limit` is the name of the limit in which a discretisation goes to 0.
    """

    name: str
    type: Any
    place: Place
    symbol: str
    label: str
    long_name: str
    unit: str = "1"
    forms_groups: bool = True
    coordinate_name: str = ""
    limit: str = ""

    @property
    def coordinate(self) -> str:
        """Name of its coordinate in the dataset."""
        return self.coordinate_name or self.name

    @property
    def has_names(self) -> bool:
        """Whether its values are names, which the dataset numbers as well."""
        return self.type is FileName

    @property
    def of_surface(self) -> bool:
        """Whether it varies the rough surface."""
        return self.place[:1] == ("roughness",)

    @cached_property
    def _found(self) -> Callable[[Any], Any]:
        return attrgetter(".".join(self.place or (self.name,)))

    def value(self, scene: Scene, discretisation: Discretisation | None) -> float | str | None:
        """Value of a case; None if it has no such parameter, as layers have ratios and heights of their own."""
        if len(self.place) == 2 and self.place[0] in ("body", "counter_body"):
            body = getattr(scene, self.place[0])
            if body is not None and body.layers is not None:
                return None
        try:
            found: float | str | None = self._found(scene if self.place else discretisation)
        except AttributeError:
            return None
        return found
