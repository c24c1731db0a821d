"""Checks of a scene that need more than its records: grids that fit in memory, waves that fit a grid."""

from collections.abc import Collection, Mapping
from math import prod

from gfmd_numba.scene.document import Document, Location
from gfmd_numba.scene.memory import beyond_memory
from gfmd_numba.scene.records import Discretisation, LoadedBody, Scene


def check_discretisation(
    document: Document,
    discretisation: Discretisation,
    locations: Mapping[str, Location],
    varied: Collection[str] = (),
    dimension: int = 1,
    arrays: int = 0,
) -> None:
    """Raise InputError, at one of the varied values if any, unless waves are whole and arrays of the grid fit."""
    eps = discretisation.model_dump()
    nx = discretisation.waves["eps_c"]
    nodes = prod((nx,) * dimension)  # a power of floats raises where their product is infinite
    if allowed := beyond_memory(nodes, arrays, f"nx = {nx:.6g}"):
        axis = min(varied or eps, key=eps.__getitem__)
        raise document.error(locations[axis], document.value(locations[axis]), allowed)
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


def check_surfaces(document: Document, scene: Scene | LoadedBody, arrays: int) -> None:
    """Raise InputError for surfaces whose own points are too many for so many arrays to fit in memory."""
    form = scene.form if isinstance(scene, Scene) else None
    for place, surface in (scene.surfaces | ({} if form is None else {("form",): form})).items():
        if surface.points is not None:
            check_points(document, ("scene", *place, "points"), surface.points, scene.dimension, arrays)


def check_points(document: Document, location: Location, points: int, dimension: int, arrays: int) -> None:
    """Raise InputError for a surface of so many points each way that arrays of its size do not fit in memory."""
    if allowed := beyond_memory(float(points) ** dimension, arrays):
        raise document.error(location, points, allowed)


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
