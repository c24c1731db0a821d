"""Refuse a scene by the tables of combinations and of solvers, every fault on a line of its own."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from math import inf, isinf
from typing import Literal

from gfmd_numba.contact.combinations import LEAST_POISSONS_RATIO, LOWEST, REFUSALS, SAMPLED, SOFTEST, TALLEST, Refusal
from gfmd_numba.scene import COMPONENTS, Body, Document, InputError, Measured, Numerics, Scene
from gfmd_numba.scene.body_record import Layer, Material
from gfmd_numba.scene.document import Location
from gfmd_numba.scene.interface_records import Friction, LawOfTheGap
from gfmd_numba.scene.loading import Controls, Step
from gfmd_numba.scene.surfaces import Random
from gfmd_numba.scene.units import in_unit_of
from gfmd_numba.solvers.table import ABILITIES, SOLVERS, able

Grid = Mapping[str, Sequence[float]]  # values that a campaign takes in place of its scene's
Features = Mapping[str, Sequence[Location]]  # what is asked for, and where that stands in the file
# axes of a grid that vary a body
_ASPECT_RATIO = {"body": "aspect_ratio", "counter_body": "counter_body_aspect_ratio"}
_POISSONS_RATIO = {"body": "poissons_ratio", "counter_body": "counter_body_poissons_ratio"}
Where = Literal["accuracy", "limits", "thermodynamic limit", "processes"]


def check_combination(
    document: Document,
    scene: Scene,
    numerics: Numerics,
    path: Sequence[Step] = (),
    grid: Grid | None = None,
) -> None:
    """Raise InputError, one line for each fault, if a scene and its numerics do not go together.

    `grid` is what a campaign varies, None for a scene on its own.
    """
    if numerics.solver not in (known := ("auto", *SOLVERS)):
        raise document.unknown(("numerics", "solver"), known)
    _raise(document, refusals(scene, numerics, path, grid))


def check_where(document: Document, scene: Scene, where: Where, numerics: Numerics, path: Sequence[Step] = ()) -> None:
    """Raise InputError, one line for each fault, if a scene is not for `gfmd accuracy` or `--mpi`, or lacks limits."""
    at: Location = ("limits",) if "limit" in where else ()
    refused = _table_refusals(_features(scene, numerics, path, None) | {where: [at]})
    _raise(document, (each for each in refused if where in (each[1].present, each[1].refused)))


def refusals(
    scene: Scene, numerics: Numerics, path: Sequence[Step] = (), grid: Grid | None = None
) -> Iterator[tuple[Location, Refusal]]:
    """What does not go together in a scene, and where it stands in the file."""
    found = _features(scene, numerics, path, grid)
    told = ((at, _with_least_modulus(scene, at, row)) for at, row in _table_refusals(found))
    return chain(told, _solver_refusals(found, numerics))


def _raise(document: Document, refused: Iterator[tuple[Location, Refusal]]) -> None:
    first: dict[Location, Refusal] = {}
    for location, refusal in refused:
        if first.setdefault(location, refusal).because == "without effect" != refusal.because:
            first[location] = refusal  # what it lacks would not help
    if first:
        raise InputError(*(document.told(at, row.allowed) for at, row in first.items()))


def _table_refusals(found: Features) -> Iterator[tuple[Location, Refusal]]:
    for row in REFUSALS:
        if row.present in found and row.refused in found:
            told = replace(row, allowed=row.told(found))
            yield from ((location, told) for location in found[row.refused])


def _features(scene: Scene, numerics: Numerics, path: Sequence[Step], grid: Grid | None) -> dict[str, list[Location]]:
    found: dict[str, list[Location]] = {}
    parts = [_of_numerics(numerics), _of_bodies(scene)]
    parts.append(_of_contact(scene, path, grid or {}) if scene.has_punch else _of_loaded_body(scene))
    if grid is not None:
        parts.append(iter([("campaign", ("grid",))]))
    for feature, location in chain(*parts):
        found.setdefault(feature, []).append(location)
    return found


def _of_numerics(numerics: Numerics) -> Iterator[tuple[str, Location]]:
    if numerics.time_tolerance is not None:
        yield "time_tolerance", ("numerics", "time_tolerance")
    if numerics.solver != "auto":
        yield "named solver", ("numerics", "solver")
    if numerics.threads > 1:
        yield "threads", ("numerics", "threads")
    if numerics.topography_order is not None:
        yield "topography_order", ("numerics", "topography_order")
        if numerics.topography_order > 0:
            yield "higher topography_order", ("numerics", "topography_order")


def _of_bodies(scene: Scene) -> Iterator[tuple[str, Location]]:
    yield f"dimension {scene.dimension}", ("scene", "dimension")
    if scene.body.state == "plane_stress":
        yield "plane stress", ("scene", "body", "state")
    if not scene.follows_topography:
        yield "smooth bodies", ("scene", "body")
    of_time = [name for name, body in zip(_ASPECT_RATIO, scene.deformable, strict=False) if body.relaxation is not None]
    yield from (("relaxation", ("scene", name, "relaxation")) for name in of_time)
    if not of_time:
        yield "elastic bodies", ("scene", "body")
        if not scene.has_slip_rates:
            yield "timeless", ("scene", "body")
        if scene.interface.wear is None:
            yield "undivided steps", ("scene", "body")
    for name, body in zip(_ASPECT_RATIO, scene.deformable, strict=False):
        if body.plasticity is not None:
            yield "plasticity", ("scene", name, "plasticity")
    for place, surface in scene.surfaces.items():
        if getattr(surface, "anisotropy", None) is not None:
            yield "anisotropy", ("scene", *place, "anisotropy")
        if isinstance(surface, Measured) and scene.has_punch:
            yield "measured surface", ("scene", *place, "method")
        if isinstance(surface, Random) and not surface.by_columns:
            yield "surface made as a whole", ("scene", *place)
        if isinstance(surface, Random) and surface.of_maps:
            yield "model of maps", ("scene", *place, surface.named_by)
    along_y = [name for name, value in scene.boundary or () if value is not None and name.endswith("_y")]
    yield from (("boundary along y", ("scene", "boundary", name)) for name in along_y)


def _of_loaded_body(scene: Scene) -> Iterator[tuple[str, Location]]:
    yield "prescribed", ("scene", "boundary")
    if any(scene.ends):
        yield "no period", ("scene", "periodic")


def _of_contact(scene: Scene, path: Sequence[Step], grid: Grid) -> Iterator[tuple[str, Location]]:
    yield "punch", ("scene",)
    yield from _of_laws(scene)
    yield from _of_touching_nodes(scene, grid)
    if not scene.interface.couples and scene.interface.wear is None:
        yield "contact without drag", ("scene", "interface")
    if not scene.interface.reaches_across:
        yield "contact without reach", ("scene", "interface")
    yield from _of_time(scene, path)
    if scene.counter_body is not None:
        yield "rough bodies", ("scene", "counter_body")
        if scene.creeps and not _give_way_alike(scene, grid):
            yield "unlike bodies", ("scene", "counter_body")
    elif scene.follows_topography:
        yield "rough bodies", ("scene", "body", "roughness")
    if scene.boundary is not None:
        yield "boundary", ("scene", "boundary")
    if isinstance(scene.periodic, str):
        yield "period along one axis", ("scene", "periodic")
    yield from _without_a_period(scene, grid) if any(scene.ends) else _half_spaces(scene, grid)
    if scene.body.thinnest_layer(scene.length) < inf or "aspect_ratio" in grid:
        yield "slab", ("scene", "body")
    yield from _of_form(scene, grid)
    yield from _of_loading(scene, path)
    for i, value in enumerate(grid.get("displacement", ())):
        if value < 0.0:
            yield "negative displacement", ("grid", "displacement", i)
    if "anisotropy" in grid:
        yield "anisotropy", ("grid", "anisotropy")
    if scene.loading.displacement is not None and not any(scene.ends):
        yield from (("rigid mean", location) for location in _incompressible(scene, grid))


def _give_way_alike(scene: Scene, grid: Grid) -> bool:
    """Whether the compliances of two bodies, to pressures alone, have one ratio for all waves."""
    if scene.interface.couples or any(axis in grid for axis in _ASPECT_RATIO.values()):
        return False
    if all(body.is_half_space and body.layers is None for body in scene.deformable):
        return True
    from gfmd_numba.contact.scales import elastic_body  # numbers, which the tables do without

    one, other = (elastic_body(body, scene.length) for body in scene.deformable)
    return one == other and not any(axis in grid for axis in _POISSONS_RATIO.values())


def _of_laws(scene: Scene) -> Iterator[tuple[str, Location]]:
    for name, law in scene.interface.laws.items():
        for feature in dict.fromkeys((name, law.ability)):
            yield feature, ("scene", "interface", name)
        if isinstance(law, Friction) and law.depends_on_rate:
            yield "slip rate", ("scene", "interface", name)
            if law.function is not None:
                yield "function", ("scene", "interface", name, "function")
        if isinstance(law, LawOfTheGap) and law.pattern is not None:
            yield "pattern", ("scene", "interface", name, "pattern")


def _of_time(scene: Scene, path: Sequence[Step]) -> Iterator[tuple[str, Location]]:
    """What takes time, or depends on how far the punch has slid."""
    loads: list[tuple[Location, Controls]] = [
        (("scene", "loading"), scene.loading),
        *((("path", i), step) for i, step in enumerate(path)),
    ]
    for place, load in loads:
        yield ("at once", place) if load.duration is None else ("duration", (*place, "duration"))
    if scene.loading.speed is not None:
        yield "speed", ("scene", "loading", "speed")
    if scene.interface.wear is not None:
        yield "wear", ("scene", "interface", "wear")
        if all(step.sliding is None and step.sliding_y is None for step in path):
            yield "no sliding", ("path",)


def _of_form(scene: Scene, grid: Grid) -> Iterator[tuple[str, Location]]:
    if scene.form is None:
        return
    yield "form", ("scene", "form")
    if not scene.surfaces:
        yield "form alone", ("scene", "form")
    if scene.counter_body is not None:
        yield "form between elastic bodies", ("scene", "form")
    if scene.form.radius_y is not None:
        yield "radius_y", ("scene", "form", "radius_y")
    if "radius_y" in grid:
        yield "radius_y", ("grid", "radius_y")


def _of_touching_nodes(scene: Scene, grid: Grid) -> Iterator[tuple[str, Location]]:
    if _has_hardness(scene, grid):
        yield "hardness", ("scene", "interface", "hard_wall", "hardness")
        if scene.touches_inclined:
            yield "hardness on inclined surfaces", ("scene", "interface", "hard_wall", "hardness")
    friction = scene.interface.friction
    for i, coefficient in enumerate(grid.get("friction_coefficient", ())):
        if isinf(coefficient):
            yield "sticking", ("grid", "friction_coefficient", i)
    if "friction_coefficient" not in grid and friction is not None and isinf(friction.coefficient):
        yield "sticking", ("scene", "interface", "friction", "coefficient")


def _has_hardness(scene: Scene, grid: Grid) -> bool:
    return scene.interface.hardness is not None or "hardness" in grid


def _of_loading(scene: Scene, path: Sequence[Step]) -> Iterator[tuple[str, Location]]:
    if scene.loading.displacement is not None:
        yield "displacement", ("scene", "loading", "displacement")
        if scene.loading.displacement < 0.0:
            yield "negative displacement", ("scene", "loading", "displacement")
    for load in ("reduced_pressure", "line_load", "force"):
        if getattr(scene.loading, load) is not None:
            yield load, ("scene", "loading", load)
    if path:
        yield "path", ("path",)
    for i, step in enumerate(path):
        # how far a punch has slid that wears and nothing drags on, a half-space need not know
        drags = ("sliding",) if scene.interface.wear is None or scene.wears_by_slip else ()
        if scene.passes:
            drags = ("sliding over creep",)
        for name, end in zip(("sliding", "sliding_y"), (*scene.ends[::-1], False), strict=False):
            if getattr(step, name) is not None:
                yield from ((feature, ("path", i, name)) for feature in drags)
                if scene.passes and end and scene.surfaces:
                    yield "roughness over an end", ("path", i, name)
        if step.sliding_y is not None:
            yield "sliding_y", ("path", i, "sliding_y")
        if (step.displacement or 0.0) < 0.0:
            yield "negative displacement", ("path", i, "displacement")
    if scene.boundary is not None:
        given = [name for name, value in scene.boundary if isinstance(value, str)]
        yield from (("tractions of a file", ("scene", "boundary", name)) for name in given)
        names = [component.key("displacement") for component in COMPONENTS[2][::-1]]
        given = [name for name in names if getattr(scene.boundary, name) is not None]
        yield from (("prescribed displacement", ("scene", "boundary", name)) for name in given[:1])


def _half_spaces(scene: Scene, grid: Grid) -> Iterator[tuple[str, Location]]:
    for (name, axis), body in zip(_ASPECT_RATIO.items(), scene.deformable, strict=False):
        if body.is_half_space and axis not in grid:
            feature, key = ("half-space", "aspect_ratio") if body.layers is None else ("layers on a half-space", "base")
            yield feature, ("scene", name, key)
    for axis in _ASPECT_RATIO.values():
        for i, value in enumerate(grid.get(axis, ())):
            if isinf(value):
                yield "half-space", ("grid", axis, i)


def _without_a_period(scene: Scene, grid: Grid) -> Iterator[tuple[str, Location]]:
    """What the table refuses or may refuse of a scene without a period."""
    yield "no period", ("scene", "periodic")
    for name, body in zip(_ASPECT_RATIO, scene.deformable, strict=False):
        yield from _body_without_a_period(name, body, scene, grid)
    for place, surface in scene.surfaces.items():
        if isinstance(surface, Measured) and surface.periodic != "none" and all(scene.ends):
            yield "treated ends", ("scene", *place, "periodic")


def _body_without_a_period(name: str, body: Body, scene: Scene, grid: Grid) -> Iterator[tuple[str, Location]]:
    """What the table may refuse of one body around a window."""
    place, layers = ("scene", name), body.layers
    own: tuple[str | int, ...] = () if layers is None else ("layers", 0)
    heights: dict[Location, float] = {(*place, "aspect_ratio"): body.aspect_ratio}
    ratios: dict[Location, float] = {(*place, *own, "poissons_ratio"): body.surface_poissons_ratio}
    if layers is not None:
        whole = sum(layer.height for layer in layers) / (scene.length or 1.0)
        heights = {(*place, "layers"): inf if body.is_half_space else whole}
    elif (axis := _ASPECT_RATIO[name]) in grid:
        heights = {("grid", axis, i): height for i, height in enumerate(grid[axis])}
    if layers is None and (axis := _POISSONS_RATIO[name]) in grid:
        ratios = {("grid", axis, i): ratio for i, ratio in enumerate(grid[axis])}
    slabs = {at: height for at, height in heights.items() if not isinf(height)}
    rubs = scene.interface.couples or scene.boundary is not None
    if rubs:
        yield from (("tall slab", at) for at, height in slabs.items() if height > TALLEST)
    if rubs and len(slabs) < len(heights) and layers is not None:
        yield "layers that are rubbed", (*place, "base")
    elif rubs and len(slabs) < len(heights):
        stiff = (at for at, nu in ratios.items() if body.effective_poissons_ratio(nu) < LEAST_POISSONS_RATIO)
        yield from (("stiff sideways", at) for at in stiff)
    if any(rubs or height < LOWEST for height in slabs.values()):
        copies = {at: body.model_copy(update={"poissons_ratio": nu}) for at, nu in ratios.items()}
        yield from (("incompressible slab", at) for at, each in copies.items() if each.is_incompressible)
    if max(heights.values()) > SAMPLED:
        yield from (("soft below stiff", (*place, *at)) for at in _soft_below_stiff(body))


def _with_least_modulus(scene: Scene, location: Location, row: Refusal) -> Refusal:
    """The refusal of a layer that is too soft with the least modulus that is allowed there, all others as they are."""
    if row.refused != "soft below stiff":
        return row
    body = scene.deformable[list(_ASPECT_RATIO).index(str(location[1]))]
    least, given = _soft_below_stiff(body)[location[2:]]
    return replace(row, allowed=row.allowed.replace("at least", f"at least {in_unit_of(given, least, 'Pa')},"))


def _soft_below_stiff(body: Body) -> dict[Location, tuple[float, float]]:
    """Layers, or the base, whose modulus is far below one above, by the places of the moduli in the body.

    The least modulus that is allowed, and the one that is given.
    """
    parts: dict[Location, Layer | Material] = {("layers", i): each for i, each in enumerate(body.layers or ())}
    if isinstance(body.base, Material):
        parts["base",] = body.base
    stiffest, found = 0.0, {}
    for at, part in parts.items():
        if part.youngs_modulus < SOFTEST * stiffest:
            found[*at, "youngs_modulus"] = SOFTEST * stiffest, part.youngs_modulus
        stiffest = max(stiffest, part.youngs_modulus)
    return found


def _incompressible(scene: Scene, grid: Grid) -> Iterator[Location]:
    """Where the file says that no body changes its volume."""
    found: list[list[Location]] = []  # of each body
    for name, body in zip(_POISSONS_RATIO, scene.deformable, strict=False):
        axis = _POISSONS_RATIO[name]
        if axis in grid:
            copies = (body.model_copy(update={"poissons_ratio": value}) for value in grid[axis])
            found.append([("grid", axis, i) for i, copy in enumerate(copies) if copy.is_incompressible])
        else:
            layer = () if body.layers is None else ("layers", 0)
            found.append([("scene", name, *layer, "poissons_ratio")] if body.is_incompressible else [])
    if all(found):
        varied = [location for of_body in found for location in of_body if location[0] == "grid"]
        yield from varied or found[0]


def _solver_refusals(found: Features, numerics: Numerics) -> Iterator[tuple[Location, Refusal]]:
    """Refusals of a solver that cannot do what the scene asks for, and of options that it does not have."""
    needs = [name for name in ABILITIES if name in found]
    others = able(needs)
    solver = numerics.solver if numerics.solver != "auto" else next(iter(others), None)
    if solver is None:
        return
    lacks = [need for need in needs if need not in SOLVERS[solver].can]
    if lacks and found[lacks[0]][0][0] == "grid":
        allowed = {
            "rigid mean": f"a number below 0.5 with solver {solver}, as the mean displacement is rigid at 0.5",
            "sticking": f"a finite number with solver {solver}",
        }[lacks[0]]
        yield found[lacks[0]][0], Refusal(solver, lacks[0], allowed, "solver")
    elif lacks and others:
        named = ", ".join(f"'{other}'" for other in others)
        allowed = f"{named} or 'auto'{ABILITIES[lacks[0]]}"
        yield ("numerics", "solver"), Refusal(lacks[0], solver, allowed, "solver")
    if numerics.threads > 1 and not SOLVERS[solver].shares:
        sharing = ", ".join(name for name, each in SOLVERS.items() if each.shares)
        allowed = f"1 with solver {solver}, which works alone; more with {sharing}"
        yield ("numerics", "threads"), Refusal(solver, "threads", allowed, "without effect")
    for option in ("time_step", "damping"):
        if getattr(numerics, option) is not None and option not in SOLVERS[solver].options:
            having = ", ".join(name for name, each in SOLVERS.items() if option in each.options)
            allowed = f"nothing with solver {solver}, which has no {option}; these have one: {having}"
            yield ("numerics", option), Refusal(solver, option, allowed, "without effect")
