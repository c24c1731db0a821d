"""The campaign file: a scene, a reference discretisation, and what varies around it."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from math import inf, prod
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, Field, WithJsonSchema, model_validator

from gfmd_numba.campaign.axes import DISCRETISATIONS
from gfmd_numba.campaign.grid import Grid, Values, check_grid, check_surfaces_of_grid, values_of, varied_scenes
from gfmd_numba.campaign.source import Source, campaign_document, written
from gfmd_numba.contact.refusal import check_combination, check_keys
from gfmd_numba.scene.document import Document, Location
from gfmd_numba.scene.quantities import RECORD, EpsC, EpsF, EpsT, Seed, broken_rule
from gfmd_numba.scene.records import Discretisation, Numerics, Scene
from gfmd_numba.scene.scene_file import check_anisotropy_fits, check_discretisation, check_range, check_surfaces
from gfmd_numba.scene.surfaces import Measured
from gfmd_numba.scene.validation import validate

MOST_CASES = 1_000_000

EXPONENT = "a finite number above 0, or the range it lies in, [low, high]"


def _exponent(given: Any) -> float | tuple[float, float]:
    ends = given if isinstance(given, list | tuple) else (given, given)
    numbers = len(ends) == 2 and all(type(end) in (int, float) for end in ends)
    if not numbers or not 0 < ends[0] <= ends[1] < inf:
        raise ValueError(EXPONENT)
    return (float(ends[0]), float(ends[1])) if isinstance(given, list | tuple) else float(given)


# checked before the union of types, which would tell every fault twice
Exponent = Annotated[float | tuple[float, float], BeforeValidator(_exponent), WithJsonSchema({"allowed": EXPONENT})]


Count = Annotated[int, Field(ge=1, le=1_000_000, description="Random surfaces per case")]
COUNT = "a whole number from 1 to 1000000, or a mapping of such with the key reference and any of eps_c, eps_f, eps_t"
COUNTS = "a whole number from 1 to 1000000, or a list of such, one for each level of the limit (0: left out)"


def _counts(given: Any) -> int | tuple[int, ...]:
    listed = isinstance(given, list | tuple)
    numbers = given if listed else [given]
    if not numbers or not all(type(n) is int and (0 if listed else 1) <= n <= 1_000_000 for n in numbers):
        raise ValueError(COUNTS)
    return tuple(numbers) if listed else int(given)


Counts = Annotated[int | tuple[int, ...], BeforeValidator(_counts), WithJsonSchema({"allowed": COUNTS})]


class Realisations(BaseModel):
    """Random surfaces of each case, by its limit or level; a limit left out has as many as the reference."""

    model_config = RECORD
    reference: Count = Field(description="Random surfaces of each case at the reference")
    eps_c: Counts | None = Field(None, description="Random surfaces of each case of the continuum limit")
    eps_f: Counts | None = Field(None, description="Random surfaces of each case of the fractal limit")
    eps_t: Counts | None = Field(None, description="Random surfaces of each case of the thermodynamic limit")

    def of(self, limit: str, level: int) -> int:
        """Number for the cases at a level of a limit, counted as the campaign lists them."""
        given: int | tuple[int, ...] | None = getattr(self, limit)
        return given[level] if isinstance(given, tuple) else given or self.reference


def _realisations(given: Any) -> Any:
    if isinstance(given, dict | Realisations):
        return given
    if type(given) is not int or not 1 <= given <= 1_000_000:
        raise ValueError(COUNT)
    return {"reference": given}


_Realisations = Annotated[
    Realisations,
    BeforeValidator(_realisations),
    WithJsonSchema(Realisations.model_json_schema() | {"type": ["integer", "object"], "allowed": COUNT}),
]


class Limits(BaseModel):
    """Discretisations (dimensionless) taken one at a time around the reference."""

    model_config = RECORD
    eps_c: Values[EpsC] | None = Field(None, description="Continuum limit (dimensionless)")
    eps_f: Values[EpsF] | None = Field(None, description="Fractal limit (dimensionless)")
    eps_t: Values[EpsT] | None = Field(None, description="Thermodynamic limit (dimensionless)")


class FixedExponents(BaseModel):
    """Exponents (dimensionless) that the fit does not search: a value, or the range it lies in."""

    model_config = RECORD
    eps_c: Exponent | None = Field(None, description="Exponent of eps_c or its range (dimensionless)")
    eps_f: Exponent | None = Field(None, description="Exponent of eps_f or its range (dimensionless)")
    eps_t: Exponent | None = Field(None, description="Exponent of eps_t or its range (dimensionless)")


class Fit(BaseModel):
    """How the results are fitted to their limit."""

    model_config = RECORD
    variable: Literal["kappa", "kappa_counted", "kappa_r"] = Field("kappa", description="What is fitted")
    exponents: Literal["shared", "free"] = Field("shared", description="One set for all groups, or one for each")
    fixed: FixedExponents = Field(FixedExponents(), description="Exponents known beforehand")


class Campaign(BaseModel):
    """Grid product of cases, each at the reference and along its limits, times realisations."""

    model_config = RECORD
    name: str = Field(
        pattern=r"^[A-Za-z0-9_-][A-Za-z0-9._-]*$",
        max_length=100,
        description="Name of the campaign and of its output",
        json_schema_extra={"allowed": "up to 100 letters, digits, '.', '_' and '-', not starting with '.'"},
    )
    seed: Seed
    realisations: _Realisations = Field(description="Random surfaces of each case, a number or one for each limit")
    scene: Scene = Field(description="What is in contact")
    reference: Discretisation | None = Field(
        None, description="Discretisation around which the limits are taken; None: surfaces have points of their own"
    )
    limits: Limits = Field(Limits(), description="Discretisations one at a time")
    grid: Grid = Field(Grid(), description="Parameters as a full product")
    numerics: Numerics = Field(Numerics(), description="How it is solved")
    fit: Fit = Field(Fit(), description="How the results are fitted")
    target: float | None = Field(
        None, gt=0, lt=1, description="Relative standard error that the limit is meant to have (dimensionless)"
    )
    case_timeout: float | None = Field(
        None, gt=0, description="Seconds after which a block of realisations of a case is given up; None: never"
    )

    @property
    def n_cases(self) -> int:
        """Number of cases, without the realisations."""
        grid = prod(len(values) for _, values in self.grid if values is not None)
        return grid * (1 + sum(1 for _ in self._limit_values()))

    def discretisations(self) -> Iterator[tuple[Discretisation | None, dict[str, Location], str | None, int]]:
        """Each discretisation, where its values stand in the file, its limit or None, and its surfaces."""
        if self.reference is None:
            yield None, {}, None, self.realisations.reference
            return
        choices: list[list[tuple[float, Location]]] = []
        for axis in DISCRETISATIONS:
            values = getattr(self.grid, axis)
            choices.append(
                [(getattr(self.reference, axis), ("reference", axis))]
                if values is None
                else [(value, ("grid", axis, i)) for i, value in enumerate(values)]
            )
        for chosen in product(*choices):
            eps = {axis: value for axis, (value, _) in zip(DISCRETISATIONS, chosen, strict=True)}
            locations = {axis: location for axis, (_, location) in zip(DISCRETISATIONS, chosen, strict=True)}
            yield Discretisation(**eps), locations, None, self.realisations.reference
            for axis, i, value in self._limit_values():
                location: Location = ("limits", axis, i)
                surfaces = self.realisations.of(axis, i)
                yield Discretisation(**{**eps, axis: value}), {**locations, axis: location}, axis, surfaces

    def _limit_values(self) -> Iterator[tuple[str, int, float]]:
        for axis, values in self.limits:
            for i, value in enumerate(values or ()):
                if value != getattr(self.reference, axis) and self.realisations.of(axis, i) > 0:
                    yield axis, i, value

    @model_validator(mode="after")
    def _parts_agree(self) -> Self:
        needed = any(surface.needs_discretisation for surface in self.scene.surfaces.values())
        if needed and self.reference is None:
            raise broken_rule(("reference",), "a mapping with eps_c, eps_f and eps_t, as the surface has no points")
        measured = isinstance(self.scene.roughness, Measured)  # which is refused beside a campaign, as its file says
        if not needed and not measured and self.reference is not None:
            raise broken_rule(("reference",), "nothing, as the surface has points and lengths of its own")
        for axis in DISCRETISATIONS:
            if self.reference is None and getattr(self.fit.fixed, axis) is not None:
                raise broken_rule(("fit", "fixed", axis), "nothing, as the surface has points and lengths of its own")
            if self.reference is None and (getattr(self.limits, axis) or getattr(self.grid, axis)):
                where = "limits" if getattr(self.limits, axis) else "grid"
                raise broken_rule((where, axis), "nothing, as the surface has points and lengths of its own")
            if self.reference is None and getattr(self.realisations, axis) is not None:
                raise broken_rule(("realisations", axis), "nothing, as the surface has points and lengths of its own")
            if getattr(self.limits, axis) is not None and getattr(self.grid, axis) is not None:
                raise broken_rule(("grid", axis), f"{axis} in either limits or grid, not in both")
            counts, levels = getattr(self.realisations, axis), getattr(self.limits, axis) or ()
            if isinstance(counts, tuple) and len(counts) != len(levels):
                raise broken_rule(("realisations", axis), f"{len(levels)} numbers, as limits.{axis} has so many levels")
        for place, surface in self.scene.surfaces.items():
            wrong = surface.misfit(self.scene.length or 1.0)
            if wrong is not None:
                raise broken_rule(("scene", *place, wrong[0]), wrong[1])
        return self


def load_campaign(source: Source) -> tuple[Campaign, Document]:
    """Checked campaign of a YAML file or a mapping, and the document itself; raises InputError."""
    document = campaign_document(source)
    check_keys(document)
    campaign = validate(document, Campaign)
    varied = {name: values for name, values in campaign.grid if values is not None}
    check_combination(document, campaign.scene, campaign.numerics, grid=varied)
    check_grid(document, campaign.scene, campaign.grid)
    if document.path is None:
        document = replace(document, text=written(campaign))
    if campaign.n_cases > MOST_CASES:
        raise document.error(
            ("grid",), document.value(("grid",)), f"at most {MOST_CASES} cases, not {campaign.n_cases}"
        )
    check_surfaces_of_grid(document, campaign.scene, campaign.grid)
    anisotropies, ranges = list(_anisotropies(campaign)), list(_ranges(campaign))
    check_surfaces(document, campaign.scene)
    assert campaign.scene.roughness is not None  # the combinations' promise
    for discretisation, locations, limit, _ in campaign.discretisations():
        if discretisation is not None:
            for anisotropy, location in anisotropies:
                check_anisotropy_fits(document, anisotropy, location, discretisation)
            check_discretisation(document, discretisation, locations, limit, campaign.scene.dimension)
        nx = campaign.scene.roughness.points if discretisation is None else discretisation.nx
        assert nx is not None  # the records' promise
        for scene, place in ranges:
            check_range(document, scene, nx, place)
    return campaign, document


def _anisotropies(campaign: Campaign) -> Iterator[tuple[float, Location]]:
    """Each anisotropy of a campaign, and where it stands in the file."""
    own = getattr(campaign.scene.roughness, "anisotropy", None)
    if given := values_of(campaign.grid, "anisotropy"):
        yield from ((value, ("grid", "anisotropy", i)) for i, value in enumerate(given))
    elif own is not None:
        yield own, ("scene", "roughness", "anisotropy")


def _ranges(campaign: Campaign) -> list[tuple[Scene, Location | None]]:
    """Scenes with each interaction range of a campaign, and where that stands in the file if not in the scene."""
    varied = varied_scenes(campaign.scene, campaign.grid)
    ranges: list[tuple[Scene, Location | None]] = [
        (scene, location) for axis, location, scene in varied if axis.name == "interaction_range"
    ]
    return ranges or [(campaign.scene, None)]
