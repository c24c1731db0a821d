"""Checks of a scene that need more than its records: grids that fit in memory, waves that fit a grid."""

from collections.abc import Collection, Iterable, Mapping
from math import prod

from gfmd_numba.scene.document import Document, Location
from gfmd_numba.scene.interface_records import LAWS_OF_THE_GAP
from gfmd_numba.scene.records import Discretisation, Scene

# of the size of a realisation that solving it takes, as measured on a dense contact (`benchmarks/memory.py`)
_ARRAYS = {1: 72, 2: 24}
_ARRAYS_OF_LAWS = {
    (1, "friction"): 180,
    (2, "friction"): 256,
    **{(2, law): 32 for law in LAWS_OF_THE_GAP},
    (2, "cohesive"): 112,
    (2, "boundary"): 32,
}
_ARRAYS_OF_TOPOGRAPHY, _ARRAYS_OF_ORDER = {1: 128, 2: 56}, {1: 48, 2: 60}  # at order 0, and more for each order
_ARRAYS_OF_INCLINED_SURFACES = 56  # and more above order 0
_ARRAYS_OF_STABILITY = 64  # to find how near a fold each step of a path is
_ARRAYS_WITHOUT_A_PUNCH = {1: 32, 2: 48}
_ARRAYS_OF_A_SUBLAYER = {1: 36, 2: 60}
_ARRAYS_OF_A_BRANCH, _ARRAYS_OF_WEAR = 24, 8
_FIELDS = {1: 7, 2: 9}  # of each step of a path that stay in memory, tangential ones and slip too
_FIELDS_WITHOUT_DRAG = 4
ARRAYS_OF_A_SURFACE = 16  # that making a surface alone and its statistics may take


def arrays_per_realisation(dimension: int, laws: Iterable[str], ends: Iterable[bool] = ()) -> int:
    """Return how many arrays of its size solving a realisation takes; `laws`, and a `boundary`, are keys of scenes.

    It is solved on a grid of twice as many nodes along each direction in which it `ends`.
    """
    arrays = max([_ARRAYS[dimension], *(_ARRAYS_OF_LAWS.get((dimension, law), 0) for law in laws)])
    return int(arrays * 2 ** sum(ends))


def arrays_of_topography(dimension: int, order: int) -> int:
    """Return how many arrays of its size a contact of rough bodies takes, at an order in the slope."""
    more = _ARRAYS_OF_INCLINED_SURFACES if order > 0 else 0
    return _ARRAYS_OF_TOPOGRAPHY[dimension] + order * _ARRAYS_OF_ORDER[dimension] + more


def arrays_of(scene: Scene, order: int, steps: int = 0) -> int:
    """Return how many arrays of its size solving a scene takes, at an order in the slope, along so many steps.

    Without a punch, a rough body takes most to tell what the next order would add.
    """
    dimension = scene.dimension
    if not scene.has_punch:
        rough = arrays_of_topography(dimension, 1 + order) if scene.follows_topography else 0
        return _ARRAYS_WITHOUT_A_PUNCH[dimension] + rough
    laws = [*scene.interface.laws, *(() if scene.boundary is None else ("boundary",))]
    arrays = arrays_per_realisation(dimension, laws, scene.ends) + arrays_of_memory(scene)
    if scene.follows_topography:
        arrays = max(arrays, arrays_of_topography(dimension, order))
    return arrays + arrays_of_path(dimension, laws, steps)


def arrays_of_path(dimension: int, laws: Iterable[str], steps: int) -> int:
    """Return how many more arrays a path of so many steps takes whose fields are written; none without steps."""
    if steps == 0:
        return 0
    acting = set(laws)
    fields = _FIELDS[dimension] if acting & {"friction", "cohesive"} else _FIELDS_WITHOUT_DRAG
    return 2 * fields * (1 + steps) + (_ARRAYS_OF_STABILITY if acting & LAWS_OF_THE_GAP else 0)  # joined: twice


def arrays_of_memory(scene: Scene) -> int:
    """Return how many more arrays the past of a scene takes: of a body that creeps or flows, of a punch that wears."""
    branches, plasticity = sum(len(body.relaxation or ()) for body in scene.deformable.values()), scene.body.plasticity
    flow = 0 if plasticity is None else _ARRAYS_OF_A_SUBLAYER[scene.dimension] * plasticity.sublayers
    return flow + _ARRAYS_OF_A_BRANCH * branches + (_ARRAYS_OF_WEAR if scene.interface.wear is not None else 0)


def beyond_memory(nodes: float, arrays: int, whose: str = "this") -> str:
    """Return what is allowed in place of so many arrays of so many nodes; nothing if they fit in memory."""
    import psutil

    needed, available = 8 * nodes * arrays / 1e9, psutil.virtual_memory().total / 1e9
    if needed <= available:
        return ""
    return f"a grid that fits in {available:.3g} GB of memory, where {whose} needs {needed:.3g} GB"


def check_discretisation(
    document: Document,
    discretisation: Discretisation,
    locations: Mapping[str, Location],
    varied: Collection[str],
    dimension: int,
    arrays: int,
) -> None:
    """Raise InputError, at one of the varied values if any, unless waves are whole and arrays of the grid fit."""
    eps = discretisation.model_dump()
    nx = discretisation.waves["eps_c"]
    nodes = prod((nx,) * dimension)  # a power of floats raises where their product is infinite
    if allowed := beyond_memory(nodes, arrays, f"nx = {nx:.6g}"):
        axis = min(varied or eps, key=eps.__getitem__)
        raise document.refused(locations[axis], allowed)
    misfit = discretisation.misfit
    if misfit is not None:
        axis = misfit if not varied or misfit in varied else next(iter(varied))
        others = " and ".join(f"{name} = {value:.6g}" for name, value in eps.items() if name != axis)
        fit = discretisation.nearest_fit(axis)
        raise document.refused(
            locations[axis],
            "a value that makes 1/eps_t, 1/(eps_t eps_f) and nx = 2/(eps_t eps_f eps_c) whole numbers, "
            f"nx at least 4, with {others}",
            "" if fit is None else f"did you mean {fit}?",
        )


def check_surfaces(document: Document, scene: Scene, arrays: int) -> None:
    """Raise InputError for surfaces whose own points are too many for so many arrays to fit in memory."""
    for place, surface in (scene.surfaces | ({} if scene.form is None else {("form",): scene.form})).items():
        if surface.points is not None:
            check_nodes(document, ("scene", *place, "points"), float(surface.points) ** scene.dimension, arrays)


def check_nodes(document: Document, location: Location, nodes: float, arrays: int) -> None:
    """Raise InputError for what stands there if so many arrays of so many nodes do not fit in memory."""
    if allowed := beyond_memory(nodes, arrays):
        raise document.refused(location, allowed)


def check_anisotropy_fits(
    document: Document, anisotropy: float, location: Location, discretisation: Discretisation
) -> None:
    """Raise InputError unless the longest wavelength along y, L_x eps_t anisotropy, fits the period."""
    most = 1 / discretisation.eps_t
    if anisotropy > most * (1 + 1e-9):
        raise document.error(
            location,
            anisotropy,
            f"at most 1/eps_t = {most:.6g}, so that the longest wavelength along y fits the period; "
            "a smaller eps_t allows more",
        )
