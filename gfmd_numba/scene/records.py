"""Frozen records of what the user describes; an effect absent from the scene is `None`."""

from collections.abc import Mapping
from fractions import Fraction
from math import ceil, floor, isclose
from typing import Annotated, Any, Literal, Protocol, Self

from pydantic import BaseModel, BeforeValidator, Field, WithJsonSchema, model_validator

from gfmd_numba.scene.bodies import check_bodies, check_stacks
from gfmd_numba.scene.body_record import Body
from gfmd_numba.scene.boundary_records import Boundary
from gfmd_numba.scene.interface_records import Interface
from gfmd_numba.scene.loading import Loading, Step, check_loading
from gfmd_numba.scene.measured_record import Measured
from gfmd_numba.scene.quantities import (
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


class Scene(BaseModel):
    """One contact problem: body, roughness, interface, loading and the period L_x in m."""

    model_config = RECORD
    body: Body = Field(description="Elastic body")
    roughness: Surface | None = Field(None, description="The rigid punch's roughness; None: flat")
    counter_body: Body | None = Field(None, description="A second elastic body in place of the rigid punch")
    interface: Interface = Field(description="Interaction between body and punch")
    loading: Loading = Field(description="Load or displacement control")
    boundary: Boundary | None = Field(None, description="Tractions that act on the body before the punch does")
    length: Length | None = Field(
        None,
        description="Period L_x in m; None: that of a measured file with positions, and otherwise lengths are in L_x",
    )
    dimension: Dimension = Field(1, description="1: profiles, in plane strain; 2: maps, of period L_x both ways")

    @property
    def deformable(self) -> tuple[Body, ...]:
        """The elastic bodies."""
        return (self.body,) if self.counter_body is None else (self.body, self.counter_body)

    @property
    def has_moduli(self) -> bool:
        """Whether all elastic bodies have a Young's modulus, so that stresses are in Pa; two bodies need one each."""
        return self.counter_body is not None or self.body.has_modulus

    @property
    def surfaces(self) -> dict[tuple[str, ...], Surface]:
        """The rough surfaces of punch and bodies, by their places in the scene."""
        places = {("roughness",): self.roughness, ("body", "roughness"): self.body.roughness}
        if self.counter_body is not None:
            places["counter_body", "roughness"] = self.counter_body.roughness
        return {place: surface for place, surface in places.items() if surface is not None}

    @property
    def follows_topography(self) -> bool:
        """Whether a deformable surface is rough, or both bodies deform."""
        return self.counter_body is not None or self.body.roughness is not None

    @property
    def touches_inclined(self) -> bool:
        """Whether the surfaces that touch are inclined: all but those of a rough body under a level rigid punch."""
        return self.follows_topography and (self.counter_body is not None or self.roughness is not None)

    @property
    def knows_lowest_order_only(self) -> bool:
        """Whether what acts on rough deformable surfaces is followed at order 0 in their slope unless asked for."""
        layered = any(body.layers is not None for body in self.deformable)
        further = self.interface.couples or self.interface.hardness is not None or self.boundary is not None
        return self.dimension == 2 or layered or further

    @property
    def awaits_period(self) -> bool:
        """Whether the file of a measured surface may tell the period: what depends on it is checked by then."""
        return self.length is None and any(isinstance(surface, Measured) for surface in self.surfaces.values())

    @model_validator(mode="after")
    def _bodies_agree(self) -> Self:
        check_bodies(self)
        if not self.awaits_period:
            self.check_period()
        return self

    def check_period(self) -> None:
        """Raise a located PydanticCustomError for layers that do not fit the period, and units that need one."""
        check_stacks(self)
        check_loading(self.loading, self.length, self.has_moduli)
        check_scales(self, self.length, self.has_moduli)


class Discretisation(BaseModel):
    """The three dimensionless discretisations; their products must give whole wave numbers."""

    model_config = RECORD
    eps_c: EpsC
    eps_f: EpsF
    eps_t: EpsT

    @property
    def waves(self) -> dict[str, float]:
        """Unrounded k_l, k_s and nx under the discretisation that each needs beyond those before it."""
        cut_on = 1 / self.eps_t
        cut_off = cut_on / self.eps_f
        return {"eps_t": cut_on, "eps_f": cut_off, "eps_c": 2 * cut_off / self.eps_c}

    @property
    def cut_on_index(self) -> int:
        """Wave index of the longest roughness wavelength, k_l = 1/eps_t."""
        return round(self.waves["eps_t"])

    @property
    def cut_off_index(self) -> int:
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


_TOLERANCE = "a number from 0 to 0.1, or exact"


def _tolerance(given: Any) -> Any:
    if given != "exact" and not (type(given) in (int, float) and 0 <= given <= 0.1):
        raise ValueError(_TOLERANCE)
    return given


# checked before the union of types, which would tell every fault twice
Tolerance = Annotated[float | Literal["exact"], BeforeValidator(_tolerance), WithJsonSchema({"allowed": _TOLERANCE})]


SINGLE_RESIDUAL = 1e-3  # the least that single precision is asked for


class _Rough(Protocol):
    """A scene whose deformable bodies may be rough."""

    @property
    def knows_lowest_order_only(self) -> bool:
        """Whether order 0 in the slope is the one to take unless a higher one is asked for."""
        ...


class Numerics(BaseModel):
    """How the problem is solved; every number is dimensionless."""

    model_config = RECORD
    solver: str = Field("auto", description="Solver: a name of the table of solvers, or auto")
    topography_order: int | None = Field(
        None,
        ge=0,
        le=3,
        description="Order in the slope of a deformable body's own roughness; 0: two-step GFMD of the thesis, None: 2, "
        "and 0 for maps, and with friction, a cohesive law, a hardness, a boundary or layers",
    )
    residual: float = Field(1e-8, gt=0, le=1e-2, description="Relative residual at which a run stops")
    max_iterations: int = Field(200_000, ge=1, description="Iterations after which a run is not converged")
    time_step: TimeStep | None = Field(
        None, description="Time step as a fraction of the stability limit; None: the solver's own"
    )
    effects: Tolerance = Field(
        1e-4, description="Largest relative change of kappa that leaving out an effect may cause"
    )
    precision: Literal["double", "single"] = Field("double", description="Precision of the solver's numbers")
    damping: Damping | None = Field(
        None, description="Damping as a fraction of the slowest mode's critical damping; None: the solver's own"
    )

    def slope_order(self, scene: _Rough) -> int:
        """Order in the slope to which the topographies of a scene are followed."""
        if self.topography_order is None:
            return 0 if scene.knows_lowest_order_only else 2
        return self.topography_order

    @model_validator(mode="after")
    def _residual_is_within_precision(self) -> Self:
        if self.precision == "single" and self.residual < SINGLE_RESIDUAL:
            raise broken_rule(
                ("residual",),
                f"at least {SINGLE_RESIDUAL:g} in single precision, whose rounding alone leaves about 1e-8 nx",
            )
        return self


Surfaces = Mapping[tuple[str, ...], Surface]  # by their places in a scene


def check_drawing(surfaces: Surfaces, discretisation: Discretisation | None, seed: int, realisation: int) -> None:
    """Raise a located PydanticCustomError unless surfaces have a grid each, and a seed if one of them is random."""
    needed = any(surface.needs_discretisation for surface in surfaces.values())
    if discretisation is None and needed:
        raise broken_rule(
            ("discretisation",),
            "a mapping with eps_c, eps_f and eps_t, which a random surface without points of its own needs",
        )
    if discretisation is not None and not needed:
        raise broken_rule(("discretisation",), "nothing, as every surface has its own grid")
    check_seed(seed, realisation, any(isinstance(surface, Random) for surface in surfaces.values()))


def check_waves(surfaces: Surfaces, length: float | None) -> None:
    """Raise a located PydanticCustomError for waves that do not fit the period, L_x in m or None."""
    for place, surface in surfaces.items():
        wrong = surface.misfit(length or 1.0)
        if wrong is not None:
            raise broken_rule(("scene", *place, wrong[0]), wrong[1])


class SceneFile(BaseModel):
    """A scene with its numerics, discretisation and random realisation."""

    model_config = RECORD
    scene: Scene = Field(description="What is in contact")
    numerics: Numerics = Field(Numerics(), description="How it is solved")
    discretisation: Discretisation | None = Field(
        None, description="Grid and wavelengths of random surfaces without points of their own"
    )
    seed: Seed = 0
    realisation: int = Field(0, ge=0, lt=2**63, description="Which realisation of the random surface")
    path: tuple[Step, ...] = Field(
        (), strict=False, description="Loadings after the first one, each begun where the last one ended"
    )

    @model_validator(mode="after")
    def _parts_agree(self) -> Self:
        check_drawing(self.scene.surfaces, self.discretisation, self.seed, self.realisation)
        for i, step in enumerate(self.path):
            step.check(self.scene.loading, i)
        if not self.scene.awaits_period:
            self.check_period()
        return self

    def check_period(self) -> None:
        """Raise a located PydanticCustomError for waves that do not fit the period, and steps that need one."""
        check_waves(self.scene.surfaces, self.scene.length)
        check_scales(self.path, self.scene.length, self.scene.has_moduli, ("path",))
