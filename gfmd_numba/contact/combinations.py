"""What does not go together in a scene: one table, and the refusals that follow from it and from the solvers' table.

Pure data and records: importing it compiles nothing.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from gfmd_numba.scene import COMPONENTS, Body, Document, InputError, LoadedBody, Measured, Numerics, Scene
from gfmd_numba.scene.document import Location, brief
from gfmd_numba.scene.surfaces import OF_MAPS
from gfmd_numba.solvers.table import ABILITIES, SOLVERS, able

Grid = Mapping[str, Sequence[float]]  # values that a campaign takes in place of its scene's
Features = dict[str, Location]  # what a scene has, and where it stands in the file


@dataclass(frozen=True)
class Refusal:
    """Two features that do not go together, what is allowed in place of the second, and why."""

    beside: str
    refused: str
    allowed: str
    because: Literal["physics", "not built yet", "without effect"]


_DRAGS = (
    "nothing that drags where a deformable body is rough or both deform: only normal tractions are followed there; "
    "map the roughness to a rigid punch"
)
_RANDOM_MAP = "a random surface with dimension 2, like method 'psd', not a flat or measured punch"
_COMPRESSIBLE = (
    "a number below 0.5, as no solver combines a rigid mean displacement with friction or an interaction law"
)
_DOUBLE = "'double' but for a frictionless hard wall of a punch on a smooth body"
_ELSEWHERE = "nothing in a campaign; it belongs to `gfmd solve`"
_RANDOM = "a random surface in a campaign, like method 'psd'; a measured profile belongs to `gfmd solve`"

REFUSALS = (
    Refusal("dimension 2", "flat punch", _RANDOM_MAP, "not built yet"),
    Refusal("dimension 2", "measured punch", _RANDOM_MAP, "not built yet"),
    *(
        Refusal("dimension 2", law, f"hard_wall alone with dimension 2; {law} needs dimension 1", "not built yet")
        for law in ("exponential", "cohesive", "friction")
    ),
    Refusal("dimension 2", "boundary", "nothing with dimension 2; a boundary needs dimension 1", "not built yet"),
    Refusal(
        "dimension 2", "counter_body", "nothing with dimension 2; two elastic bodies need dimension 1", "not built yet"
    ),
    Refusal("dimension 2", "rough body", "nothing with dimension 2; a rough body needs dimension 1", "not built yet"),
    Refusal(
        "dimension 2",
        "plane stress",
        "'plane_strain' with dimension 2, where E* is the same and nothing plane",
        "physics",
    ),
    Refusal("dimension 1", "anisotropy", "nothing with dimension 1; anisotropy needs dimension 2", "physics"),
    Refusal("dimension 1", "model of maps", "another model with dimension 1; this one has two directions", "physics"),
    Refusal("topography", "stiffness_scale", "1 where a deformable body is rough or both deform", "not built yet"),
    Refusal("topography", "friction", _DRAGS, "not built yet"),
    Refusal("topography", "cohesive", _DRAGS, "not built yet"),
    Refusal("topography", "boundary", "nothing where a deformable body is rough or both deform", "not built yet"),
    Refusal(
        "punch",
        "prescribed displacement",
        "tractions beside a punch, which prescribes displacements itself (sticking: friction with coefficient .inf); "
        "without roughness, interface and loading both",
        "physics",
    ),
    Refusal(
        "cohesive",
        "boundary",
        "nothing beside a cohesive law, whose slip counts from the unloaded body",
        "not built yet",
    ),
    *(Refusal(law, "rigid mean", _COMPRESSIBLE, "not built yet") for law in ("exponential", "cohesive", "friction")),
    *(
        Refusal(feature, "single", _DOUBLE, "not built yet")
        for feature in ("exponential", "cohesive", "friction", "topography", "loaded body")
    ),
    Refusal("campaign", "flat punch", _RANDOM, "not built yet"),
    Refusal("campaign", "measured punch", _RANDOM, "not built yet"),
    Refusal("campaign", "rough body", _ELSEWHERE, "not built yet"),
    Refusal("campaign", "counter_body", _ELSEWHERE, "not built yet"),
    Refusal("campaign", "boundary", _ELSEWHERE, "not built yet"),
    Refusal(
        "smooth bodies",
        "topography_order",
        "nothing where no deformable body is rough and only one deforms: there is no topography to follow",
        "without effect",
    ),
)


def check_combination(
    document: Document, scene: Scene | LoadedBody, numerics: Numerics, grid: Grid | None = None
) -> None:
    """Raise InputError, one line for each fault, if a scene and its numerics do not go together.

    `grid` is what a campaign varies, None for a scene on its own.
    """
    found = _features(scene, numerics, grid)
    refused: dict[Location, str] = {}
    for row in REFUSALS:
        if row.beside in found and row.refused in found:
            reason = f" ({row.because})" if row.because == "not built yet" else ""
            refused.setdefault(found[row.refused], row.allowed + reason)
    for location, allowed in _solver_refusals(found, numerics):
        refused.setdefault(location, allowed)
    if refused:
        raise InputError(*(document.line(at, brief(document.value(at)), allowed) for at, allowed in refused.items()))


def _features(scene: Scene | LoadedBody, numerics: Numerics, grid: Grid | None) -> Features:
    """What is in a scene, and where it stands in the file."""
    found: Features = {}
    if numerics.precision == "single":
        found["single"] = ("numerics", "precision")
    if numerics.topography_order is not None:
        found["topography_order"] = ("numerics", "topography_order")
    if isinstance(scene, LoadedBody):
        return found | dict.fromkeys(("loaded body", "prescribed", "smooth bodies"), ("scene", "boundary"))
    found |= {"punch": ("scene",), f"dimension {scene.dimension}": ("scene", "dimension")}
    found |= {law: ("scene", "interface", law) for law in scene.interface.laws}
    found |= dict(_surfaces(scene))
    found["topography" if scene.follows_topography else "smooth bodies"] = ("scene", "body")
    if scene.boundary is not None:
        found["boundary"] = ("scene", "boundary")
        for name in (f"{component}_displacement" for component in COMPONENTS):
            if getattr(scene.boundary, name) is not None:
                found.setdefault("prescribed displacement", ("scene", "boundary", name))
    if grid is not None:
        found["campaign"] = ()
        if "anisotropy" in grid:
            found["anisotropy"] = ("grid", "anisotropy")
    rigid = _rigid_mean(scene, grid or {})
    return found if rigid is None else found | {"rigid mean": rigid}


def _surfaces(scene: Scene) -> Iterator[tuple[str, Location]]:
    """What the bodies and their surfaces are, the body's own last, so that it is the one that is told."""
    if scene.roughness is None or isinstance(scene.roughness, Measured):
        yield "flat punch" if scene.roughness is None else "measured punch", ("scene", "roughness", "method")
    bodies: dict[str, Body | None] = {"counter_body": scene.counter_body, "body": scene.body}
    if scene.counter_body is not None:
        yield "counter_body", ("scene", "counter_body")
    if scene.body.roughness is not None:
        yield "rough body", ("scene", "body", "roughness")
    if scene.body.state == "plane_stress":
        yield "plane stress", ("scene", "body", "state")
    for name, body in bodies.items():
        if body is not None and body.stiffness_scale != 1.0:
            yield "stiffness_scale", ("scene", name, "stiffness_scale")
        if body is not None and getattr(body.roughness, "anisotropy", None) is not None:
            yield "anisotropy", ("scene", name, "roughness", "anisotropy")
    for place, surface in scene.surfaces.items():
        if isinstance(surface, OF_MAPS):
            yield "model of maps", ("scene", *place, "model")
    if getattr(scene.roughness, "anisotropy", None) is not None:
        yield "anisotropy", ("scene", "roughness", "anisotropy")


def _rigid_mean(scene: Scene, grid: Grid) -> Location | None:
    """Where the file says that the mean displacement is rigid: that of incompressible bodies, which is prescribed."""
    if scene.loading.displacement is None:
        return None
    for i, value in enumerate(grid.get("poissons_ratio", ())):
        if scene.body.model_copy(update={"poissons_ratio": value}).effective_poissons_ratio == 0.5:
            return "grid", "poissons_ratio", i
    incompressible = all(body.effective_poissons_ratio == 0.5 for body in scene.deformable)
    return ("scene", "body", "poissons_ratio") if incompressible and "poissons_ratio" not in grid else None


def _solver_refusals(found: Features, numerics: Numerics) -> Iterator[tuple[Location, str]]:
    """Refusals of a solver that cannot do what the scene asks for, and of options that it does not have."""
    needs = [name for name in ABILITIES if name in found]
    others = able(needs)
    solver = numerics.solver if numerics.solver != "auto" else next(iter(others), None)
    if solver is None:
        return
    lacks = [need for need in needs if need not in SOLVERS[solver].can]
    if lacks and found[lacks[0]][0] == "grid":
        allowed = f"a number below 0.5 with solver {solver}, as the mean displacement is rigid at 0.5"
        yield found[lacks[0]], allowed
    elif lacks and others:
        named = ", ".join(f"'{other}'" for other in others)
        yield ("numerics", "solver"), f"{named} or 'auto'{ABILITIES[lacks[0]]}"
    for option in ("time_step", "damping"):
        if getattr(numerics, option) is not None and option not in SOLVERS[solver].options:
            having = ", ".join(name for name, each in SOLVERS.items() if option in each.options)
            yield ("numerics", option), f"nothing with solver {solver}, which has no {option}; these have one: {having}"
