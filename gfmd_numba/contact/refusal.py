"""Refuse a scene by the tables of combinations and of solvers, every fault on a line of its own."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from math import inf, isinf
from typing import Literal

from gfmd_numba.contact.combinations import LEAST_POISSONS_RATIO, LOWEST, REFUSALS, SAMPLED, SOFTEST, TALLEST, Refusal
from gfmd_numba.scene import COMPONENTS, Body, Document, InputError, Measured, Numerics, Scene
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
    document: Document, scene: Scene, numerics: Numerics, path: Sequence[Step] = (), grid: Grid | None = None
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


Asked = Iterator[tuple[str, Location, bool]]  # a feature, where it stands in the file, and whether it is there


def _features(scene: Scene, numerics: Numerics, path: Sequence[Step], grid: Grid | None) -> dict[str, list[Location]]:
    found: dict[str, list[Location]] = {}
    parts, campaign = [_of_numerics(numerics), _of_bodies(scene)], ("campaign", ("grid",), grid is not None)
    if scene.has_punch:
        given = grid or {}
        around = _without_a_period(scene, given) if any(scene.ends) else _half_spaces(scene, given)
        parts += [_of_laws(scene, given), _of_time(scene, path), around, _of_form(scene, given)]
        parts += [_of_loading(scene, path, given), _of_boundary(scene), _of_shape(scene, given)]
    else:
        parts.append(iter([("prescribed", ("scene", "boundary"), True)]))
        parts.append(iter([("no period", ("scene", "periodic"), any(scene.ends))]))
    for feature, location, is_there in chain(*parts, [campaign]):
        if is_there:
            found.setdefault(feature, []).append(location)
    return found


def _of_numerics(numerics: Numerics) -> Asked:
    order = numerics.topography_order
    yield "time_tolerance", ("numerics", "time_tolerance"), numerics.time_tolerance is not None
    yield "named solver", ("numerics", "solver"), numerics.solver != "auto"
    yield "threads", ("numerics", "threads"), numerics.threads > 1
    yield "topography_order", ("numerics", "topography_order"), order is not None
    yield "higher topography_order", ("numerics", "topography_order"), bool(order)


def _of_bodies(scene: Scene) -> Asked:
    yield f"dimension {scene.dimension}", ("scene", "dimension"), True
    yield "plane stress", ("scene", "body", "state"), scene.body.state == "plane_stress"
    yield "smooth bodies", ("scene", "body"), not scene.follows_topography
    yield "elastic bodies", ("scene", "body"), not scene.creeps
    yield "timeless", ("scene", "body"), not scene.creeps and not scene.has_slip_rates
    yield "undivided steps", ("scene", "body"), not scene.creeps and scene.interface.wear is None
    for name, body in scene.deformable.items():
        yield "relaxation", ("scene", name, "relaxation"), body.relaxation is not None
        yield "plasticity", ("scene", name, "plasticity"), body.plasticity is not None
    for place, surface in scene.surfaces.items():
        yield "anisotropy", ("scene", *place, "anisotropy"), getattr(surface, "anisotropy", None) is not None
        yield "measured surface", ("scene", *place, "method"), isinstance(surface, Measured) and scene.has_punch
        if isinstance(surface, Random):
            yield "surface made as a whole", ("scene", *place), not surface.by_columns
            yield "model of maps", ("scene", *place, surface.named_by), surface.of_maps
    for name, value in scene.boundary or ():
        yield "boundary along y", ("scene", "boundary", name), value is not None and name.endswith("_y")


def _of_shape(scene: Scene, grid: Grid) -> Asked:
    counter = scene.counter_body
    yield "punch", ("scene",), True
    yield "rough bodies", ("scene", "counter_body"), counter is not None
    unlike = counter is not None and scene.creeps and not _give_way_alike(scene, grid)
    yield "unlike bodies", ("scene", "counter_body"), unlike
    yield "rough bodies", ("scene", "body", "roughness"), counter is None and scene.follows_topography
    yield "period along one axis", ("scene", "periodic"), isinstance(scene.periodic, str)
    is_slab = scene.body.thinnest_layer(scene.length) < inf or "aspect_ratio" in grid
    yield "slab", ("scene", "body"), is_slab
    yield "anisotropy", ("grid", "anisotropy"), "anisotropy" in grid


def _give_way_alike(scene: Scene, grid: Grid) -> bool:
    """Whether the compliances of two bodies, to pressures alone, have one ratio for all waves."""
    if scene.interface.couples or any(axis in grid for axis in _ASPECT_RATIO.values()):
        return False
    if all(body.is_half_space and body.layers is None for body in scene.deformable.values()):
        return True
    from gfmd_numba.elasticity.scales import scales_of  # numbers, which the tables do without

    one, other = scales_of(scene).bodies
    return one == other and not any(axis in grid for axis in _POISSONS_RATIO.values())


def _of_laws(scene: Scene, grid: Grid) -> Asked:
    acting, place = scene.interface, ("scene", "interface")
    for name, law in acting.laws.items():
        for feature in dict.fromkeys((name, law.ability)):
            yield feature, (*place, name), True
        if isinstance(law, Friction):
            yield "slip rate", (*place, name), law.depends_on_rate
            yield "function", (*place, name, "function"), law.function is not None
        if isinstance(law, LawOfTheGap):
            yield "pattern", (*place, name, "pattern"), law.pattern is not None
    has_hardness = acting.hardness is not None or "hardness" in grid
    yield "hardness", (*place, "hard_wall", "hardness"), has_hardness
    yield "hardness on inclined surfaces", (*place, "hard_wall", "hardness"), has_hardness and scene.touches_inclined
    for i, coefficient in enumerate(grid.get("friction_coefficient", ())):
        yield "sticking", ("grid", "friction_coefficient", i), isinf(coefficient)
    sticks = acting.friction is not None and isinf(acting.friction.coefficient)
    yield "sticking", (*place, "friction", "coefficient"), "friction_coefficient" not in grid and sticks
    yield "contact without drag", place, not acting.couples and acting.wear is None
    yield "contact without reach", place, not acting.reaches_across


def _of_time(scene: Scene, path: Sequence[Step]) -> Asked:
    """Features that take time, or depend on how far the punch has slid."""
    loads: list[tuple[Location, Controls]] = [(("scene", "loading"), scene.loading)]
    for place, load in (*loads, *((("path", i), step) for i, step in enumerate(path))):
        yield "at once", place, load.duration is None
        yield "duration", (*place, "duration"), load.duration is not None
    yield "speed", ("scene", "loading", "speed"), scene.loading.speed is not None
    wears = scene.interface.wear is not None
    slides = any(step.sliding is not None or step.sliding_y is not None for step in path)
    yield "wear", ("scene", "interface", "wear"), wears
    yield "no sliding", ("path",), wears and not slides


def _of_form(scene: Scene, grid: Grid) -> Asked:
    if scene.form is not None:
        yield "form", ("scene", "form"), True
        yield "form alone", ("scene", "form"), not scene.surfaces
        yield "form between elastic bodies", ("scene", "form"), scene.counter_body is not None
        yield "radius_y", ("scene", "form", "radius_y"), scene.form.radius_y is not None
        yield "radius_y", ("grid", "radius_y"), "radius_y" in grid


def _of_loading(scene: Scene, path: Sequence[Step], grid: Grid) -> Asked:
    load, displaces = scene.loading, scene.loading.displacement is not None
    yield "displacement", ("scene", "loading", "displacement"), displaces
    yield "negative displacement", ("scene", "loading", "displacement"), (load.displacement or 0.0) < 0.0
    for name in ("reduced_pressure", "line_load", "force"):
        yield name, ("scene", "loading", name), getattr(load, name) is not None
    yield "path", ("path",), bool(path)
    # how far a punch has slid that wears and nothing drags on, a half-space need not know
    drags = scene.interface.wear is None or scene.wears_by_slip
    for i, step in enumerate(path):
        for name, end in zip(("sliding", "sliding_y"), (*scene.ends[::-1], False), strict=False):
            place, slides = ("path", i, name), getattr(step, name) is not None
            yield "sliding", place, slides and drags and not scene.passes
            yield "sliding over creep", place, slides and scene.passes
            yield "roughness over an end", place, slides and scene.passes and end and bool(scene.surfaces)
        yield "sliding_y", ("path", i, "sliding_y"), step.sliding_y is not None
        yield "negative displacement", ("path", i, "displacement"), (step.displacement or 0.0) < 0.0
    for i, value in enumerate(grid.get("displacement", ())):
        yield "negative displacement", ("grid", "displacement", i), value < 0.0
    for location in _incompressible(scene, grid) if displaces and not any(scene.ends) else ():
        yield "rigid mean", location, True


def _of_boundary(scene: Scene) -> Asked:
    yield "boundary", ("scene", "boundary"), scene.boundary is not None
    for name, value in scene.boundary or ():
        yield "tractions of a file", ("scene", "boundary", name), isinstance(value, str)
    names = [component.key("displacement") for component in COMPONENTS[2][::-1]]
    for name in [name for name in names if getattr(scene.boundary, name, None) is not None][:1]:
        yield "prescribed displacement", ("scene", "boundary", name), True


def _half_spaces(scene: Scene, grid: Grid) -> Asked:
    for name, body in scene.deformable.items():
        feature, key = ("half-space", "aspect_ratio") if body.layers is None else ("layers on a half-space", "base")
        yield feature, ("scene", name, key), body.is_half_space and _ASPECT_RATIO[name] not in grid
    for axis in _ASPECT_RATIO.values():
        for i, value in enumerate(grid.get(axis, ())):
            yield "half-space", ("grid", axis, i), isinf(value)


def _without_a_period(scene: Scene, grid: Grid) -> Asked:
    """What the table refuses or may refuse of a scene without a period."""
    yield "no period", ("scene", "periodic"), True
    for name, body in scene.deformable.items():
        yield from _body_without_a_period(name, body, scene, grid)
    for place, surface in scene.surfaces.items():
        is_treated = isinstance(surface, Measured) and surface.periodic != "none"
        yield "treated ends", ("scene", *place, "periodic"), is_treated and all(scene.ends)


def _body_without_a_period(name: str, body: Body, scene: Scene, grid: Grid) -> Asked:
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
    slabs = [height for height in heights.values() if not isinf(height)]
    rubs, is_deep = scene.interface.couples or scene.boundary is not None, len(slabs) < len(heights)
    for at, height in heights.items():
        yield "tall slab", at, rubs and TALLEST < height < inf
    yield "layers that are rubbed", (*place, "base"), rubs and is_deep and layers is not None
    low = any(rubs or height < LOWEST for height in slabs)
    for at, nu in ratios.items():
        stiff = layers is None and body.effective_poissons_ratio(nu) < LEAST_POISSONS_RATIO
        yield "stiff sideways", at, rubs and is_deep and stiff
        yield "incompressible slab", at, low and body.model_copy(update={"poissons_ratio": nu}).is_incompressible
    for where in _soft_below_stiff(body):
        yield "soft below stiff", (*place, *where), max(heights.values()) > SAMPLED


def _with_least_modulus(scene: Scene, location: Location, row: Refusal) -> Refusal:
    """The refusal of a layer that is too soft with the least modulus that is allowed there, all others as they are."""
    if row.refused != "soft below stiff":
        return row
    least, given = _soft_below_stiff(scene.deformable[str(location[1])])[location[2:]]
    return replace(row, allowed=row.allowed.replace("at least", f"at least {in_unit_of(given, least, 'Pa')},"))


def _soft_below_stiff(body: Body) -> dict[Location, tuple[float, float]]:
    """Layers, or the base, whose modulus is far below one above, by the places of the moduli in the body.

    The least modulus that is allowed, and the one that is given.
    """
    stiffest, found = 0.0, {}
    for at, part in body.materials.items():
        if part.youngs_modulus < SOFTEST * stiffest:
            found[*at, "youngs_modulus"] = SOFTEST * stiffest, part.youngs_modulus
        stiffest = max(stiffest, part.youngs_modulus)
    return found


def _incompressible(scene: Scene, grid: Grid) -> Iterator[Location]:
    """Where the file says that no body changes its volume."""
    found: list[list[Location]] = []  # of each body
    for name, body in scene.deformable.items():
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
    if numerics.threads > 1 and not SOLVERS[solver].shares_threads:
        sharing = ", ".join(name for name, each in SOLVERS.items() if each.shares_threads)
        allowed = f"1 with solver {solver}, which works alone; more with {sharing}"
        yield ("numerics", "threads"), Refusal(solver, "threads", allowed, "without effect")
    for option in ("time_step", "damping"):
        if getattr(numerics, option) is not None and option not in SOLVERS[solver].options:
            having = ", ".join(name for name, each in SOLVERS.items() if option in each.options)
            allowed = f"nothing with solver {solver}, which has no {option}; these have one: {having}"
            yield ("numerics", option), Refusal(solver, option, allowed, "without effect")
