"""The one table of axes: what a campaign's grid may vary, where it stands in a scene, and what it is called.

To add an axis, add its row. This is pure data and records: importing it compiles nothing. A grid takes the values of
the axes as a full product, and each is checked as the scene itself is.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from itertools import product
from operator import attrgetter
from types import NoneType
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_args, get_type_hints

from pydantic import AfterValidator, BaseModel, Field, ValidationError, create_model

from gfmd_numba.scene import Discretisation, Document, Random, Scene
from gfmd_numba.scene import quantities as long_names
from gfmd_numba.scene.document import Location, allowed_at, dotted
from gfmd_numba.scene.loading import Step
from gfmd_numba.scene.measured_record import FileName
from gfmd_numba.scene.plausible_numbers import implausible
from gfmd_numba.scene.quantities import RECORD, broken_rule
from gfmd_numba.scene.units import quantities

Place = tuple[str, ...]  # names of the fields that lead from a scene to a value
_UNITS = {"length": "height", "energy per area": "energy"}  # of quantities, where a scene names them otherwise
_COORDINATES = {
    "pressure": "prescribed_pressure",
    "displacement": "punch_displacement",
    "rms_gradient": "rms_gradient_target",
}


@cache
def _types_of(record: type[BaseModel]) -> dict[str, Any]:
    properties = {name: value for name, value in vars(record).items() if isinstance(value, property)}
    found = {name: get_type_hints(value.fget)["return"] for name, value in properties.items()}
    return found | get_type_hints(record, include_extras=True)


def _records(kind: Any) -> list[Any]:
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return [kind]
    return [record for each in get_args(kind) for record in _records(each)]


@dataclass(frozen=True)
class Axis:
    """A parameter of a grid: its name, and the record of the scene that has it, whose type its values have.

    `record` is a dotted path in the scene, through fields or through a property that finds the one that acts. `key` is
    the name of the field there if it is another. A discretisation stands next to the scene and has no record. `symbol`
    heads a column on the terminal, and `label` is its TeX.
    """

    name: str
    record: str
    symbol: str
    label: str
    long_name: str
    key: str = ""

    @cached_property
    def place(self) -> Place:
        """Names of the fields that lead from the scene to the value; none of a discretisation."""
        return (*self.record.split("."), self.key or self.name) if self.record else ()

    @cached_property
    def _home(self) -> "type[BaseModel]":
        """First record that may have its field."""
        kinds: list[Any] = [Scene if self.record else Discretisation]
        for name in self.place[:-1]:
            kinds = [record for kind in kinds for record in _records(_types_of(kind).get(name))]
        found: type[BaseModel] = next(kind for kind in kinds if (self.key or self.name) in _types_of(kind))
        return found

    @cached_property
    def type(self) -> Any:
        """Type of its values: that of its field, without None."""
        kind = _types_of(self._home)[self.key or self.name]
        given = tuple(each for each in get_args(kind) if each is not NoneType)
        return given[0] if NoneType in get_args(kind) and len(given) == 1 else kind

    @cached_property
    def unit(self) -> str:
        """Kind of its unit, as the units of a scene are named."""
        quantity = quantities(self._home).get(self.key or self.name)
        return "1" if quantity is None else _UNITS.get(quantity.name, quantity.name)

    @property
    def coordinate(self) -> str:
        """Name of its coordinate in the dataset, where what is asked for is not what is measured."""
        return _COORDINATES.get(self.name, self.name)

    @property
    def has_names(self) -> bool:
        """Whether its values are names, which the dataset numbers as well."""
        return bool(self.type == FileName)

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
            found: float | str | None = self._found(scene if self.record else discretisation)
        except AttributeError:
            return None
        return found


def _of(prefix: str, record: str, *rows: tuple[str, str, str, str]) -> Iterator[Axis]:
    """Axes whose names have a prefix before the name of the field: key, symbol, label and long name of each."""
    for key, symbol, label, long_name in rows:
        yield Axis(f"{prefix}_{key}", record, symbol, label, long_name, key)


AXES = (
    Axis("file", "roughness", "file", "file", "file of the measured surface"),
    Axis("hurst", "roughness", "H", "$H$", "Hurst exponent"),
    Axis("poissons_ratio", "body", "nu", r"$\nu$", "Poisson's ratio of the body"),
    Axis("aspect_ratio", "body", "a", "$a$", "thickness of the body over the period"),
    Axis("reduced_pressure", "loading", "p*", r"$\bar{p}^*$", long_names.REDUCED_PRESSURE),
    Axis("pressure", "loading", "p", r"$\bar{p}$", long_names.MEAN_PRESSURE),
    Axis("line_load", "loading", "F/l", r"$F/\ell$", long_names.LINE_LOAD),
    Axis("force", "loading", "F", "$F$", long_names.FORCE_ON_A_MAP),
    Axis("rms_gradient", "roughness", "g", r"$\bar{g}$", long_names.RMS_GRADIENT_TARGET),
    Axis("anisotropy", "roughness", "gamma", r"$\gamma$", "correlation length of a map, y over x"),
    Axis("hurst_x", "roughness", "H_x", "$H_x$", "Hurst exponent along x"),
    Axis("hurst_y", "roughness", "H_y", "$H_y$", "Hurst exponent along y"),
    Axis("rms_height", "roughness", "h", r"$\bar{h}$", "rms height asked for"),
    Axis("roll_off", "roughness", "lambda_l", r"$\lambda_l$", "longest wavelength of the power law"),
    Axis("cut_on", "roughness", "lambda_s", r"$\lambda_s$", "shortest wavelength"),
    Axis("cutoff", "roughness", "lambda_c", r"$\lambda_c$", "shortest wavelength kept"),
    Axis("points", "roughness", "points", "$n_x$", "grid points of the surface over the period"),
    Axis("correlation_length", "roughness", "xi", r"$\xi$", "correlation length"),
    Axis("correlation_length_x", "roughness", "xi_x", r"$\xi_x$", "correlation length along x"),
    Axis("correlation_length_y", "roughness", "xi_y", r"$\xi_y$", "correlation length along y"),
    Axis("mound_separation", "roughness", "lambda_m", r"$\lambda_m$", "mean distance of mounds"),
    Axis("radius", "form", "R", "$R$", "radius of the form, a ball or a cylinder"),
    Axis("radius_y", "form", "R_y", "$R_y$", "radius of the form along y"),
    Axis("slope", "form", "slope", r"$\tan\beta$", "slope of the flanks of the form, a wedge or a cone"),
    Axis("width", "form", "W", "$W$", "width of the form, a flat punch, between its edges"),
    Axis("edge_radius", "form", "R_e", "$R_e$", "radius of the edges of the form"),
    Axis("speed", "loading", "v", "$v$", "sliding speed of the punch along x"),
    Axis("displacement", "loading", "d", "$d$", long_names.PUNCH_DISPLACEMENT),
    *_of(
        "friction",
        "interface.friction",
        ("coefficient", "mu", r"$\mu$", "tangential over normal traction at which a node slides"),
        ("limit", "tau_max", r"$\tau_{max}$", "largest tangential traction that friction holds"),
        (
            "pressure_coefficient",
            "a_tau",
            r"$a_\tau$",
            "rise of the largest tangential traction that friction holds with the pressure",
        ),
        (
            "velocity_strengthening",
            "a_v",
            "$a_v$",
            "rise of the coefficient of friction with the logarithm of the slip rate",
        ),
        ("reference_velocity", "v_0", "$v_0$", "slip rate far below which the coefficient of friction is that at rest"),
    ),
    Axis("hardness", "interface.hard_wall", "p_H", "$p_H$", "contact pressure at which the hard wall gives way"),
    Axis("yield_stress", "body.plasticity", "Y", "$Y$", "uniaxial yield stress of the body"),
    Axis(
        "hardening", "body.plasticity", "H_p", "$H_p$", "slope of the yield stress of the body over the plastic strain"
    ),
    Axis(
        "work_of_adhesion",
        "interface.law_of_the_gap",
        "w",
        r"$\Delta\gamma$",
        "work of adhesion of the law of the gap, above 0 attractive",
    ),
    *_of("interaction", "interface.law_of_the_gap", ("range", "z_r", "$z_r$", "range of the law of the gap")),
    *(
        Axis(f"{body}_{key}", f"{body}.roughness", f"{symbol}_{number}", f"${label}_{number}$", f"{name}, of {of}", key)
        for number, body, of in (
            (1, "body", "the surface of the body"),
            (2, "counter_body", "the surface of the counter body"),
        )
        for key, symbol, label, name in (
            ("hurst", "H", "H", "Hurst exponent"),
            ("rms_gradient", "g", r"\bar{g}", "rms gradient asked for"),
            ("rms_height", "h", r"\bar{h}", "rms height asked for"),
        )
    ),
    *_of(
        "counter_body",
        "counter_body",
        ("youngs_modulus", "E_2", "$E_2$", "Young's modulus of the counter body"),
        ("poissons_ratio", "nu_2", r"$\nu_2$", "Poisson's ratio of the counter body"),
        ("aspect_ratio", "a_2", "$a_2$", "thickness of the counter body over the period"),
    ),
    Axis("eps_c", "", "eps_c", r"$\varepsilon_c$", "continuum discretisation 2 k_s/nx"),
    Axis("eps_f", "", "eps_f", r"$\varepsilon_f$", "fractal discretisation k_l/k_s"),
    Axis("eps_t", "", "eps_t", r"$\varepsilon_t$", "thermodynamic discretisation 1/k_l"),
)
OF_THE_SCENE = tuple(axis for axis in AXES if axis.record)
DISCRETISATIONS = tuple(axis.name for axis in AXES if not axis.record)


def present(scene: Scene, discretisation: Discretisation | None) -> tuple[Axis, ...]:
    """Return the axes on which a case has a value; all cases of a campaign have values on the same ones."""
    return tuple(axis for axis in AXES if axis.value(scene, discretisation) is not None)


def with_values(scene: Scene, values: Mapping[Place, Any]) -> Scene:
    """Return the scene with other values in some places, whose records it has."""
    return scene.model_copy(update=_updates(scene, {in_fields(scene, place): value for place, value in values.items()}))


def in_fields(scene: Scene, place: Place) -> Place:
    """Return a place by fields alone: a property finds a record that one of several fields may hold."""
    if place[:-1] != ("interface", "law_of_the_gap"):
        return place
    law = scene.interface.law_of_the_gap
    return ("interface", next(name for name, each in scene.interface.laws.items() if each is law), place[-1])


def _updates(record: BaseModel, values: Mapping[Place, Any]) -> dict[str, Any]:
    inner: dict[str, list[tuple[Place, Any]]] = {}
    update: dict[str, Any] = {}
    for (name, *rest), value in values.items():
        if rest:
            inner.setdefault(name, []).append((tuple(rest), value))
        else:
            update[name] = value
    return update | {name: _part(getattr(record, name), tuple(given)) for name, given in inner.items()}


@lru_cache(maxsize=4096)
def _part(part: BaseModel, values: tuple[tuple[Place, Any], ...]) -> BaseModel:
    """Return a part of a scene with other values; equal parts of many cases are one record."""
    return part.model_copy(update=_updates(part, dict(values)))


Value = TypeVar("Value")


def _distinct(values: tuple[Value, ...]) -> tuple[Value, ...]:
    seen = set()
    for i, value in enumerate(values):
        if value in seen:
            raise broken_rule((i,), "each value once")
        seen.add(value)
    return values


Values = Annotated[tuple[Value, ...], Field(min_length=1, strict=False), AfterValidator(_distinct)]


if TYPE_CHECKING:
    Grid = BaseModel  # the fields are those of the table
else:
    Grid = create_model(
        "Grid",
        __config__=RECORD,
        __doc__="Parameters taken as a full product, each in place of the scene's or reference's value.",
        **{axis.name: (Values[axis.type] | None, Field(None, description=axis.long_name)) for axis in AXES},
    )


def values_of(grid: Grid, axis: str) -> tuple[Any, ...] | None:
    """Return the values that a grid gives to an axis, numbers or names, or None."""
    given: tuple[Any, ...] | None = getattr(grid, axis)
    if given is None:
        return None  # whether a number has a unit, only `Campaign` needs to know
    return tuple(float(value) if isinstance(value, float) else value for value in given)


def varied_scenes(scene: Scene, grid: Grid) -> Iterator[Scene]:
    """Yield the scene with each single value of a grid."""
    for axis in OF_THE_SCENE:
        for value in values_of(grid, axis.name) or ():
            yield with_values(scene, {axis.place: value})


def check_grid(document: Document, scene: Scene, grid: Grid) -> None:
    """Raise InputError for values of a parameter that a scene has not, or that break a rule of the scene."""
    for axis in OF_THE_SCENE:
        at = ("grid", axis.name)
        if values_of(grid, axis.name) is not None and (lack := _lack(scene, axis)):
            raise document.refused(at, lack)
    for record in dict.fromkeys(axis.record for axis in OF_THE_SCENE if not axis.of_surface):
        _check_together(document, scene, grid, record, _fault)


def check_surfaces_of_grid(document: Document, scene: Scene, grid: Grid) -> None:
    """Raise InputError for values of a grid that together make no surface, or one that does not fit its period."""

    def fault(varied: Scene) -> tuple[str, str] | None:
        surface = varied.roughness
        return None if surface is None else _fault(surface) or surface.misfit(scene.length or 1.0)

    _check_together(document, scene, grid, "roughness", fault)


def _check_together(
    document: Document, scene: Scene, grid: Grid, record: str, fault_of: Callable[[Scene], tuple[str, str] | None]
) -> None:
    """Raise InputError, at the value to blame, for values of the axes of a record that have a fault together.

    A value of the grid takes the place of the scene's, so that each value is checked with the grid's others.
    """
    for values, locations in values_together(grid, record):
        fault = fault_of(with_values(scene, values)) if values else None
        if fault is None:
            continue
        key, allowed = fault
        *parts, _ = place = next(iter(values))
        if (*parts, key) in values:
            place = (*parts, key)
        else:
            if getattr(attrgetter(record)(scene), key, None) is not None:
                allowed = f"a value for which {key} is {allowed}"
            to_blame = (each for each, value in values.items() if fault_of(with_values(scene, {each: value})))
            place = next(to_blame, list(values)[-1])
        raise document.refused(locations[place], allowed)


def values_together(grid: Grid, record: str) -> Iterator[tuple[dict[Place, Any], dict[Place, Location]]]:
    """Yield the values of the axes of a record by their places in the scene, and where each stands in the file."""
    axes = [axis for axis in OF_THE_SCENE if axis.record == record and values_of(grid, axis.name)]
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
        said = said.replace(f"{dotted(in_fields(scene, axis.place))} is ", f"grid.{axis.name} is ")
    return said


def _fault(record: BaseModel) -> tuple[str, str] | None:
    """Return the key of the first value that breaks a rule (empty for several), and what is allowed; or None."""
    try:
        type(record).model_validate_json(record.model_dump_json())  # which forgets what had units
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        context = fault.get("ctx", {})
        location = (*fault["loc"], *context.get("location", ()))
        allowed = context["allowed"] if "allowed" in context else allowed_at(type(record), fault["loc"])
        return str(location[-1]) if location else "", allowed
    return None


def _lack(scene: Scene, axis: Axis) -> str:
    """Return what is allowed instead of an axis for which the scene has no parameter; empty if it has one."""
    record: Any = scene
    for name in axis.place[:-1]:
        record = getattr(record, name, None)
    if record is None and axis.record == "interface.law_of_the_gap":
        return "nothing without a law of the gap in scene.interface, whose values those of the grid then replace"
    *parts, key = axis.place
    home = ".".join(("scene", *parts))
    if isinstance(record, Random) and key not in type(record).model_fields:
        return f"nothing, as {home} with {record.named_by} {getattr(record, record.named_by)} has no {key}"
    if key not in getattr(type(record), "model_fields", ()):
        return f"nothing without {home}.{key}: add `{key}` to {home}; the values of the grid then replace it"
    if record is scene.loading and getattr(record, key) is None:
        return f"nothing, as the loading is a {next(name for name, value in scene.loading if value is not None)}"
    return ""
