"""The last look at results: a number that is not finite is never ok."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba.contact.observables import OBSERVABLES
from gfmd_numba.contact.path_observables import PATH_OBSERVABLES
from gfmd_numba.solvers.status import Status


def finite_status(values: Mapping[str, npt.NDArray[Any]]) -> npt.NDArray[np.int8]:
    """Status `[...]` of results by name `[..., node]`, `nonfinite` where one that was ok holds no number.

    Not-a-number is right for a measure that is undefined without contact, an infinite one never is.
    """
    status = np.asarray(values["status"])
    undefined = {name for name, row in (OBSERVABLES | PATH_OBSERVABLES).items() if row.undefined_at_times}
    bad = np.zeros(status.shape, dtype=np.bool_)
    for name, value in values.items():
        wrong = np.isinf(value) if name in undefined else ~np.isfinite(value)
        bad |= wrong.reshape(*status.shape, -1).any(axis=-1)
    return np.where(bad & (status == Status.ok), np.int8(Status.nonfinite), status)
