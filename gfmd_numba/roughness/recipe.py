"""From the record of a random surface to the ensemble it describes, in units of its period."""

from pkgutil import resolve_name

from gfmd_numba.roughness.generators import Maker, RandomSurface, gradient_over_height
from gfmd_numba.scene.records import Discretisation
from gfmd_numba.scene.reduced_units import in_reduced_units
from gfmd_numba.scene.surfaces import Random


def random_surface(
    record: Random, discretisation: Discretisation | None, period: float, dimension: int, seed: int
) -> RandomSurface:
    """Ensemble of a record, whose lengths are in the unit of `period`.

    Grid and wavelengths that the record leaves open are those of the discretisation. Raises ValueError for lengths that
    do not go with the period.
    """
    record, period = in_reduced_units(record, period, 1.0), 1.0
    nx = discretisation.nx if record.points is None and discretisation is not None else record.points
    assert nx is not None  # the records' promise
    make: Maker = resolve_name(record.implementation)
    surface = RandomSurface(
        make(record, discretisation, period, dimension, nx),
        nx,
        seed,
        dimension,
        by_height=record.rms_height is not None and record.scaling == "each",
        by_theory=record.scaling == "ensemble",
    )
    if record.points is not None and not surface.by_height:  # where it is, the rms gradient below asks for the power
        surface.generator.power(surface.shape)
    return surface


def rms_gradient(record: Random, surface: RandomSurface, period: float) -> float:
    """Rms gradient asked of a surface, or the one that theory expects of the rms height asked of it."""
    if record.rms_gradient is not None:
        return record.rms_gradient
    height: float | None = in_reduced_units(record, period, 1.0).rms_height
    assert height is not None  # the record's promise
    return height * gradient_over_height(surface.generator, surface.shape)
