"""The campaign file: a scene, a reference discretisation, and what varies around it."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import product
from math import nan, prod
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

import yaml
from pydantic import BaseModel, Field, model_validator

from gfmd_numba.campaign.axes import DISCRETISATIONS, Grid, check_grid, check_surfaces_of_grid, values_of, varied_scenes
from gfmd_numba.campaign.goal import Fit, Target, check_fit
from gfmd_numba.campaign.limits import (
    COUNT,
    CROSS,
    FEWEST,
    FixedExponents,
    Limits,
    NumberOfSurfaces,
    Realisations,
    discretisation_of,
    first_levels,
    limit_named,
    limits_around,
)
from gfmd_numba.campaign.output_directory import LABEL, check_label, home_of
from gfmd_numba.contact.refusal import check_combination, check_where
from gfmd_numba.scene import checks
from gfmd_numba.scene import document as documents
from gfmd_numba.scene.document import Document, Location, Source, document_of
from gfmd_numba.scene.loading import Step
from gfmd_numba.scene.measured_record import Measured
from gfmd_numba.scene.quantities import RECORD, SEED, Seed, broken_rule, check_scales
from gfmd_numba.scene.records import Discretisation, Numerics, Scene, check_waves
from gfmd_numba.scene.scene_file import located as located_files
from gfmd_numba.scene.scene_file import refuse_other_kinds
from gfmd_numba.scene.surfaces import Random
from gfmd_numba.scene.units import TIME
from gfmd_numba.text.input_error import ABSENT, InputError
from gfmd_numba.theory.exponent_ranges import exponent_ranges, has_slope_law

MOST_CASES = 1_000_000
_LEVELS = "a mapping with eps_c, eps_f and eps_t, or a `target` like {kappa: 3%}, for which the run chooses levels"
_REALISATIONS = f"{COUNT}; or a `target` like {{kappa: 3%}}, for which the run chooses them"
LONGEST_TIMEOUT = 30 * 86_400.0  # s; timers overflow after 49 days on some systems, and a block is seconds of work


class PlacedDiscretisation(NamedTuple):
    """A discretisation of a campaign and its number of surfaces; None if the surfaces have points of their own.

    `locations` says where its values stand in the file, and `varied` which of them differ from the reference.
    """

    discretisation: Discretisation | None
    locations: dict[str, Location]
    varied: tuple[str, ...]
    realisations: int

    @property
    def limit(self) -> str:
        """Name of the discretisation that differs from the reference, "cross" if several do, else "reference"."""
        return limit_named(self.varied)


class Campaign(BaseModel):
    """Grid product of cases, each at the reference and along its limits, times realisations."""

    model_config = RECORD
    name: str = Field(
        pattern=r"^[A-Za-z0-9_-][A-Za-z0-9._-]*$",
        max_length=100,
        description="Name of the campaign and of its output",
        json_schema_extra={"allowed": "up to 100 letters, digits, '.', '_' and '-', not starting with '.'"},
    )
    seed: Seed | None = Field(None, description="Seed of the random surfaces; None: no surface is random")
    realisations: NumberOfSurfaces = Field(
        Realisations(reference=1),
        description="Random surfaces of each case, a number or one for each limit; left out where no surface is random",
    )
    scene: Scene = Field(description="What is in contact")
    reference: Discretisation | None = Field(
        None, description="Discretisation around which the limits are taken; None: surfaces have points of their own"
    )
    limits: Limits = Field(Limits(), description="Discretisations one at a time")
    grid: Grid = Field(Grid(), description="Parameters as a full product")
    levels: Literal["only"] | None = Field(
        None, description="only: a run to a target adds no finer levels to those under `limits`"
    )
    numerics: Numerics = Field(Numerics(), description="How it is solved")
    path: tuple[Step, ...] = Field(
        (), strict=False, description="Loadings after the first one, each begun where the last one ended"
    )
    fit: Fit = Field(Fit(), description="How the results are fitted")
    target: Target | None = Field(
        None,
        description="Relative standard error (dimensionless) that each variable has to have in the limit; without "
        "`realisations`, the run chooses their numbers, and finer levels, until it is reached",
    )
    case_timeout: Annotated[float, Field(gt=0, le=LONGEST_TIMEOUT), TIME] | None = Field(
        None,
        description="Seconds after which a block of realisations of a case is given up, up to 30 days; None: never",
    )

    @property
    def chooses_levels(self) -> bool:
        """Whether the run chooses the discretisations of random surfaces by itself."""
        return self.reference is None and self.target is not None

    def fits(self) -> Iterator[tuple[Fit, Location]]:
        """Yield how the variable of the fit and the others of the target are fitted, and where each stands in the file.

        What the file says of the fit is about its own variable. Others have the usual ranges of exponents.
        """
        targets, own = self.target or {}, self.fit.with_target(self.target)
        yield own, ("target", own.variable) if own.variable in targets else ("fit", "variable")
        for name in (each for each in targets if each != own.variable):
            fixed = FixedExponents.model_validate(self.usual_exponents(name))
            yield Fit.model_validate({"variable": name, "exponents": own.exponents, "fixed": fixed}), ("target", name)

    def usual_exponents(self, variable: str) -> dict[str, Any]:
        """Return the usual ranges of the exponents of a variable, except for a limit whose law has no exponent."""
        hursts = values_of(self.grid, "hurst") or [
            getattr(surface, "hurst", nan) for surface in self.scene.surfaces.values()
        ]
        ranges: dict[str, Any] = dict(exponent_ranges(variable, self.scene.dimension or 1, max(hursts, default=nan)))
        loading, surfaces = self.scene.loading, self.scene.surfaces.values()
        of_gradient = all(getattr(surface, "rms_gradient", None) is not None for surface in surfaces)
        # whether p / (g E*) is the same at all discretisations
        one_load = loading.reduced_pressure is not None or (loading.displacement is None and of_gradient)
        if all(has_slope_law(variable, hurst, 1.0 if one_load else nan) for hurst in hursts):
            del ranges["eps_f"]
        return ranges

    @property
    def n_cases(self) -> int:
        """Number of cases, without the realisations."""
        grid = prod(len(values) for _, values in self.grid if values is not None)
        return grid * (1 + sum(1 for _ in self._levels()))

    @property
    def varied(self) -> set[str]:
        """Discretisations of which a fit has several levels."""
        of_grid = {axis for axis in DISCRETISATIONS if len(getattr(self.grid, axis) or ()) > 1}
        return of_grid.union(*(values for values, _, _ in self._levels()))

    def discretisations(self) -> Iterator[PlacedDiscretisation]:
        """Yield each discretisation: the references, each followed by the levels of its limits."""
        if self.reference is None:
            yield PlacedDiscretisation(None, {}, (), self.realisations.reference)
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
            yield PlacedDiscretisation(Discretisation(**eps), locations, (), self.realisations.reference)
            for values, places, surfaces in self._levels():
                yield PlacedDiscretisation(Discretisation(**eps | values), locations | places, tuple(values), surfaces)

    def _levels(self) -> Iterator[tuple[dict[str, float], dict[str, Location], int]]:
        """Yield each level that has surfaces: its values unlike the reference's, their places, and its surfaces."""
        for axis in DISCRETISATIONS:
            for i, value in enumerate(getattr(self.limits, axis) or ()):
                surfaces = self.realisations.of(axis, i)
                if value != getattr(self.reference, axis) and surfaces > 0:
                    yield {axis: value}, {axis: ("limits", axis, i)}, surfaces
        for i, values in enumerate(self.limits.crossed):
            surfaces = self.realisations.of(CROSS, i)
            if surfaces > 0:
                yield values, {axis: ("limits", CROSS, i, axis) for axis in values}, surfaces

    @model_validator(mode="after")
    def _draws_what_is_random(self) -> Self:
        if not self.scene.has_punch:
            raise broken_rule(("scene", "loading"), "a loading, and an interface, as campaigns are of contacts")
        random = any(isinstance(surface, Random) for surface in self.scene.surfaces.values())
        for name, allowed in (("seed", f"{SEED}, as surfaces are random"), ("realisations", _REALISATIONS)):
            given = name in self.model_fields_set
            if random and name == "realisations" and not given and self.target is not None:
                continue
            if random and (not given or getattr(self, name) is None):
                raise broken_rule((name,), allowed)
            if given and not random:
                raise broken_rule((name,), "nothing, as no surface is random")
        return self

    @model_validator(mode="after")
    def _parts_agree(self) -> Self:
        for i, step in enumerate(self.path):
            step.check(self.scene.loading, i)
        if "path" in self.model_fields_set and not self.path:
            raise broken_rule(("path",), "at least one loading, or no path where nothing follows the first loading")
        for fit, place in self.fits():
            fit.check(len(self.path), place)
        needed = any(surface.needs_discretisation for surface in self.scene.surfaces.values())
        if needed and self.reference is None and not self.chooses_levels:
            raise broken_rule(("reference",), f"{_LEVELS}, as the surface has no points")
        if not needed and self.reference is not None:
            raise broken_rule(("reference",), "nothing, as the surface has points and lengths of its own")
        for i, level in enumerate(self.limits.crossed if self.reference is not None else ()):
            for axis, value in level.items():
                if value == getattr(self.reference, axis):
                    raise broken_rule(("limits", CROSS, i, axis), f"a value other than the reference's, {value:.6g}")
        chosen = needed and self.chooses_levels
        if chosen and "realisations" in self.model_fields_set:
            raise broken_rule(
                ("realisations",), "nothing without a `reference`, as the run chooses them with the levels"
            )
        of_limits: tuple[tuple[Location, BaseModel], ...] = (
            (("limits",), self.limits),
            (("grid",), self.grid),
            (("realisations",), self.realisations),
            *(() if chosen else ((("fit", "fixed"), self.fit.fixed),)),
        )
        why = "without a `reference`" if chosen else "as the surface has points and lengths of its own"
        for name in (*DISCRETISATIONS, CROSS):
            for place, record in of_limits:
                if self.reference is None and getattr(record, name, None) is not None:
                    raise broken_rule((*place, name), f"nothing{'' if chosen else ','} {why}")
            if name in self.limits.varied and getattr(self.grid, name) is not None:
                raise broken_rule(("grid", name), f"{name} in either limits or grid, not in both")
            counts, levels = getattr(self.realisations, name), getattr(self.limits, name) or ()
            if isinstance(counts, tuple) and len(counts) != len(levels):
                raise broken_rule(("realisations", name), f"{len(levels)} numbers, as limits.{name} has so many levels")
        return self


def load_campaign(source: Source | Campaign, target: Mapping[str, float] | None = None) -> tuple[Campaign, Document]:
    """Return the checked campaign of a YAML file or a mapping, and the document itself; raises InputError.

    A `target` replaces that of the file. If the run chooses the levels, the campaign has those that it begins with.
    """
    document = _document(source)
    if document.path is not None:
        document = replace(document, home=home_of(document.path))
    changed: Any = document.data
    if target is not None and isinstance(changed, Mapping):
        changed = {**changed, "target": dict(target)}
    asked = documents.validate(replace(document, data=changed), Campaign)
    campaign = _begun(asked)
    for name, exponent in asked.fit.fixed:
        if exponent is not None and name not in campaign.varied:
            raise document.refused(("fit", "fixed", name), f"nothing for {name}, which has no levels under `limits`")
    if not _measured(campaign.scene):  # only its file tells the dimension
        check_scene(document, campaign, campaign.scene)
    check_grid(document, campaign.scene, campaign.grid)
    scenes = [campaign.scene, *varied_scenes(campaign.scene, campaign.grid)]
    orders = [(each, campaign.numerics.slope_order(each)) for each in scenes]
    for fit, place in campaign.fits():
        check_fit(document, fit, place, orders, campaign.limits.varied)
    _check_files(document, campaign)
    if document.path is None:
        document = replace(document, text=written(asked))
    if campaign.n_cases > MOST_CASES:
        raise document.refused(("grid",), f"at most {MOST_CASES} cases, not {campaign.n_cases}")
    check_surfaces_of_grid(document, campaign.scene, campaign.grid)
    own = getattr(campaign.scene.roughness, "anisotropy", None)
    anisotropies: list[tuple[float, Location]] = (
        [(own, ("scene", "roughness", "anisotropy"))] if own is not None else []
    )
    if given := values_of(campaign.grid, "anisotropy"):
        anisotropies = [(value, ("grid", "anisotropy", i)) for i, value in enumerate(given)]
    arrays = checks.arrays_of(campaign.scene, campaign.numerics.slope_order(campaign.scene))
    checks.check_surfaces(document, campaign.scene, arrays)
    points = values_of(campaign.grid, "points") or ()
    for i, value in enumerate(points):
        checks.check_nodes(document, ("grid", "points", i), float(value) ** campaign.scene.dimension, arrays)
    for discretisation, locations, differing, _ in campaign.discretisations():
        if discretisation is not None:
            for anisotropy, location in anisotropies:
                checks.check_anisotropy_fits(document, anisotropy, location, discretisation)
            checks.check_discretisation(
                document, discretisation, locations, differing, campaign.scene.dimension, arrays
            )
    return campaign, document


def replaced(directory: Path, campaign: Campaign, target: Mapping[str, float] | None = None) -> str:
    """Say that a run of a campaign replaces the results of another version of it in a directory, if it does.

    One of other `realisations` alone adds to what is there, and a run refuses the directory of a campaign of another
    name, or one without a sound copy of its file.
    """
    label = directory / LABEL
    try:
        check_label(directory)
        before = load_campaign(label, target)[0]
    except (InputError, OSError):
        return ""
    if before.name != campaign.name or before == campaign.model_copy(update={"realisations": before.realisations}):
        return ""
    kept = "its results are replaced, and finished blocks that both share are kept (another output runs elsewhere)"
    return f"{directory} holds another version of this campaign: {kept}"


def is_without_levels(document: Document, campaign: Campaign) -> bool:
    """Return whether the levels of a loaded campaign were chosen by the run, because its file names none."""
    return document.value(("reference",)) is ABSENT and bool(campaign.limits.varied)


def fitted_variable(source: Source) -> str:
    """Return the variable that a campaign fits, whatever its target is. Raises InputError."""
    document = document_of(source, "campaign")
    stand_in = {"kappa": 0.01} if document.value(("target",)) is ABSENT else None  # for which levels are chosen
    return load_campaign(document, stand_in)[0].fit.variable


def target_of_run(source: Source | Campaign) -> dict[str, float] | None:
    """Return the target of a campaign whose run chooses the realisations; None for another. Raises InputError."""
    campaign = documents.validate(_document(source), Campaign)
    return None if "realisations" in campaign.model_fields_set else campaign.target


def _begun(campaign: Campaign) -> Campaign:
    """Return the campaign with the variable that is fitted and, if it has no levels, those that a run begins with.

    A run to a target knows the usual ranges of the exponents that the file does not mention.
    """
    campaign = campaign.model_copy(update={"fit": campaign.fit.with_target(campaign.target)})
    needed = any(surface.needs_discretisation for surface in campaign.scene.surfaces.values())
    if campaign.target is None or not needed:
        return campaign
    campaign = _with_levels(campaign) if campaign.chooses_levels else campaign
    usual = campaign.usual_exponents(campaign.fit.variable)
    known = {name: each for name, each in campaign.fit.fixed if each is not None}
    fixed = FixedExponents.model_validate({name: usual[name] for name in usual if name in campaign.varied} | known)
    exponents = campaign.fit.exponents if "exponents" in campaign.fit.model_fields_set else "free"
    fit = campaign.fit.model_copy(update={"fixed": fixed, "exponents": exponents})
    return campaign.model_copy(update={"fit": fit})


def _with_levels(campaign: Campaign) -> Campaign:
    """Return the campaign with the levels that a run begins with."""
    dimension = campaign.scene.dimension
    surfaces = campaign.scene.surfaces.values()
    anisotropies = values_of(campaign.grid, "anisotropy") or [getattr(each, "anisotropy", None) for each in surfaces]
    heights = [values_of(campaign.grid, name) or () for name in ("aspect_ratio", "counter_body_aspect_ratio")]
    thinnest = min([campaign.scene.thinnest_layer, *heights[0], *heights[1]])
    reference, *others = first_levels(dimension, max(each or 1.0 for each in anisotropies), thinnest)
    update = {
        "reference": discretisation_of(reference),
        "limits": limits_around(reference, others),
        "realisations": Realisations(reference=FEWEST),
    }
    return campaign.model_copy(update=update)


def check_scene(document: Document, campaign: Campaign, scene: Scene) -> None:
    """Raise InputError unless a scene of a campaign, its grid and its numerics go together."""
    with documents.located(document):
        check_waves(scene.surfaces, scene.length)
        check_scales(campaign.grid, scene.length, scene.has_moduli, ("grid",))
        check_scales(campaign.path, scene.length, scene.has_moduli, ("path",))
    varied = {name: values for name, values in campaign.grid if values is not None}
    check_combination(document, scene, campaign.numerics, campaign.path, varied)
    if campaign.limits.varied:
        check_where(document, scene, "limits", campaign.numerics)
    if "eps_t" in campaign.limits.varied:
        check_where(document, scene, "thermodynamic limit", campaign.numerics)


def _document(source: Source | Campaign) -> Document:
    """Return the document of a campaign. The first file of the grid is in the scene, if the grid alone names files.

    Raises InputError for the file of a scene or a surface.
    """
    data = source.model_dump(exclude_unset=True) if isinstance(source, Campaign) else source
    document = document_of(data, "campaign")
    refuse_other_kinds(document)
    return _with_a_file(document)


def _with_a_file(document: Document) -> Document:
    """Return the document with the first file of the grid in the scene, if the grid alone names the files."""
    data: Any = document.data
    surface: Any = document.value(("scene", "roughness"))
    files = document.value(("grid", "file"))
    measured = isinstance(surface, Mapping) and surface.get("method") == "measured"
    if not measured or files is ABSENT or files is None or {"file", "heights"} & surface.keys():
        return document
    names = files if isinstance(files, list | tuple) else ()
    first = next((name for name in names if isinstance(name, str) and name), "grid.file")  # whose faults are told there
    return replace(document, data={**data, "scene": {**data["scene"], "roughness": {**surface, "file": first}}})


def _check_files(document: Document, campaign: Campaign) -> None:
    """Raise InputError for files of surfaces and tractions that do not exist, or a measured surface that has none."""
    varied = values_of(campaign.grid, "file")
    for place, surface in _measured(campaign.scene).items():
        if surface.file is None:
            allowed = "a file in a campaign: save the array as .npy, and name it"
            raise document.error(("scene", *place, "heights"), surface.shown, allowed)
        if varied is None or place != ("roughness",):
            documents.existing_file(document, ("scene", *place, "file"), surface.file, ())
    for i, name in enumerate(varied or ()):
        documents.existing_file(document, ("grid", "file", i), name, ())
    if campaign.scene.boundary is not None:
        located_files(document, campaign.scene.boundary, ("scene", "boundary"))
    located_files(document, campaign.scene.interface, ("scene", "interface"))


def _measured(scene: Scene) -> dict[tuple[str, ...], Measured]:
    return {place: surface for place, surface in scene.surfaces.items() if isinstance(surface, Measured)}


def written(record: BaseModel) -> str:
    """Return the YAML text of a record, from which an equal record is read."""
    return yaml.dump(record.model_dump(exclude_unset=True), Dumper=_AliasFreeDumper, sort_keys=False)


class _AliasFreeDumper(yaml.SafeDumper):
    """PyYAML's safe dumper without aliases, for the loader of documents."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.Node:
    """Text, quoted if it would be read as a number or the like."""
    style = None if documents.plain_scalar(text) == text else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style)


_AliasFreeDumper.add_representer(str, _text)
_AliasFreeDumper.add_multi_representer(float, lambda dumper, number: dumper.represent_float(float(number)))
