"""What work costs in units that are the same on every machine, so that decisions that follow from it are, too."""

import numpy as np
import numpy.typing as npt

UNITS = "operations: n log2 n of the grid, and 2^15 for the call, for every transform of a realisation"
_CALL = 2.0**15  # profiles of 512 to 131072 points take the same time per unit within a quarter


def price_of_transform(nodes: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return the price of one transform of a realisation on grids of some nodes."""
    n = np.asarray(nodes, dtype=np.float64)
    return n * np.log2(n) + _CALL
