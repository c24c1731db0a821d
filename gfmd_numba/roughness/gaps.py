"""Heights that were not measured: refused, or interpolated."""

from typing import Literal

import numpy as np

from gfmd_numba.arrays import Flags, Reals
from gfmd_numba.roughness.measurements import place

Fill = Literal["refuse", "interpolate"]

MOST = 0.5  # of all heights, that may be missing: of the rest a surface is made up, not measured


def fill_gaps(heights: Reals, fill: Fill) -> tuple[Reals, tuple[str, ...]]:
    """Heights `[nx]` or `[ny, nx]` without not-a-numbers, and what was done.

    What is missing becomes the mean of its neighbours, along which profiles are linear and maps harmonic; beyond the
    last height they stay level. Raises ValueError for gaps that are to be refused, or more than half of the field.
    """
    missing = np.isnan(heights)
    share = float(missing.mean())
    if share == 0.0:
        return heights, ()
    if share > MOST:
        raise ValueError(f"{share:.3g} of all heights missing, more than {MOST:g}")
    if fill == "refuse":
        raise ValueError(
            f"height nan at {place(np.argwhere(missing))}, not a finite number; write fill: interpolate to fill gaps"
        )
    fill_in, kind = {1: (_linear, "linearly"), 2: (_harmonic, "by a harmonic function")}[len(heights.shape)]
    done = f"filled {int(missing.sum())} missing heights of {heights.size} ({100 * share:.3g} %) {kind}"
    return fill_in(heights, missing), (done,)


def _linear(heights: Reals, missing: Flags) -> Reals:
    index = np.arange(heights.size)
    return np.where(missing, np.interp(index, index[~missing], heights[~missing]), heights)


def _harmonic(heights: Reals, missing: Flags) -> Reals:
    """Heights with each missing one the mean of its two to four neighbours on the map."""
    from scipy.sparse import coo_array, csr_array, diags_array
    from scipy.sparse.linalg import spsolve

    number = np.full(heights.shape, -1)
    unknowns = int(missing.sum())
    number[missing] = np.arange(unknowns)
    neighbours, known = np.zeros(unknowns), np.zeros(unknowns)
    rows, columns = [], []
    for axis in (0, 1):
        one, other = np.moveaxis(number, axis, 0)[:-1], np.moveaxis(number, axis, 0)[1:]
        low, high = np.moveaxis(heights, axis, 0)[:-1], np.moveaxis(heights, axis, 0)[1:]
        for here, there, value in ((one, other, high), (other, one, low)):
            asked = here >= 0
            np.add.at(neighbours, here[asked], 1.0)
            both, border = asked & (there >= 0), asked & (there < 0)
            np.add.at(known, here[border], value[border])
            rows.append(here[both])
            columns.append(there[both])
    row, column = np.concatenate(rows), np.concatenate(columns)
    coupling = coo_array((np.ones(len(row)), (row, column)), shape=(unknowns, unknowns))
    filled = heights.copy()
    filled[missing] = spsolve(csr_array(diags_array(neighbours) - coupling).tocsc(), known)
    return filled
