"""Frozen records of what the user describes; an effect absent from the scene is `None`."""

from collections.abc import Mapping
from fractions import Fraction
from math import ceil, floor, isclose
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, Self

from pydantic import BaseModel, BeforeValidator, Field, PlainSerializer, PlainValidator, WithJsonSchema, model_validator

from gfmd_numba.scene.body_record import Body
from gfmd_numba.scene.form_record import Form
from gfmd_numba.scene.interface_records import Interface
from gfmd_numba.scene.loading import ONE_LOAD, Loading, Step, check_loading
from gfmd_numba.scene.measured_record import AXES, Measured
from gfmd_numba.scene.quantities import (
    FILES,
    LARGEST,
    RECORD,
    Damping,
    Dimension,
    EpsC,
    EpsF,
    EpsT,
    Length,
    Seed,
    TimeStep,
    broken_rule,
    check_scales,
    check_seed,
)
from gfmd_numba.scene.surfaces import Random, Surface
from gfmd_numba.scene.units import LENGTH, PRESSURE, Quantity, in_reduced_units

_PERIODIC = "true or false, or on maps x or y, for surfaces that repeat along that axis alone and end along the other"
_TOLERANCE = "a number from 0 to 0.1, or exact"
TIME_TOLERANCE = 1e-2
_SLOPE_ORDER = {1: 2, 2: 0}  # to which topographies are followed at most, by the dimension, unless one is asked for
_WIDER_THAN_A_WINDOW = 2  # periods of a random surface over the length of its window, so that its ends do not meet


class Component(NamedTuple):
    """A component of displacements and tractions: how its keys begin and end, and which way it is positive."""

    name: str
    end: str
    way: str

    def key(self, quantity: str) -> str:
        """Key of the traction or the displacement of this component."""
        return f"{self.name}_{quantity}{self.end}"


_ALONG_X, _ALONG_Y = Component("tangential", "", "along x"), Component("tangential", "_y", "along y")
_NORMAL = Component("normal", "", "out of it")
COMPONENTS = {1: (_ALONG_X, _NORMAL), 2: (_ALONG_X, _ALONG_Y, _NORMAL)}  # by the dimension of the surface


def _of_nodes(quantity: Quantity) -> Any:
    """Type of a value for every node, or of a file of them: one check for the union, which would tell faults twice."""
    allowed = (
        f"a number up to 1e30 in size or {quantity.allowed}, for every node, "
        "or the name of a .npy or .csv file with one value for each node"
    )

    def check(given: Any) -> float | str:
        if isinstance(given, str) and given.endswith(FILES):
            return given
        if type(given) in (int, float) and -LARGEST <= given <= LARGEST:
            return float(given)
        raise ValueError(allowed)

    plain = PlainSerializer(lambda value: value if isinstance(value, str) else float(value), when_used="json")
    schema = WithJsonSchema({"allowed": allowed, "unit": quantity.si})
    return Annotated[float | str, PlainValidator(check), quantity, schema, plain]


if TYPE_CHECKING:
    Traction = float | str
    Displacement = float | str
else:
    Traction, Displacement = _of_nodes(PRESSURE), _of_nodes(LENGTH)


class Boundary(BaseModel):
    """What is prescribed on the surface of the body, positive out of it, along x and y; nothing is a traction of 0.

    A value, or a file with not-a-number for each node where that is not prescribed.
    """

    model_config = RECORD
    normal_traction: Traction | None = Field(None, description="Pull out of the body in Pa (E* without moduli)")
    tangential_traction: Traction | None = Field(None, description="Pull along x in Pa (E* without moduli)")
    normal_displacement: Displacement | None = Field(None, description="Out of the body, in m (L_x without a length)")
    tangential_displacement: Displacement | None = Field(None, description="Along x, in m (L_x without a length)")
    tangential_traction_y: Traction | None = Field(None, description="Pull along y, on maps")
    tangential_displacement_y: Displacement | None = Field(None, description="Along y, on maps")

    @model_validator(mode="after")
    def _prescribes(self) -> Self:
        if all(value is None for _, value in self):
            raise broken_rule((), "at least one of " + ", ".join(type(self).model_fields))
        return self


def _periodic(given: Any) -> Any:
    if given not in (True, False, *AXES) or (isinstance(given, (int, float)) and not isinstance(given, bool)):
        raise ValueError(_PERIODIC)
    return given


# checked before the union of types, which would tell every fault twice
Periodic = Annotated[bool | Literal["x", "y"], BeforeValidator(_periodic), WithJsonSchema({"allowed": _PERIODIC})]


def ends_of(periodic: object, dimension: int) -> tuple[bool, ...]:
    """Whether surfaces that are `periodic` along both axes, one or none end along (y,) x."""
    return tuple(periodic is not True and axis != periodic for axis in AXES[-dimension:])


_OF_A_PUNCH = {"roughness", "form", "counter_body", "interface", "loading"}


class Scene(BaseModel):
    """One contact problem: body, roughness, interface, loading and the period L_x in m; or a body without a punch.

    Without a punch, on whose surface a `boundary` prescribes all, nothing acts between surfaces, and nothing is loaded.
    """

    model_config = RECORD
    body: Body = Field(description="Elastic body")
    roughness: Surface | None = Field(None, description="The rigid punch's roughness; None: flat")
    form: Form | None = Field(None, description="Smooth form of the punch, under its roughness or alone; None: flat")
    counter_body: Body | None = Field(None, description="A second elastic body in place of the rigid punch")
    interface: Interface = Field(default_factory=Interface, description="Interaction between body and punch")
    loading: Loading = Field(default_factory=Loading, description="Load or displacement control")
    boundary: Boundary | None = Field(
        None, description="Tractions that act on the body before the punch does; without a punch also displacements"
    )
    length: Length | None = Field(
        None,
        description="Period L_x in m; None: that of a measured file with positions, and otherwise lengths are in L_x",
    )
    dimension: Dimension = Field(1, description="1: profiles, in plane strain; 2: maps, of period L_x both ways")
    periodic: Periodic = Field(
        True,
        description="Whether the surfaces repeat; false: a window of length L_x, around which the body is free; x "
        "or y: they repeat along that axis alone, and the body is free on both sides along the other",
    )

    @property
    def has_punch(self) -> bool:
        """Whether a punch, or a counter body, is pressed on the body."""
        return bool(self.loading.control)

    @property
    def ends(self) -> tuple[bool, ...]:
        """Whether the punch ends along (y,) x, where the body is free around it."""
        return ends_of(self.periodic, self.dimension)

    @property
    def deformable(self) -> dict[str, Body]:
        """The elastic bodies by their names."""
        return {"body": self.body} | ({} if self.counter_body is None else {"counter_body": self.counter_body})

    @property
    def creeps(self) -> bool:
        """Whether a body is viscoelastic."""
        return any(body.relaxation is not None for body in self.deformable.values())

    @property
    def passes(self) -> bool:
        """Whether a punch that slides passes over the body: over one that creeps, unless it drags that or wears."""
        return self.creeps and self.interface.wear is None and not self.interface.couples

    @property
    def has_slip_rates(self) -> bool:
        """Whether friction depends on the slip rate, so that each step takes time."""
        return self.interface.friction is not None and self.interface.friction.depends_on_rate

    @property
    def wears_by_slip(self) -> bool:
        """Whether each node wears by its own slip, as under friction."""
        return self.interface.wear is not None and self.interface.friction is not None

    @property
    def has_moduli(self) -> bool:
        """Whether all elastic bodies have a Young's modulus, so that stresses are in Pa; two bodies need one each.

        Layers with 1 for the topmost are ratios, as no material is as soft as 1 Pa.
        """
        known = (None, 1.0) if self.body.layers is not None else (None,)
        return self.counter_body is not None or self.body.surface_modulus not in known

    @property
    def thinnest_layer(self) -> float:
        """Height of the thinnest layer of the elastic bodies over the period, inf for half-spaces."""
        return min(body.thinnest_layer(self.length) for body in self.deformable.values())

    @property
    def surfaces(self) -> dict[tuple[str, ...], Surface]:
        """The rough surfaces of punch and bodies, by their places in the scene."""
        places: dict[tuple[str, ...], Surface | None] = {("roughness",): self.roughness}
        places |= {(name, "roughness"): body.roughness for name, body in self.deformable.items()}
        return {place: surface for place, surface in places.items() if surface is not None}

    @property
    def periods(self) -> int:
        """How many times as wide random surfaces are made as is cut out of them."""
        return 1 if self.periodic else _WIDER_THAN_A_WINDOW

    @property
    def fields_in_period(self) -> int:
        """How often a measured field is in a period: more than once where all surfaces are mirrored.

        A form stands on one of them, and the contact with it.
        """
        mirrored = [isinstance(each, Measured) and each.periodic == "mirror" for each in self.surfaces.values()]
        return 2 ** self.ends.count(False) if mirrored and all(mirrored) and self.form is None else 1

    @property
    def in_periods(self) -> Self:
        """The same, with lengths of the form in L_x, and those of random surfaces in the period they are made with."""
        length = self.length or 1.0

        def reduced(surface: Surface | None) -> Surface | None:
            return in_reduced_units(surface, self.periods * length, 1.0) if isinstance(surface, Random) else surface

        update: dict[str, object] = {"roughness": reduced(self.roughness)}
        for name, body in self.deformable.items():
            update[name] = body.model_copy(update={"roughness": reduced(body.roughness)})
        if self.form is not None:
            update["form"] = in_reduced_units(self.form, length, 1.0)
        return self.model_copy(update=update)

    @property
    def follows_topography(self) -> bool:
        """Whether a deformable surface is rough, or both bodies deform."""
        return self.counter_body is not None or self.body.roughness is not None

    @property
    def touches_inclined(self) -> bool:
        """Whether the surfaces that touch are inclined: all but those of a rough body under a level rigid punch."""
        upper = (self.counter_body, self.roughness, self.form)
        return self.follows_topography and any(each is not None for each in upper)

    @property
    def awaits_period(self) -> bool:
        """Whether the file of a measured surface may tell the period: what depends on it is checked by then."""
        return self.length is None and any(isinstance(surface, Measured) for surface in self.surfaces.values())

    @model_validator(mode="before")
    @classmethod
    def _needs_of_a_punch(cls, given: Any) -> Any:
        """What acts on a punch, as nothing where it is missing: only a body with a boundary alone does without."""
        if isinstance(given, Mapping) and ("boundary" not in given or _OF_A_PUNCH & given.keys()):
            return {"interface": None, "loading": None} | dict(given)
        return given

    @model_validator(mode="after")
    def _needs_a_load(self) -> Self:
        alone = self.surfaces.keys() <= {("body", "roughness")} and self.form is None and self.counter_body is None
        if alone and self.boundary is not None and not self.has_punch and self.interface == Interface():
            return self
        if not self.interface.keeps_apart:
            raise broken_rule(
                ("interface",),
                "hard_wall: {}, cohesive, lennard_jones, or an exponential or power law that repels: something must "
                "keep the bodies apart",
            )
        if not self.has_punch:
            raise broken_rule(("loading",), ONE_LOAD)
        return self

    @model_validator(mode="after")
    def _bodies_agree(self) -> Self:
        counter = self.counter_body
        if self.has_punch and self.form is None and not self.surfaces:
            raise broken_rule(
                ("roughness",),
                "a mapping with a method like 'psd' or 'measured', here for the punch or inside body for the body "
                "itself, or a form",
            )
        if self.form is not None and (self.form.points is None) == (not self.surfaces):
            allowed = (
                "grid points over L_x, as no roughness has any" if not self.surfaces else "nothing with a roughness"
            )
            raise broken_rule(("form", "points"), allowed)
        if counter is not None:
            if self.roughness is not None:
                raise broken_rule(
                    ("roughness",), "no punch next to a counter_body: move this roughness into body or counter_body"
                )
            for name, body in self.deformable.items():
                if body.surface_modulus is None:
                    allowed = "a number above 0 for both bodies, as they share the load"
                    raise broken_rule((name, "youngs_modulus"), allowed)
            if counter.state != self.body.state:
                raise broken_rule(("counter_body", "state"), f"{self.body.state!r}, as that of the body")
        if not self.awaits_period:
            self.check_period()
        return self

    def check_period(self) -> None:
        """Raise a located PydanticCustomError for layers that do not fit the period, and units that need one."""
        for name, body in self.deformable.items():
            body.check_layers((name,), self.length)
        if self.has_punch:
            check_loading(self.loading, self.length, self.has_moduli, bool(self.surfaces))
        check_scales(self, self.length, self.has_moduli)
        wrong = None if self.form is None else self.form.misfit(self.length or 1.0)
        if wrong is not None:
            raise broken_rule(("form", wrong[0]), wrong[1])


class Discretisation(BaseModel):
    """The three dimensionless discretisations; their products must give whole wave numbers."""

    model_config = RECORD
    eps_c: EpsC
    eps_f: EpsF
    eps_t: EpsT

    @property
    def waves(self) -> dict[str, float]:
        """Unrounded k_l, k_s and nx under the discretisation that each needs beyond those before it."""
        longest = 1 / self.eps_t
        shortest = longest / self.eps_f
        return {"eps_t": longest, "eps_f": shortest, "eps_c": 2 * shortest / self.eps_c}

    @property
    def longest_wave_index(self) -> int:
        """Wave index of the longest roughness wavelength, k_l = 1/eps_t."""
        return round(self.waves["eps_t"])

    @property
    def shortest_wave_index(self) -> int:
        """Wave index of the shortest roughness wavelength, k_s = 1/(eps_t eps_f)."""
        return round(self.waves["eps_f"])

    @property
    def nx(self) -> int:
        """Number of grid points over the period, 2/(eps_t eps_f eps_c)."""
        return round(self.waves["eps_c"])

    @property
    def misfit(self) -> str | None:
        """First discretisation whose waves are not whole, eps_c for fewer than 4 grid points, or None."""
        uneven = (axis for axis, n in self.waves.items() if not isclose(n, round(n), rel_tol=1e-9))
        return next(uneven, "eps_c" if self.nx < 4 else None)

    def nearest_fit(self, axis: str) -> Fraction | None:
        """Value on one axis nearest to the present one that leaves no misfit, or None."""
        present = getattr(self, axis)
        unit = round(self.waves[axis] * present)
        fits = []
        for start, step in ((floor(unit / present), -1), (ceil(unit / present), 1)):
            numbers = range(start, start + 1000 * step, step)
            candidates = (Fraction(unit, n) for n in numbers if n >= max(unit, 1))
            fit = next((c for c in candidates if self.model_copy(update={axis: float(c)}).misfit is None), None)
            fits += [] if fit is None else [fit]
        return min(fits, key=lambda fit: abs(fit - Fraction(present)), default=None)


def _tolerance(given: Any) -> Any:
    if given != "exact" and not (type(given) in (int, float) and 0 <= given <= 0.1):
        raise ValueError(_TOLERANCE)
    return given


# checked before the union of types, which would tell every fault twice
Tolerance = Annotated[float | Literal["exact"], BeforeValidator(_tolerance), WithJsonSchema({"allowed": _TOLERANCE})]


class Numerics(BaseModel):
    """How the problem is solved; every number is dimensionless."""

    model_config = RECORD
    solver: str = Field("auto", description="Solver: a name of the table of solvers, or auto")
    topography_order: int | None = Field(
        None,
        ge=0,
        le=3,
        description="Order in the slope of a deformable body's own roughness; 0: two-step GFMD of the thesis, None: 2, "
        "and 0 for maps, without a period, and with friction, a cohesive law, a hardness, a boundary, layers or creep",
    )
    residual: float = Field(1e-8, gt=0, le=1e-2, description="Relative residual at which a run stops")
    max_iterations: int = Field(200_000, ge=1, description="Iterations after which a run is not converged")
    threads: int = Field(
        1, ge=1, description="Threads that share the work on a map, at most one for each core; results are the same"
    )
    time_step: TimeStep | None = Field(
        None, description="Time step as a fraction of the stability limit; None: the solver's own"
    )
    effects: Tolerance = Field(
        1e-4, description="Largest relative change of kappa that leaving out an effect may cause"
    )
    time_tolerance: float | None = Field(
        None,
        gt=0,
        le=0.1,
        description="Largest relative error of pressures and displacements by the divisions of steps along a path, of "
        f"a viscoelastic body or of wear; None: {TIME_TOLERANCE:g}",
    )
    damping: Damping | None = Field(
        None, description="Damping as a fraction of the slowest mode's critical damping; None: the solver's own"
    )

    def slope_order(self, scene: Scene) -> int:
        """Order in the slope to which the topographies of a scene are followed: 2, or 0, unless one is asked for."""
        if self.topography_order is not None:
            return self.topography_order
        layered = any(body.layers is not None for body in scene.deformable.values()) or scene.form is not None
        further = scene.interface.couples or scene.interface.hardness is not None
        further |= scene.has_punch and scene.boundary is not None
        return 0 if layered or further or scene.creeps or any(scene.ends) else _SLOPE_ORDER[scene.dimension]


Surfaces = Mapping[tuple[str, ...], Surface]  # by their places in a scene


def check_waves(surfaces: Surfaces, length: float | None) -> None:
    """Raise a located PydanticCustomError for waves that do not fit the period, L_x in m or None."""
    for place, surface in surfaces.items():
        wrong = surface.misfit(length or 1.0)
        if wrong is not None:
            raise broken_rule(("scene", *place, wrong[0]), wrong[1])


class SceneFile(BaseModel):
    """A scene with its numerics, discretisation and random realisation."""

    model_config = RECORD
    scene: Scene = Field(description="What is in contact, or loaded without a punch")
    numerics: Numerics = Field(Numerics(), description="How it is solved")
    points: int | None = Field(
        None,
        ge=4,
        le=2**22,
        description="Nodes over the period of a flat body without a punch, of maps both ways; None: as many as in the "
        "files of its boundary",
    )
    discretisation: Discretisation | None = Field(
        None, description="Grid and wavelengths of random surfaces without points of their own"
    )
    seed: Seed = 0
    realisation: int = Field(0, ge=0, lt=2**63, description="Which realisation of the random surface")
    path: tuple[Step, ...] = Field(
        (), strict=False, description="Loadings after the first one, each begun where the last one ended"
    )

    @property
    def slope_order(self) -> int:
        """Order in the slope to which the topographies of its scene are followed."""
        return self.numerics.slope_order(self.scene)

    @model_validator(mode="after")
    def _parts_agree(self) -> Self:
        surfaces = self.scene.surfaces.values()
        needed = any(surface.needs_discretisation for surface in surfaces)
        if self.discretisation is None and needed:
            raise broken_rule(
                ("discretisation",),
                "a mapping like {eps_c: 0.25, eps_f: 0.01, eps_t: 0.25}, as a random surface has no points of its own",
            )
        if self.discretisation is not None and not needed:
            raise broken_rule(("discretisation",), "nothing, as every surface has its own grid")
        check_seed(self.seed, self.realisation, any(isinstance(surface, Random) for surface in surfaces))
        if self.path and not self.scene.has_punch:
            raise broken_rule(("path",), "nothing without a punch, whose loading it changes")
        for i, step in enumerate(self.path):
            step.check(self.scene.loading, i)
        if self.scene.has_punch or self.scene.follows_topography:
            if self.points is not None:
                raise broken_rule(("points",), "nothing here, as the surfaces have a grid of their own")
        elif self.points is None and not any(isinstance(values, str) for _, values in self.scene.boundary or ()):
            raise broken_rule(("points",), "the number of nodes, as no file of the boundary gives it")
        if not self.scene.awaits_period:
            self.check_period()
        return self

    def check_period(self) -> None:
        """Raise a located PydanticCustomError for waves that do not fit the period, and steps that need one."""
        check_waves(self.scene.surfaces, self.scene.length)
        check_scales(self.path, self.scene.length, self.scene.has_moduli, ("path",))
