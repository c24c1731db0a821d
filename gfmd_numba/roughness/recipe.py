"""From the record of a random surface to the ensemble it describes, in units of its period."""

from gfmd_numba.roughness.anisotropy import Anisotropic, LengthAnisotropy, ScalingAnisotropy
from gfmd_numba.roughness.generators import (
    Generator,
    ModelWaves,
    RandomSurface,
    RecursiveSubdivision,
    SelfAffineWaves,
    gradient_over_height,
)
from gfmd_numba.roughness.recursive import Recursion
from gfmd_numba.roughness.spectra import Exponential, KCorrelation, Model, Mounded
from gfmd_numba.scene import surfaces as records
from gfmd_numba.scene.records import Discretisation
from gfmd_numba.scene.reduced_units import in_reduced_units
from gfmd_numba.scene.surfaces import Random


def random_surface(
    record: Random, discretisation: Discretisation | None, period: float, dimension: int, seed: int
) -> RandomSurface:
    """Ensemble of a record, whose lengths are in the unit of `period`.

    Grid and wavelengths that the record leaves open are those of the discretisation.
    """
    record, period = in_reduced_units(record, period, 1.0), 1.0
    nx = discretisation.nx if record.points is None and discretisation is not None else record.points
    assert nx is not None  # the records' promise
    generator = _generator(record, discretisation, period, dimension, nx)
    return RandomSurface(generator, nx, seed, dimension, by_height=record.rms_height is not None)


def rms_gradient(record: Random, surface: RandomSurface, period: float) -> float:
    """Rms gradient asked of a surface, or the one that theory expects of the rms height asked of it."""
    if record.rms_gradient is not None:
        return record.rms_gradient
    height: float | None = in_reduced_units(record, period, 1.0).rms_height
    assert height is not None  # the record's promise
    return height * gradient_over_height(surface.generator, surface.shape)


def _generator(
    record: Random, discretisation: Discretisation | None, period: float, dimension: int, nx: int
) -> Generator:
    match record:
        case records.SelfAffine():
            longest, shortest = _band(record, discretisation, period)
            return SelfAffineWaves(
                record.hurst, longest, int(shortest * (1.0 + 1e-9)), record.anisotropy or 1.0, record.plateau
            )
        case records.MidpointDisplacement() | records.SuccessiveAddition():
            longest, shortest = _band(record, discretisation, period)
            return RecursiveSubdivision(
                Recursion(record.method, dimension, record.hurst, 1.0 / shortest, 1.0 / longest)
            )
    highest = (nx - 1) // 2
    largest = highest if record.cut_on is None else min(highest, int(period / record.cut_on * (1.0 + 1e-9)))
    return ModelWaves(record.method, _model(record, dimension, period), largest)


def _band(
    record: records.SelfAffine | records.MidpointDisplacement | records.SuccessiveAddition,
    discretisation: Discretisation | None,
    period: float,
) -> tuple[float, float]:
    """Wave indices of the longest and the shortest wavelength of a power law."""
    if record.cut_on is not None and record.roll_off is not None:
        return period / record.roll_off, period / record.cut_on
    assert discretisation is not None  # the loader's promise
    return float(discretisation.cut_on_index), discretisation.cut_off_index


def _model(
    record: records.ExponentialCorrelation
    | records.KCorrelation
    | records.LengthAnisotropy
    | records.ScalingAnisotropy,
    dimension: int,
    period: float,
) -> Model | Anisotropic:
    match record:
        case records.LengthAnisotropy():
            lengths = record.correlation_length_x / period, record.correlation_length_y / period
            return LengthAnisotropy(record.hurst, lengths)
        case records.ScalingAnisotropy():
            lengths = record.correlation_length_x / period, record.correlation_length_y / period
            return ScalingAnisotropy((record.hurst_x, record.hurst_y), lengths)
    kind = Exponential if isinstance(record, records.ExponentialCorrelation) else KCorrelation
    model = kind(dimension, record.hurst, record.correlation_length / period)
    return model if record.mound_separation is None else Mounded(model, record.mound_separation / period)
