"""Whether what is solved fits in the memory of this machine, by the arrays of the size of its grid."""

from collections.abc import Iterable

# of the size of a realisation that solving it takes, as measured on a dense contact (`benchmarks/memory.py`)
_ARRAYS = {1: 72, 2: 24}
_ARRAYS_OF_LAWS = {
    (1, "friction"): 180,
    (2, "friction"): 256,
    (2, "exponential"): 32,
    (2, "cohesive"): 96,
    (2, "boundary"): 32,
}
_ARRAYS_OF_TOPOGRAPHY, _ARRAYS_OF_ORDER = {1: 128, 2: 56}, {1: 48, 2: 60}  # at order 0, and more for each order
_ARRAYS_OF_INCLINED_SURFACES = 56  # and more above order 0
_ARRAYS_OF_STABILITY = 64  # to find how near a fold each step of a path is
_ARRAYS_OF_A_LOADED_BODY = {1: 32, 2: 48}
_FIELDS = {1: 7, 2: 9}  # of each step of a path that stay in memory, tangential ones and slip too
_FIELDS_WITHOUT_DRAG = 4
ARRAYS_OF_A_SURFACE = 16  # that making a surface alone and its statistics may take


def arrays_per_realisation(dimension: int, laws: Iterable[str], periodic: bool = True) -> int:
    """Return how many arrays of its size solving a realisation takes; `laws`, and a `boundary`, are keys of scenes.

    Without a period it is solved on a grid of twice as many nodes along each direction.
    """
    arrays = max([_ARRAYS[dimension], *(_ARRAYS_OF_LAWS.get((dimension, law), 0) for law in laws)])
    return arrays if periodic else arrays * 2**dimension


def arrays_of_topography(dimension: int, order: int) -> int:
    """Return how many arrays of its size a contact of rough bodies takes, at an order in the slope."""
    more = _ARRAYS_OF_INCLINED_SURFACES if order > 0 else 0
    return _ARRAYS_OF_TOPOGRAPHY[dimension] + order * _ARRAYS_OF_ORDER[dimension] + more


def arrays_of_a_loaded_body(dimension: int, order: int | None = None) -> int:
    """Return how many arrays of its size loading a body without a punch takes, a rough one at an order in the slope.

    The next order, whose response tells what it would add, takes most.
    """
    return _ARRAYS_OF_A_LOADED_BODY[dimension] + (0 if order is None else arrays_of_topography(dimension, order + 1))


def arrays_of_path(dimension: int, laws: Iterable[str], steps: int) -> int:
    """Return how many more arrays a path of so many steps takes whose fields are written; none without steps."""
    if steps == 0:
        return 0
    acting = set(laws)
    fields = _FIELDS[dimension] if acting & {"friction", "cohesive"} else _FIELDS_WITHOUT_DRAG
    return 2 * fields * (1 + steps) + (_ARRAYS_OF_STABILITY if "exponential" in acting else 0)  # joined: twice


def beyond_memory(nodes: float, arrays: int, whose: str = "this") -> str:
    """Return what is allowed in place of so many arrays of so many nodes; nothing if they fit in memory."""
    import psutil

    needed, available = 8 * nodes * arrays / 1e9, psutil.virtual_memory().total / 1e9
    if needed <= available:
        return ""
    return f"a grid that fits in {available:.3g} GB of memory, where {whose} needs {needed:.3g} GB"
