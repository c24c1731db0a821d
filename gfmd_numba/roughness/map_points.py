"""A map in three columns of text, a point a row: x, y and the height there, in any order of the rows."""

import numpy as np

from gfmd_numba.arrays import Reals

_SCATTERED = 0.5  # of a grid without its heights: points at random fill far less


def on_a_grid(x: Reals, y: Reals, z: Reals) -> tuple[Reals, dict[str, Reals]]:
    """Heights `[ny, nx]` or `[nx]` of points `[n]` on a grid, and the ascending positions along each axis.

    Points that are missing leave not-a-number. Points along a line parallel to an axis are a profile along x. Raises
    ValueError, with the row, for positions that are missing, a point given twice, and points that lie on no grid.
    """
    present = ~(np.isnan(x) & np.isnan(y) & np.isnan(z))  # an empty line between rows is no point
    x, y, z = x[present], y[present], z[present]
    unknown = np.flatnonzero(~(np.isfinite(x) & np.isfinite(y)))
    if len(unknown):
        raise ValueError(f"a point without a finite x and y in row {unknown[0] + 1} of numbers")
    (along_x, i), (along_y, j) = (np.unique(each, return_inverse=True) for each in (x, y))
    cells = len(along_x) * len(along_y)
    place = j * len(along_x) + i
    order = np.argsort(place, kind="stable")
    again = np.flatnonzero(np.diff(place[order]) == 0)
    if len(again):
        row = order[again[0] + 1]
        raise ValueError(f"the point x = {x[row]:g}, y = {y[row]:g} twice, again in row {row + 1} of numbers")
    if len(x) < _SCATTERED * cells:
        raise ValueError(
            f"{len(x)} points of three columns x, y and z at {len(along_x)} different x and {len(along_y)} different "
            "y, which are no grid: interpolate them to one, or save the map as rows of heights"
        )
    heights = np.full(cells, np.nan)
    heights[place] = z
    if 1 in (len(along_x), len(along_y)):
        return heights, {"x": along_x if len(along_y) == 1 else along_y}
    return heights.reshape(len(along_y), len(along_x)), {"x": along_x, "y": along_y}
