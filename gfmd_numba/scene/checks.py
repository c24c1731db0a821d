"""Checks of a scene that need more than its records: grids that fit in memory, waves that fit a grid."""

from collections.abc import Collection, Mapping

from gfmd_numba.scene.document import Document, Location
from gfmd_numba.scene.records import Discretisation, Scene

_ARRAYS = {1: 16, 2: 24}  # of its size that a realisation needs, for a profile and a map
_ARRAYS_OF_FRICTION = 160  # for a map whose tangential displacements are followed


def arrays_per_realisation(dimension: int, couples: bool) -> int:
    """Arrays of its size that solving a realisation needs; `couples` is whether tangential tractions act."""
    return _ARRAYS_OF_FRICTION if couples and dimension == 2 else _ARRAYS[dimension]


def check_discretisation(
    document: Document,
    discretisation: Discretisation,
    locations: Mapping[str, Location],
    varied: Collection[str] = (),
    dimension: int = 1,
    couples: bool = False,
) -> None:
    """Raise InputError, at one of the varied values if any, unless waves are whole and the grid fits in memory."""
    import psutil

    eps = discretisation.model_dump()
    nx = discretisation.waves["eps_c"]
    nodes = nx * nx if dimension == 2 else nx  # a power of floats raises where their product is infinite
    needed = 8 * nodes * arrays_per_realisation(dimension, couples) / 1e9
    available = psutil.virtual_memory().total / 1e9
    if needed > available:
        axis = min(varied or eps, key=eps.__getitem__)
        raise document.error(
            locations[axis],
            document.value(locations[axis]),
            f"a grid that fits in {available:.3g} GB of memory, where nx = {nx:.6g} needs {needed:.3g} GB",
        )
    misfit = discretisation.misfit
    if misfit is not None:
        axis = misfit if not varied or misfit in varied else next(iter(varied))
        others = " and ".join(f"{name} = {value:.6g}" for name, value in eps.items() if name != axis)
        fit = discretisation.nearest_fit(axis)
        raise document.error(
            locations[axis],
            document.value(locations[axis]),
            "a value that makes 1/eps_t, 1/(eps_t eps_f) and nx = 2/(eps_t eps_f eps_c) whole numbers, "
            f"nx at least 4, with {others}",
            "" if fit is None else f"did you mean {fit}?",
        )


def check_surfaces(document: Document, scene: Scene) -> None:
    """Raise InputError for surfaces whose own points do not fit in memory."""
    for place, surface in scene.surfaces.items():
        if surface.points is not None:
            couples = scene.interface.couples
            check_memory(document, ("scene", *place, "points"), surface.points, scene.dimension, couples)


def check_memory(document: Document, location: Location, points: int, dimension: int, couples: bool) -> None:
    """Raise InputError for a surface of so many points each way that does not fit in memory."""
    if allowed := smaller_than(float(points) ** dimension, dimension, couples):
        raise document.error(location, points, allowed)


def smaller_than(nodes: float, dimension: int, couples: bool = False) -> str:
    """What is allowed in place of a grid of so many nodes that does not fit in memory; nothing of one that does."""
    import psutil

    needed = 8 * nodes * arrays_per_realisation(dimension, couples) / 1e9
    available = psutil.virtual_memory().total / 1e9
    if needed <= available:
        return ""
    return f"a grid that fits in {available:.3g} GB of memory, where this needs {needed:.3g} GB"


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
