"""From a campaign to its cases, and from cases to the distinct problems and blocks of work behind them.

Each file of a measured surface is read once, and gives the dimension and the period of its cases.
"""

from bisect import bisect
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import product
from types import MappingProxyType
from typing import Any

from gfmd_numba.campaign.axes import OF_THE_SCENE, Place, present, values_of, values_together, with_values
from gfmd_numba.campaign.file import Campaign, check_scene
from gfmd_numba.contact import contact_input
from gfmd_numba.contact.problem import Effect, Problem, Tractions
from gfmd_numba.contact.reduced_loads import steps_of
from gfmd_numba.contact.reduction import reduce
from gfmd_numba.contact.rough_surfaces import FacingSurfaces, check_drawn, rough_bodies
from gfmd_numba.elasticity.scales import scales_of
from gfmd_numba.roughness.generators import RandomSurface, random_surface
from gfmd_numba.roughness.measured import MeasuredSurface, MeasuredSurfaces
from gfmd_numba.roughness.surface_files import read_content
from gfmd_numba.roughness.surfaces import GivenSurface, given_surface, on_its_form, sum_of_surfaces
from gfmd_numba.scene import Discretisation, Document, InputError, Measured, Random, Scene, Surface
from gfmd_numba.scene.checks import arrays_of_topography, arrays_per_realisation
from gfmd_numba.scene.document import Location
from gfmd_numba.scene.scene_file import located

PUNCH = ("roughness",)
FILE, POINTS = (*PUNCH, "file"), (*PUNCH, "points")
_UNITS = {"m": "m", "1": "L_x"}
_BLOCK_SAMPLES = 2**18  # realisations times nodes in one block: a second of work, at most some hundred megabytes


@dataclass(frozen=True)
class MeasuredScene:
    """What the files of a scene give: its dimension, its period L_x in m (None: lengths are in L_x), and its surfaces.

    A rigid `punch` is in g L_x and stands with its rms gradient g. For rough bodies, `surfaces` has all that were
    measured, by their places, and errors about them name places of the `document`. Sentences say what was `done` to the
    heights, and which `doubts` there are about them.
    """

    dimension: int
    period: float | None
    document: Document
    done: tuple[str, ...]
    doubts: tuple[str, ...]
    punch: tuple[GivenSurface, float] | None
    surfaces: MeasuredSurfaces

    def under(self, scene: Scene) -> Scene:
        """Scene of this dimension and period."""
        return scene.model_copy(update={"dimension": self.dimension, "length": self.period})


Measurements = Mapping[Surface | None, MeasuredScene]


def measured_scenes(campaign: Campaign, document: Document) -> dict[Surface | None, MeasuredScene]:
    """Return measured surfaces by the record of the measured punch; by None if only bodies were measured.

    Raises InputError for files that cannot be used or do not fit each other.
    """
    if not any(isinstance(surface, Measured) for surface in campaign.scene.surfaces.values()):
        return {}
    if not isinstance(campaign.scene.roughness, Measured):
        scene, surfaces = contact_input.with_measured(located(document, campaign.scene, ("scene",)), document)
        check_scene(document, campaign, scene)
        return {None: _measured(scene, surfaces, document, "")}
    read = lru_cache(maxsize=len(campaign.scene.surfaces))(read_content)  # files are the outermost of the grid's loops
    found: dict[Surface | None, MeasuredScene] = {}
    first: tuple[Measured, MeasuredSurface] | None = None
    for values, locations in values_together(campaign.grid, "roughness"):
        scene = with_values(campaign.scene, values)
        record = scene.roughness
        assert isinstance(record, Measured)  # as the campaign's own
        elsewhere: dict[Location, Location] = {("scene", *place): at for place, at in locations.items()}
        whole = next((place for place in (POINTS, FILE) if place in values), None)
        if whole is not None:  # what is said of the punch as a whole
            elsewhere["scene", *PUNCH] = locations[whole]
        placed = replace(document, elsewhere=elsewhere)
        scene, surfaces = contact_input.with_measured(located(placed, scene, ("scene",)), placed, read)
        first = first or (record, surfaces[PUNCH])
        unit, of_first = surfaces[PUNCH].unit, first[1].unit
        if unit != of_first:
            allowed = f"a surface with lengths in {_UNITS[of_first]}, as {first[0].shown} has them"
            raise _refused(placed, f"{record.shown} (lengths in {_UNITS[unit]})", allowed)
        name = ", ".join(value if place == FILE else f"{place[-1]} {value:.10g}" for place, value in values.items())
        found[record] = _measured(scene, surfaces, placed, name)
        check_scene(document, campaign, scene)
    return found


def said_of(measured: Measurements, what: str) -> list[str]:
    """Return what was `done` to measured surfaces, or the `doubts` about them, each sentence once."""
    return list(dict.fromkeys(sentence for each in measured.values() for sentence in getattr(each, what)))


def _measured(scene: Scene, surfaces: MeasuredSurfaces, document: Document, name: str) -> MeasuredScene:
    """Return what the files of a scene give; its punch has a `name` if a grid varies it."""
    punch = None if scene.follows_topography else _punch(surfaces[PUNCH], scene, document)
    of_punch = f" ({name})" if name else ""

    def said(what: str) -> tuple[str, ...]:
        return tuple(
            f"{'.'.join(place)}{of_punch if place == PUNCH else ''}: {sentence}"
            if punch is None
            else ": ".join(filter(None, (name, sentence)))
            for place, surface in surfaces.items()
            for sentence in getattr(surface, what)
        )

    kept = surfaces if punch is None else {}
    return MeasuredScene(scene.dimension, scene.length, document, said("done"), said("doubts"), punch, kept)


def _punch(surface: MeasuredSurface, scene: Scene, document: Document) -> tuple[GivenSurface, float]:
    record = scene.roughness
    assert isinstance(record, Measured)  # a rigid punch is the only surface there is
    try:
        return given_surface(surface.in_periods, periodic=scene.periodic)
    except ValueError as error:
        raise _refused(document, f"{record.shown} ({error})", "heights that are not all equal") from None


def _refused(document: Document, given: str, allowed: str) -> InputError:
    return document.fault(("scene", *FILE), given, allowed)


Range = tuple[int, int]  # first realisation, and the one after the last


@dataclass(frozen=True, slots=True)
class GridPoint:
    """Values at one point of a campaign's grid, the scene that is `common` to all points, and what was `measured`.

    A scene takes more memory than the rest of a case, and there may be a million cases, so the scene of a point is made
    only when it is asked for.
    """

    common: Scene
    places: tuple[Place, ...]
    values: tuple[Any, ...]
    measured: MeasuredScene | None

    @property
    def scene(self) -> Scene:
        """The scene with these values."""
        scene = with_values(self.common, dict(zip(self.places, self.values, strict=True)))
        return scene if self.measured is None else self.measured.under(scene)


@dataclass(frozen=True, slots=True)
class Case:
    """One ensemble: a scene at one discretisation, its realisations, and the dimensionless problem it reduces to.

    `discretisation` is None where the surface has points and lengths of its own. `limit` names the discretisation that
    differs from the reference, or is "cross" where several do, or "reference". `rms_gradient` is the g that is asked of
    the surfaces.
    """

    point: GridPoint
    discretisation: Discretisation | None
    limit: str
    realisations: int
    problem: Problem
    effects: tuple[Effect, ...]
    rms_gradient: float

    @property
    def scene(self) -> Scene:
        """Scene of the case."""
        return self.point.scene


@dataclass(frozen=True, slots=True)
class Block:
    """A block of realisations of one problem: the unit of finished work."""

    problem: Problem
    first: int
    stop: int

    @property
    def size(self) -> int:
        """Number of its realisations."""
        return self.stop - self.first

    @property
    def name(self) -> str:
        """File name of its shard, without suffix."""
        return f"{self.problem.identity}-{self.first:06d}-{self.stop:06d}"


def expand(
    campaign: Campaign, measured: Measurements = MappingProxyType({}), document: Document | None = None
) -> list[Case]:
    """Return all cases of a campaign: the full product of the grid, each at the reference and along the limits.

    `measured` are its measured surfaces, if it has any. Raises InputError, at a place of the document if there is one,
    for a surface that cannot be used.
    """
    given = [(axis.place, values_of(campaign.grid, axis.name)) for axis in OF_THE_SCENE]
    varied = [(place, values) for place, values in given if values is not None]
    places = tuple(place for place, _ in varied)
    levels = list(campaign.discretisations())
    random_surface_of = lru_cache(maxsize=None)(partial(_surface, campaign))
    document = document or Document(None, "", campaign.model_dump())
    summed_of = partial(_summed, campaign, document, set())
    boundary = campaign.scene.boundary and located(document, campaign.scene.boundary, ("scene", "boundary"))
    arrays_of = lru_cache(maxsize=None)(partial(contact_input.read_boundary, document))
    interface = located(document, campaign.scene.interface, ("scene", "interface"))
    pattern_on = lru_cache(maxsize=None)(partial(contact_input.pattern_of, document, interface))
    known: dict[str, Tractions] = {}  # equal tractions are one object
    cases = []
    for values in product(*(values for _, values in varied)):
        scene = with_values(campaign.scene, dict(zip(places, values, strict=True)))
        found = measured.get(scene.roughness) or measured.get(None)
        point = GridPoint(campaign.scene, places, values, found)
        scene = scene if found is None else found.under(scene)
        for level in levels:
            if scene.follows_topography or scene.roughness is None:
                pressed = summed_of(scene, level.discretisation, found)
            else:
                punch = None if found is None else found.punch
                rough, gradient = punch or random_surface_of(scene.roughness, level.discretisation)
                pressed = FacingSurfaces(on_its_form(scene, rough, gradient), gradient)
            tractions, shape = None, pressed.surface.shape
            if boundary is not None:
                arrays = arrays_of(boundary, scene.dimension, shape)
                tractions = contact_input.tractions_on_the_body(document, scene, arrays, pressed)
                tractions = known.setdefault(tractions.digest, tractions)
            pattern = pattern_on(scene.dimension, shape)
            try:
                problem, effects = reduce(scene, pressed, campaign.numerics, campaign.path, tractions, pattern)
            except ValueError:
                _check_loads(scene, pressed, campaign, document)
                raise
            case = Case(
                point=point,
                discretisation=level.discretisation,
                limit=level.limit,
                realisations=level.realisations,
                problem=problem,
                effects=effects,
                rms_gradient=pressed.rms_gradient,
            )
            cases.append(case)
    return cases


def _surface(
    campaign: Campaign, roughness: Surface, discretisation: Discretisation | None
) -> tuple[RandomSurface, float]:
    """Return the ensemble of a surface and its rms gradient; raises InputError if none can be drawn."""
    assert campaign.seed is not None  # the campaign's promise
    scene = campaign.scene.model_copy(update={"roughness": roughness})
    record = scene.in_periods.roughness
    assert isinstance(record, Random)  # as the roughness
    try:
        return random_surface(record, discretisation, scene.dimension, campaign.seed, scene.periods)
    except ValueError as error:
        varied = [axis for axis in OF_THE_SCENE if axis.of_surface and values_of(campaign.grid, axis.name)]
        values = [f", {axis.name} {getattr(roughness, axis.place[-1]):g}" for axis in varied]
        given = f"method {roughness.method}{''.join(values)}"
        raise InputError.of("scene.roughness", given, f"a usable surface, not {error}") from None


def _summed(
    campaign: Campaign,
    document: Document,
    checked: set[Any],
    scene: Scene,
    discretisation: Discretisation | None,
    given: MeasuredScene | None,
) -> FacingSurfaces:
    """Return all surfaces of a scene, the measured ones `given`, and its bodies; raises InputError.

    The first realisation of each sum of surfaces is checked once, and then is among the `checked`.
    """
    measured, document = ({}, document) if given is None else (given.surfaces, given.document)
    summed = sum_of_surfaces(scene, discretisation, campaign.seed or 0, measured, document)
    rough = rough_bodies(scene, scales_of(scene), campaign.numerics.slope_order(scene))
    facing = FacingSurfaces(summed, summed.rms_gradient, rough)
    bodies = () if rough is None else rough.bodies
    known = summed, tuple((body.elastic.base_z, body.elastic.top.base_z, facing.order) for body in bodies)
    if known not in checked:
        check_drawn(scene, facing, 0, document)
        checked.add(known)
    return facing


def _check_loads(scene: Scene, pressed: FacingSurfaces, campaign: Campaign, document: Document) -> None:
    """Raise InputError for a load that cannot be reduced, at its place."""
    control = scene.loading.control
    varied = values_of(campaign.grid, control)
    place: Location = ("scene", "loading", control)
    if varied is not None:
        place = ("grid", control, varied.index(getattr(scene.loading, control)))
    places: list[Location] = [place, *(("path", i, control) for i in range(len(campaign.path)))]
    loaded = (each for each, _ in steps_of(scene, campaign.path))
    contact_input.check_loads(zip(places, loaded, strict=True), pressed, document)


def distinct(cases: Iterable[Case]) -> list[Problem]:
    """Return the distinct problems among the cases, the largest grids first."""
    problems = {case.problem.identity: case.problem for case in cases}
    return sorted(problems.values(), key=lambda problem: -problem.surface.nodes)


def demand(cases: Iterable[Case]) -> dict[str, int]:
    """Return how many realisations the cases together want of each problem, by its identity."""
    wanted: dict[str, int] = {}
    for case in cases:
        identity = case.problem.identity
        wanted[identity] = max(case.realisations, wanted.get(identity, 0))
    return wanted


def blocks(problem: Problem, realisations: int, held: Collection[Range] = ()) -> Iterator[Block]:
    """Yield blocks that together hold the realisations of one problem. The `held` ranges stay blocks as they are.

    The last block may hold more realisations than are wanted. A block that becomes held changes no other.
    """
    size = max(1, _BLOCK_SAMPLES // (problem.surface.nodes * problem.n_loads))
    if not held:
        for first in range(0, realisations, size):
            yield Block(problem, first, min(first + size, realisations))
        return
    stops: dict[int, int] = {}
    for first, stop in held:
        if first < stop <= first + size:
            stops[first] = max(stop, stops.get(first, 0))
    starts = sorted(stops)
    first = 0
    while first < realisations:
        i = bisect(starts, first)
        stop = stops.get(first, min(first + size, realisations, *starts[i : i + 1]))
        yield Block(problem, first, stop)
        first = stop


def split(cases: Iterable[Case], held: Mapping[str, Collection[Range]]) -> Iterator[Block]:
    """Yield all blocks of work of some cases, the largest grids first; `held` has ranges by identity of the problem."""
    cases = list(cases)
    wanted = demand(cases)
    for problem in distinct(cases):
        yield from blocks(problem, wanted[problem.identity], held.get(problem.identity, ()))


def groups(cases: Iterable[Case]) -> list[list[Case]]:
    """Return groups of cases that differ only in discretisation, in the order of the campaign."""
    cases = list(cases)
    physics = [axis for axis in present(cases[0].scene, cases[0].discretisation) if axis.record]
    found: dict[tuple[float | str | None, ...], list[Case]] = {}
    for case in cases:
        found.setdefault(tuple(axis.value(case.scene, case.discretisation) for axis in physics), []).append(case)
    return list(found.values())


def block_bytes(problem: Problem, realisations: int) -> int:
    """Return the largest memory that solving a block takes.

    The realisations of a path, and those of rough bodies, are solved one after another.
    """
    surface = problem.surface
    together = 1 if problem.path or problem.rough is not None else realisations
    dimension = len(surface.shape)
    boundary = () if problem.tractions is None else ("boundary",)
    arrays = arrays_per_realisation(dimension, (*problem.interface.laws, *boundary), problem.ends)
    if problem.rough is not None:
        arrays = max(arrays, arrays_of_topography(dimension, problem.rough.order))
    return arrays * 8 * together * surface.nodes
