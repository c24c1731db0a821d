"""Input of a contact from its file: checked records, surfaces and tractions. Errors of files end here."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.problem import Effect, Problem, Tractions
from gfmd_numba.contact.reduced_loads import Sliding, reduced_load, steps_of
from gfmd_numba.contact.reduction import reduce, solver_options
from gfmd_numba.contact.refusal import check_combination
from gfmd_numba.contact.relative_softening import check_resolved
from gfmd_numba.contact.rough_surfaces import FacingSurfaces, RoughBody, check_drawn, facing_surfaces
from gfmd_numba.elasticity.scales import Scales, scales_of
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.measured import MeasuredSurface, MeasuredSurfaces, Reader, measured_surfaces
from gfmd_numba.roughness.surface_files import read_content, read_values
from gfmd_numba.roughness.surfaces import SummedSurface
from gfmd_numba.scene import COMPONENTS, Boundary, Document, Measured, Scene, SceneFile
from gfmd_numba.scene.checks import arrays_of, check_nodes
from gfmd_numba.scene.document import Location, located
from gfmd_numba.scene.interface_records import Interface, LawOfTheGap
from gfmd_numba.scene.plausible_numbers import implausible, mistaken
from gfmd_numba.scene.quantities import LARGEST
from gfmd_numba.scene.units import in_unit_of
from gfmd_numba.solvers.table import Options, able

_ROUNDING = 1e-6  # mean over largest traction that is taken for rounding of a file, and subtracted
_FILES = {1: "a column of numbers as text, or an array of one dimension", 2: "rows of numbers, one for each y"}


@dataclass(frozen=True)
class Input:
    """A scene file, and the surfaces `measured` in the files that it names, with what was done to them.

    The `scales` are what its numbers count in, and its elastic bodies in these units. Where topographies are followed,
    `bodies` have those of one realisation. What was `written` is its text.
    """

    written: str
    file: SceneFile
    measured: tuple[MeasuredSurface, ...]
    scales: Scales
    bodies: tuple[RoughBody, ...]

    @property
    def record(self) -> dict[str, str]:
        """Attributes of what was solved: the scene as its user wrote it, and with all defaults in SI units."""
        return {"yaml": self.written, "scene": self.file.model_dump_json()}

    @property
    def processing(self) -> str:
        """What was done to the measured surfaces, a sentence a line."""
        return "\n".join(self._said("outcome"))

    @property
    def doubts(self) -> list[str]:
        """Sentences about measured surfaces that are implausible."""
        return self._said("doubts")

    def _said(self, what: str) -> list[str]:
        """Sentences of all measured surfaces; those of several say of which."""
        places = [place[0] for place, surface in self.file.scene.surfaces.items() if isinstance(surface, Measured)]
        return [
            f"{place}: {sentence}" if len(places) > 1 else sentence
            for place, surface in zip(places, self.measured, strict=True)
            for sentence in getattr(surface, what)
        ]

    @property
    def implausible(self) -> list[str]:
        """Sentences about its numbers that are implausible for what they are."""
        return implausible(self.file.scene, self.file.path)


@dataclass(frozen=True)
class BoundaryInput(Input):
    """What a scene without a punch prescribes `[(ny,) nx]`, in Pa and m, or E* and L_x, by the key of the boundary."""

    prescribed: dict[str, Reals]

    @property
    def rough(self) -> RoughBody | None:
        """Its body, if that is rough."""
        return self.bodies[0] if self.bodies else None

    @property
    def reduced(self) -> tuple[Reals, Reals, Options]:
        """Tractions (E*) and displacements (L_x) `[component, (y,) x]`, the normal ones last, and how they are solved.

        Where none is prescribed, a traction is 0, and a displacement not-a-number.
        """
        given, components = self.prescribed, COMPONENTS[self.file.scene.dimension]
        free = np.full(next(iter(given.values())).shape, np.nan)
        traction, displacement = (
            np.stack([given.get(component.key(quantity), free) for component in components])
            for quantity in ("traction", "displacement")
        )
        options = solver_options(self.file.numerics, able(["prescribed"])[0])
        return np.nan_to_num(traction, nan=0.0) / self.scales.modulus, displacement / self.scales.length, options


@dataclass(frozen=True)
class ContactInput(Input):
    """The surfaces that a scene presses together, and the tractions that it prescribes, in g E*.

    A `pattern` `[(y,) x]` multiplies the work of adhesion of its law. All else follows.
    """

    surfaces: FacingSurfaces
    tractions: Tractions | None = None
    pattern: Reals | None = None

    @cached_property
    def steps(self) -> tuple[tuple[Scene, Sliding], ...]:
        """The scene and the sliding displacement (m or L_x) at its own loading, then after each step of its path."""
        return tuple(steps_of(self.file.scene, self.file.path))

    @cached_property
    def reduced(self) -> tuple[Problem, tuple[Effect, ...]]:
        """The dimensionless problem, with the steps of the path, and what became of each effect of the scene."""
        file = self.file
        return reduce(file.scene, self.surfaces, file.numerics, file.path, self.tractions, self.pattern)

    @property
    def task(self) -> tuple[Problem, int]:
        """What is solved: the problem, and which of its realisations."""
        return self.reduced[0], self.file.realisation


def read(file: SceneFile, document: Document) -> BoundaryInput | ContactInput:
    """Whatever a scene file describes or names; raises InputError for what does not go together or cannot be used."""
    file, measured = with_measured_surfaces(file, document)
    scene, dimension, scales = file.scene, file.scene.dimension, scales_of(file.scene)
    check_combination(document, scene, file.numerics, file.path)
    shape = None if file.points is None else (file.points,) * dimension
    surfaces = (
        facing_surfaces(file, scales, measured, document) if scene.has_punch or scene.follows_topography else None
    )
    bodies = () if surfaces is None else check_drawn(scene, surfaces, file.realisation, document)
    shape = shape if surfaces is None else surfaces.surface.shape
    arrays = {} if scene.boundary is None else read_boundary(document, scene.boundary, dimension, shape)
    found = document.written, file, tuple(measured.values()), scales, bodies
    if surfaces is None or not scene.has_punch:
        name, first = next(iter(arrays.items()))
        place: Location = ("scene", "boundary", name) if surfaces is None else ("scene", "body", "roughness")
        arrays_of_each = arrays_of(scene, file.slope_order)
        check_nodes(document, place, first.size, arrays_of_each)
        return BoundaryInput(*found, _on_a_body(document, scene, arrays))
    tractions = tractions_on_the_body(document, scene, arrays, surfaces) if arrays else None
    pattern = pattern_of(document, scene.interface, dimension, surfaces.surface.shape)
    given = ContactInput(*found, surfaces, tractions, pattern)
    control = scene.loading.control
    places: list[Location] = [("scene", "loading", control), *(("path", i, control) for i in range(len(file.path)))]
    displacements = [scene.loading.displacement, *(step.displacement for step in file.path)]
    check_room(file, surfaces, document, dict(zip(places, displacements, strict=True)))
    check_loads(zip(places, (scene for scene, _ in given.steps), strict=True), surfaces, document)
    if scene.interface.reaches_across:
        check_resolved(document, scene.interface, given.reduced[0], file.discretisation)
    return given


def read_contact(file: SceneFile, document: Document) -> ContactInput:
    """As `read`, of a scene with a punch."""
    given = read(file, document)
    assert isinstance(given, ContactInput)  # of a punch
    return given


def _on_a_body(document: Document, scene: Scene, arrays: dict[str, Reals]) -> dict[str, Reals]:
    """What a scene without a punch prescribes, balanced; raises InputError for what fits no body."""
    body = scene.body
    is_rigid = body.is_incompressible and not body.is_half_space
    if is_rigid and np.isfinite(arrays.get("normal_displacement", np.nan)).all():
        raise document.refused(
            ("scene", "boundary", "normal_displacement"),
            "not-a-number for at least one node of an incompressible slab, whose pressure no displacement tells",
        )
    return _balanced_on(document, scene, arrays)


def with_measured_surfaces(file: SceneFile, document: Document) -> tuple[SceneFile, MeasuredSurfaces]:
    """A file of a scene with the dimension and the period that its measured surfaces tell, and these surfaces.

    Raises InputError for surfaces that cannot be used or do not fit each other, and for what does not fit the period.
    """
    scene, measured = with_measured(file.scene, document)
    file = file.model_copy(update={"scene": scene})
    with located(document):
        file.check_period()
    return file, measured


def with_measured(scene: Scene, document: Document, read: Reader = read_content) -> tuple[Scene, MeasuredSurfaces]:
    """As `with_measured_surfaces`, of a scene alone; `read` gives the content of a file."""
    measured, length = measured_surfaces(scene, document, read)
    dimension = max((surface.heights.ndim for surface in measured.values()), default=scene.dimension)
    scene = scene.model_copy(update={"dimension": dimension, "length": length})
    with located(document, ("scene",)):
        scene.check_period()
    return scene, measured


def check_loads(at_loads: Iterable[tuple[Location, Scene]], surfaces: FacingSurfaces, document: Document) -> None:
    """Raise InputError for a load that is beyond all measure for the rms gradient and the moduli, or a hardness.

    If one of these lacks its unit, the error is about that.
    """
    for place, scene in at_loads:
        try:
            reduced_load(scene, scales_of(scene), surfaces.rms_gradient)
        except ValueError as error:
            if wrong := mistaken(scene):
                told = f"what goes with the load, in a unit: {wrong[1]}"
                raise document.refused(("scene", *wrong[0]), told) from None
            raise document.refused(place, str(error)) from None


def pattern_of(document: Document, interface: Interface, dimension: int, shape: tuple[int, ...]) -> Reals | None:
    """Share of the work of adhesion at each node; raises InputError for one that is no share of anything."""
    laws = interface.laws.items()
    found = next(((name, law.pattern) for name, law in laws if isinstance(law, LawOfTheGap) and law.pattern), None)
    if found is None:
        return None
    place, path = ("scene", "interface", found[0], "pattern"), Path(found[1])
    values = read_nodes(document, place, path, dimension, shape, whole=True)
    if not (values >= 0.0).all() or not values.any():
        given = f"{path.name} (numbers from {values.min():g} to {values.max():g})"
        raise document.fault(place, given, "a number of at least 0 for every node, of which some are above 0")
    return values


def check_room(
    file: SceneFile, surfaces: FacingSurfaces, document: Document, displacements: Mapping[Location, float | None]
) -> None:
    """Raise InputError for a punch that would have to displace more of an incompressible body than there is room.

    `displacements` of the punch, in m or L_x, stand at their places in the document.
    """
    scene = file.scene
    held = not any(scene.ends)  # around a window there is room
    rigid_mean = held and all(body.is_incompressible and not body.is_half_space for body in scene.deformable.values())
    # at higher orders a body that is pressed moves what its topography takes up, too
    if scene.loading.displacement is None or not rigid_mean or surfaces.order > 0:
        return
    surface, gradient, one = surfaces.surface, surfaces.rms_gradient, range(file.realisation, file.realisation + 1)
    if isinstance(surface, SummedSurface):
        heights, gradient = np.sum(surface.drawn(file.realisation), axis=0), 1.0
    else:
        heights = surface.heights(one)[0] if isinstance(surface, RandomSurface) else surface.heights
    room = float(heights.max() - heights.mean()) * gradient * (scene.length or 1.0)
    for place, displacement in displacements.items():
        if displacement is not None and displacement > room:
            reason = "as an incompressible body has no room for more of this punch"
            raise document.refused(place, f"at most {in_unit_of(displacement, room)}, {reason}")


def tractions_on_the_body(
    document: Document, scene: Scene, arrays: Mapping[str, Reals], surfaces: FacingSurfaces
) -> Tractions:
    """Tractions of what `read_boundary` has read, over the rms gradient of the surfaces that are pressed together.

    Raises InputError for a mean traction that nothing holds, or that the loading decides already.
    """
    names = [component.key("traction") for component in COMPONENTS[scene.dimension]]
    given = _balanced_on(document, scene, arrays)
    scale, shape = surfaces.rms_gradient * scales_of(scene).modulus, surfaces.surface.shape
    found = [np.nan_to_num(given.get(name, np.zeros(shape)), nan=0.0) / scale for name in names]
    return Tractions.of(np.stack(found[:-1]), found[-1])


def read_boundary(
    document: Document, boundary: Boundary, dimension: int, shape: tuple[int, ...] | None
) -> dict[str, Reals]:
    """Whatever is prescribed, by name `[(ny,) nx]` in the file's units, not-a-number where it is not.

    Raises InputError for files that do not fit the grid of that shape (None: that of the first file) or one another.
    """
    found: dict[str, Reals] = {}
    given = {name: value for name, value in boundary if value is not None}
    for name, value in given.items():
        if isinstance(value, str):
            found[name] = read_nodes(document, ("scene", "boundary", name), Path(value), dimension, shape, whole=False)
            shape = found[name].shape
    assert shape is not None  # the records' promise
    arrays = {name: found[name] if name in found else np.full(shape, float(value)) for name, value in given.items()}
    unset = np.full(shape, np.nan)
    for component in COMPONENTS[dimension][::-1]:
        traction, displacement = (component.key(quantity) for quantity in ("traction", "displacement"))
        both = np.flatnonzero(np.isfinite(arrays.get(traction, unset) + arrays.get(displacement, unset)))
        if both.size:
            raise document.fault(
                ("scene", "boundary", traction),
                f"{arrays[traction].flat[both[0]]:g} at node {_place(both[0], shape)}",
                f"a file with not-a-number at the nodes whose {displacement} is prescribed, of which this is one",
            )
    return arrays


def _balanced_on(document: Document, scene: Scene, arrays: Mapping[str, Reals]) -> dict[str, Reals]:
    """Return the arrays, of which the tractions of components that nothing holds have a mean of exactly 0."""
    found, holder = dict(arrays), scene.body.holder
    for component in COMPONENTS[scene.dimension][::-1]:
        traction, held = component.key("traction"), component.key("displacement")
        if traction not in found or any(scene.ends):  # by the body around it, and the load is what the punch bears
            continue
        if scene.has_punch and component.name == "normal":
            if scene.loading.displacement is None:
                remedy = f"as loading.{scene.loading.control} prescribes the mean pressure"
                found[traction] = _balanced(document, found[traction], traction, remedy)
        elif scene.body.is_half_space and held not in found:
            also = "" if scene.has_punch else f" or a {held}"
            remedy = f"or {holder}{also}, as nothing holds a half-space"
            found[traction] = _balanced(document, found[traction], traction, remedy)
    return found


def _balanced(document: Document, given: Reals, name: str, remedy: str) -> Reals:
    """Return the traction of that name with a mean of exactly 0.

    A mean below 1e-6 of the largest traction is rounding, as of a text file, and is subtracted. Raises InputError, with
    the remedy, for a larger one.
    """
    values = np.nan_to_num(given, nan=0.0)
    mean = values.mean()
    if abs(mean) > _ROUNDING * abs(values).max():
        raise document.fault(("scene", "boundary", name), f"a mean of {mean:g}", f"a mean of 0, {remedy}")
    return np.asarray(values - mean)


def read_nodes(
    document: Document, place: Location, path: Path, dimension: int, shape: tuple[int, ...] | None, whole: bool
) -> Reals:
    """Values `[(ny,) nx]` of a file that is named at a place, of which some may be not-a-number unless it is `whole`.

    Raises InputError for one that does not fit a grid of that shape (None: any), or has no number.
    """
    try:
        values = read_values(path, dimension)
    except ValueError as error:
        raise document.fault(place, f"{path.name} ({error})", _FILES[dimension]) from None
    wrong = (abs(values) > LARGEST) | (whole & np.isnan(values))
    if wrong.any():
        where = int(np.argmax(wrong))
        at = f"{values.flat[where]} at index {_place(where, values.shape)}"
        holes = "" if whole else ", and not-a-number where nothing is prescribed"
        allowed = f"finite numbers of at most {LARGEST:g}{holes}"
        raise document.fault(place, f"{path.name} ({at})", allowed)
    if not np.isfinite(values).any():
        raise document.fault(place, f"{path.name} (no number)", "a number for at least one node")
    if shape is not None and values.shape != shape:
        given, allowed = (" x ".join(map(str, each)) for each in (values.shape, shape))
        raise document.fault(place, f"{path.name} ({given} values)", f"one value for each of the {allowed} nodes")
    return values


def _place(node: int, shape: tuple[int, ...]) -> str:
    """Index of a node of an array in that shape, as a file's reader counts it: of maps the row, then the column."""
    return ", ".join(str(int(index)) for index in np.unravel_index(node, shape))
