"""Where the power law of a surface begins and ends."""

from gfmd_numba.scene.records import Discretisation
from gfmd_numba.scene.surfaces import PowerLaw


def band(record: PowerLaw, discretisation: Discretisation | None, period: float) -> tuple[float, float]:
    """Wave indices of the longest and the shortest wavelength: those of the record, or of the discretisation."""
    if record.cut_on is not None and record.roll_off is not None:
        return period / record.roll_off, period / record.cut_on
    assert discretisation is not None  # the loader's promise
    return float(discretisation.cut_on_index), discretisation.cut_off_index
