"""The grid of a campaign: values of the axes taken as a full product, each checked as the scene itself is."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, Field, ValidationError, create_model

from gfmd_numba.campaign.axes import AXES, OF_THE_SCENE, Axis, Place, with_values
from gfmd_numba.contact.plausible_numbers import implausible
from gfmd_numba.scene import Document, Random, Scene
from gfmd_numba.scene.document import Location, dotted
from gfmd_numba.scene.loading import Step
from gfmd_numba.scene.quantities import RECORD, broken_rule

Value = TypeVar("Value")


def _distinct(values: tuple[Value, ...]) -> tuple[Value, ...]:
    seen = set()
    for i, value in enumerate(values):
        if value in seen:
            raise broken_rule((i,), "each value once")
        seen.add(value)
    return values


Values = Annotated[tuple[Value, ...], Field(min_length=1, strict=False), AfterValidator(_distinct)]


def _fields() -> dict[str, Any]:
    of_any: Any = Values
    return {axis.name: (of_any[axis.type] | None, Field(None, description=axis.long_name)) for axis in AXES}


if TYPE_CHECKING:
    Grid = BaseModel  # the fields are those of the table
else:
    Grid = create_model(
        "Grid",
        __config__=RECORD,
        __doc__="Parameters taken as a full product, each in place of the scene's or reference's value.",
        **_fields(),
    )


def values_of(grid: Grid, axis: str) -> tuple[Any, ...] | None:
    """Return the values that a grid gives to an axis, numbers or names, or None."""
    given: tuple[Any, ...] | None = getattr(grid, axis)
    if given is None:
        return None  # whether a number has a unit, only `Campaign` needs to know
    return tuple(float(value) if isinstance(value, float) else value for value in given)


def varied_scenes(scene: Scene, grid: Grid) -> Iterator[tuple[Axis, Location, Scene]]:
    """Yield the scene with each single value of a grid: its axis, where the value stands in the file, and the scene."""
    for axis in OF_THE_SCENE:
        for i, value in enumerate(values_of(grid, axis.name) or ()):
            yield axis, ("grid", axis.name, i), with_values(scene, {axis.place: value})


def check_grid(document: Document, scene: Scene, grid: Grid) -> None:
    """Raise InputError for values of a parameter that a scene has not, or that break a rule of the scene."""
    for axis in OF_THE_SCENE:
        at = ("grid", axis.name)
        if values_of(grid, axis.name) is not None and (lack := _lack(scene, axis)):
            raise document.refused(at, lack)
    for axis, location, varied in varied_scenes(scene, grid):
        if not axis.of_surface and (fault := _fault(varied)):
            raise document.refused(location, fault[1])


def check_surfaces_of_grid(document: Document, scene: Scene, grid: Grid) -> None:
    """Raise InputError for values of a grid that, taken together, make no surface or one that does not fit its period.

    A value of the grid takes the place of the scene's, so that each value is checked with the grid's others.
    """
    for values, locations in surfaces_of_grid(grid):
        fault = _surface_fault(scene, values)
        if fault is None:
            continue
        place: Place = ("roughness", fault[0])
        allowed = fault[1]
        if place not in values:
            if getattr(scene.roughness, fault[0], None) is not None:
                allowed = f"a value for which {fault[0]} is {allowed}"
            to_blame = (each for each, value in values.items() if _surface_fault(scene, {each: value}))
            place = next(to_blame, list(values)[-1])
        location = locations[place]
        raise document.refused(location, allowed)


def surfaces_of_grid(grid: Grid) -> Iterator[tuple[dict[Place, Any], dict[Place, Location]]]:
    """Yield the values of each surface of a grid by their places in the scene, and where each stands in the file."""
    axes = [axis for axis in OF_THE_SCENE if axis.of_surface and values_of(grid, axis.name)]
    for chosen in product(*(enumerate(values_of(grid, axis.name) or ()) for axis in axes)):
        values = {axis.place: value for axis, (_, value) in zip(axes, chosen, strict=True)}
        yield values, {axis.place: ("grid", axis.name, i) for axis, (i, _) in zip(axes, chosen, strict=True)}


def doubt_of_numbers(scene: Scene, grid: Grid, path: Sequence[Step]) -> str:
    """Return sentences about implausible numbers of a scene, its grid or its path, a line each.

    Of the values of an axis the first implausible one is named.
    """
    axes = {axis: values for axis in OF_THE_SCENE if (values := getattr(grid, axis.name))}
    scene = with_values(scene, {axis.place: values[0] for axis, values in axes.items()})
    found = dict.fromkeys(implausible(scene, path))
    for axis, values in axes.items():
        others = (implausible(with_values(scene, {axis.place: value}), path) for value in values[1:])
        found |= dict.fromkeys(next((sentences for sentences in others if set(sentences) - found.keys()), ()))
    said = "\n".join(found)
    for axis in axes:
        said = said.replace(f"{dotted(axis.place)} is ", f"grid.{axis.name} is ")
    return said


def _surface_fault(scene: Scene, values: Mapping[Place, Any]) -> tuple[str, str] | None:
    """Return the `_fault` of the surface of a scene with other values, or of a length that does not fit the period."""
    surface = with_values(scene, values).roughness
    return None if surface is None else _fault(surface) or surface.misfit(scene.length or 1.0)


def _fault(record: BaseModel) -> tuple[str, str] | None:
    """Return the key of the first value that breaks a rule (empty for several), and what is allowed; or None."""
    try:
        type(record).model_validate_json(record.model_dump_json())  # which forgets what had units
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        context = fault.get("ctx", {})
        location = (*fault["loc"], *context.get("location", ()))
        return str(location[-1]) if location else "", context.get("allowed", fault["msg"])
    return None


def _lack(scene: Scene, axis: Axis) -> str:
    """Return what is allowed instead of an axis for which the scene has no parameter; empty if it has one."""
    record: Any = scene
    for name in axis.place[:-1]:
        record = getattr(record, name, None)
    *parts, key = axis.place
    home = ".".join(("scene", *parts))
    if isinstance(record, Random) and key not in type(record).model_fields:
        return f"nothing, as {home} with {record.named_by} {getattr(record, record.named_by)} has no {key}"
    if key not in getattr(type(record), "model_fields", ()):
        return f"nothing without {home}.{key}: add `{key}` to {home}; the values of the grid then replace it"
    if record is scene.loading and getattr(record, key) is None:
        return f"nothing, as the loading is a {next(name for name, value in scene.loading if value is not None)}"
    return ""
